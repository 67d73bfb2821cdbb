// Rules beyond LinuxCNC's: each rule with a program that needs it and one that does
// not and means the same; nothing is read in silence, and nothing that two controls read
// differently.
#include "controllers/gcode/reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "controllers/gcode/interpreter.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "tests/controllers/gcode/tolerant_reading.h"

namespace servomill::controllers::program_reader_test {
namespace {

struct Example {
  ReaderRule rule;
  std::string tolerant, plain;  // with the same moves in the same lines
  std::string place;            // of the warning
  ProgramSetup setup = {};
  Reader reader = Reader::any;  // another one where `any` finds two readings
};

ProgramSetup with_tools() {
  ProgramSetup setup;
  setup.tools = ToolTable::parse("T1 P1 Z10 D2\nT2 P2 Z20 D4\n", "tools.tbl");
  return setup;
}

ProgramSetup with_ignored_code() {
  ProgramSetup setup;
  setup.ignored_codes = {82};
  return setup;
}

ProgramSetup with_feed() {
  ProgramSetup setup;
  setup.feed = 100.0 * mm_per_min;
  return setup;
}

ProgramSetup with_additional_offset() {
  ProgramSetup setup;
  setup.additional_offsets[3] = (AxisWords() << 10.0 * mm, 0, 0, 0, 0, 0).finished();
  return setup;
}

ProgramSetup with_unknown_lengths() {
  ProgramSetup setup;
  setup.accepts_unknown_lengths = true;
  return setup;
}

const std::string kCycle = "G0 Z5.\nG99 G81 X1. Z-2. R1. F100.\n";

const std::vector<Example>& examples() {
  using enum ReaderRule;
  using namespace std::string_literals;
  static const std::vector<Example> all = {
      {end_of_text, "S100 M3\nG0 X1", "S100 M3\nG0 X1\nM2", "p.nc:2"},
      {end_of_text, "%\nG0 X1\n", "G0 X1\nM2", "p.nc:2"},
      {percent_at_end, "M8\nG0 X1\n%\n", "M8\nG0 X1\nM2\n", "p.nc:3"},
      {percent_at_end, "G0 X1\n%\n\n%\n", "G0 X1\nM2\n", "p.nc:2"},
      {percent_title, "% PART 7\nG0 X1\n%\n", "%\nG0 X1\n%\n", "p.nc:1:3"},
      {control_characters, "\0\0G0 X1\x7f\nM2\n"s, "G0 X1\nM2\n", "p.nc:1:1"},
      {control_characters, "G0 X1\rY2\nM2\n", "G0 X1 Y2\nM2\n", "p.nc:1:6"},
      {open_comment, "G0 X1 (fast\nM2\n", "G0 X1 (fast)\nM2\n", "p.nc:1:7"},
      {nested_comment, "G0 (mill (6 mm) long) X1\nM2\n", "G0 X1\nM2\n", "p.nc:1:10"},
      {slash_comment, "// made by hand\nG0 X1\nM2\n", ";\nG0 X1\nM2\n", "p.nc:1:1"},
      {skip_level, "/3 G0 X1\nM2\n", "/ G0 X1\nM2\n", "p.nc:1:2"},
      {colon_number, ":1000 (PART)\nG0 X1\nM2\n", "O1000 (PART)\nG0 X1\nM2\n", "p.nc:1:1"},
      {number_with_words, "O1000 G0 X1\nM2\n", "G0 X1\nM2\n", "p.nc:1:7"},
      {block_number_anywhere, "G0 N10 X1\nM2\n", "G0 X1\nM2\n", "p.nc:1:4"},
      {block_number_anywhere, "G0 X[1+1] N10.5\nM2\n", "G0 X2\nM2\n", "p.nc:1:11"},
      {tool_without_table, "T5 M6\nG0 X1\nM2\n", "", "p.nc:1:1"},
      {fan_code, "M106 S255\nG0 X1\nM107\nM2\n", ";\nG0 X1\nM2\n", "p.nc:1:1"},
      {fan_code, "G0 X1 m106p1.5\nM2\n", "G0 X1\nM2\n", "p.nc:1:7"},
      {ReaderRule::long_comment, "(" + std::string(300, 'x') + ")\nG0 X1.\nM2\n", ";\nG0 X1\nM2\n",
       "p.nc:1:253"},
      {ReaderRule::dwell_word, "G4 X2.5\nM2\n", "G4 P2.5\nM2\n", "p.nc:1:4"},
      {ReaderRule::dwell_word, "G04 U1.5\nM2\n", "G4 P1.5\nM2\n", "p.nc:1:5"},
      {ReaderRule::given_feed, "G1 X1.\nM2\n", "G1 X1 F100\nM2\n", "p.nc:1:1", with_feed()},
      // radii of 5.04 and 4.96 mm
      {ReaderRule::arc_radii, "G0 X0. Y0.\nG2 X10. Y0. I5.04 F100.\nM2\n", "", "p.nc:2:1"},
      {ReaderRule::repeated_group, "G90 G17 G18 G17 G0 X1.\nM2\n", "G90 G17 G0 X1\nM2\n",
       "p.nc:1:9"},
      {ReaderRule::home_with_motion, "G0 G28 X1.\nX2.\nM2\n", "G28 X1\nG0 X2\nM2\n", "p.nc:1:1"},
      {ReaderRule::second_home_number, "G30 P2 X1.\nM2\n", "G30 X1\nM2\n", "p.nc:1:5"},
      {ReaderRule::homing_cycle, "G0 X1. Y2.\nG28.2 X0. Y0.\nM2\n",
       "G0 X1 Y2\nG53 G0 X0\nG53 G0 Y0\nM2\n", "p.nc:2:1"},
      {ReaderRule::additional_work_offset, "G54.1 P3\nG0 X1. Y2.\nM2\n", "G0 X11 Y2\nM2\n",
       "p.nc:1:1", with_additional_offset()},
      {ReaderRule::additional_work_offset, "G154 P3 G0 X1.\nG54\nX1.\nM2\n", "G0 X11\nX1\nM2\n",
       "p.nc:1:1", with_additional_offset()},
      {ReaderRule::cycle_repeats, "G0 Z5.\nG91 G99 G81 X1. Z-2. R-1. K3 F100.\nM2\n",
       "G0 Z5\nG91 G99 G81 X1 Z-2 R-1 L3 F100\nM2\n", "p.nc:2:27"},
      {ReaderRule::cycle_without_hole, "G0 Z5.\nG99 G81 X1. Z-2. R1. L0 F100.\nX3.\nM2\n",
       "G0 Z5\nG99 F100\nG81 X3 Z-2 R1\nM2\n", "p.nc:2:22"},
      {ReaderRule::cycle_memory, kCycle + "G85 X3.\nM2\n",
       "G0 Z5\nG99 G81 X1 Z-2 R1 F100\nG85 X3 Z-2 R1\nM2\n", "p.nc:3:1"},
      {ReaderRule::cycle_without_dwell, "G0 Z5.\nG99 G82 X1. Z-2. R1. F100.\nM2\n",
       "G0 Z5\nG99 G82 X1 Z-2 R1 P0 F100\nM2\n", "p.nc:2:5"},
      {ReaderRule::cycle_unused_dwell, "G0 Z5.\nG99 G85 X1. Z-2. R1. P0.5 F100.\nM2\n",
       "G0 Z5\nG99 G85 X1 Z-2 R1 F100\nM2\n", "p.nc:2:22"},
      {ReaderRule::fine_boring, "M3 S100\nG0 Z5.\nG99 G76 X1. Z-2. R1. Q0.1 P0 F100.\nX3.\nM2\n",
       "M3 S100\nG0 Z5\nG99 G86 X1 Z-2 R1 P0 F100\nX3\nM2\n", "p.nc:3:5"},
      {ReaderRule::tapping_spindle, "S100\nG0 Z5.\nG99 G84 X1. Z-2. R1. F100.\nM2\n",
       "S100\nG0 Z5\nM3 G99 G84 X1 Z-2 R1 F100\nM2\n", "p.nc:3:5"},
      {ReaderRule::words_with_g80, kCycle + "G80 X3.\nM2\n",
       "G0 Z5\nG99 G81 X1 Z-2 R1 F100\nG0 X3\nM2\n", "p.nc:3:1"},
      {ReaderRule::motion_behind_cycle, kCycle + "G80\nX3.\nM2\n",
       "G0 Z5\nG99 G81 X1 Z-2 R1 F100\nG80\nG0 X3\nM2\n", "p.nc:4:1"},
      {ReaderRule::modal_diameter_offset, "D1\nG41 G1 X10. F100.\nG40 X20.\nM2\n",
       "G41 D1 G1 X10 F100\nG40 X20\nM2\n", "p.nc:1:1", with_tools()},
      {ReaderRule::modal_length_offset, "G43 H1\nH2\nG0 Z1.\nM2\n", "G43 H1\nG43 H2\nG0 Z1\nM2\n",
       "p.nc:2:1", with_tools()},
      {ReaderRule::unknown_length, "G43 H1\nG0 Z1.\nM2\n", "", "p.nc:1:1", with_unknown_lengths()},
      {ReaderRule::subprogram_repeats,
       "M98 P20100\nM2\nO100\nG0 X1.\nM99\n",
       "M98 P100 L2\nM2\nO100\nG0 X1\nM99\n",
       "p.nc:1:5",
       {},
       Reader::fanuc},
      {ReaderRule::call_with_words, "G0 X2. M98 P100\nM2\nO100\nX1.\nM99\n",
       "G0 X2\nM98 P100\nM2\nO100\nX1\nM99\n", "p.nc:1:8"},
      {ReaderRule::local_subprogram, "M97 P100\nM2\nN100 G0 X1.\nM99\n", "G0 X1\nM2\n", "p.nc:1:1"},
      {ReaderRule::subprogram_file, "M98 P7\nM2\n", "G0 X1\nM2\n", "p.nc:1",
       with_subprogram_file()},
      {ReaderRule::local_subprogram, "G91 G0\nM97 P100 L3\nM2\nN100 X1.\nM99\n",
       "G91 G0\nX1\nX1\nX1\nM2\n", "p.nc:2:1"},
      {ReaderRule::smoothing, "G5.1 Q1\nG05 P10000\nG187 P1 E0.01\nG0 X1.\nM2\n", "G0 X1\nM2\n",
       "p.nc:1:1"},
      {ReaderRule::machine_function, "M29 S100\nM19 P90\nG0 X1.\nM2\n", "S100\nM5\nG0 X1\nM2\n",
       "p.nc:1:1"},
      {ReaderRule::ignored_function, "M82\nG0 X1.\nM2\n", "G0 X1\nM2\n", "p.nc:1:1",
       with_ignored_code()},
      {ReaderRule::cancel_codes, "G67 G50.2\nG54.2 P0\nG0 X1.\nM2\n", "G0 X1\nM2\n", "p.nc:1:1"},
      {ReaderRule::check_codes, "G0 X1.\nG22 X9. Y9. Z9.\nM2\n", "G0 X1\nM2\n", "p.nc:2:1"},
      {ReaderRule::coolant_codes, "M7 M8\nG0 X1.\nM2\n", "M8\nM7\nG0 X1\nM2\n", "p.nc:1:4"},
      {ReaderRule::exact_stop, "G9 G1 X1. F9.\nM2\n", "G61.1\nG1 X1 F9\nG64\nM2\n", "p.nc:1:1"},
      {ReaderRule::spindle_power, "G0 X1.\nM3 P100\nM2\n", "G0 X1\nM3\nM2\n", "p.nc:2:4"},
      {ReaderRule::skip_behind_number, "N1 / G0 X1.\nM2\n", "/N1 G0 X1\nM2\n", "p.nc:1:4"},
      {ReaderRule::polar_coordinates, "G16\nG0 X10. Y90.\nG91 Y90.\nG90 G15\nM2\n",
       "G0 X0 Y10\nX-10 Y0\nM2\n", "p.nc:1:1"},
      {ReaderRule::scaling, "G51 X0. Y0. Z0. P2.\nG0 X1. Y2.\nG50\nX1.\nM2\n", "G0 X2 Y4\nX1\nM2\n",
       "p.nc:1:1"},
      {ReaderRule::mirror_image, "G51.1 X0.\nG1 X1. Y2. F100.\nG2 X2. Y3. I1. J0.\nG50.1 X0.\nM2\n",
       "G1 X-1 Y2 F100\nG3 X-2 Y3 I-1 J0\nM2\n", "p.nc:1:1"},
      {ReaderRule::unit_codes, "G70\nG0 X1.\nG71 X1.\nM2\n", "G20\nG0 X1\nG21 X1\nM2\n",
       "p.nc:1:1"},
      {ReaderRule::sender_wait, "%wait\nG0 X1.\nM2\n", "G4 P0\nG0 X1\nM2\n", "p.nc:1:1"},
      {ReaderRule::sender_command, "$G ; modes\n?\nG0 X1.\nM2\n", "G0 X1\nM2\n", "p.nc:1:1"},
      {ReaderRule::rapid_at_start, "Z5.\nX1.\nM2\n", "G0 Z5\nX1\nM2\n", "p.nc:1:1"},
      {ReaderRule::centre_off_plane, "G2 X2. I1. J0. K0.000 F100.\nM2\n", "G2 X2 I1 J0 F100\nM2\n",
       "p.nc:1:16"},
      {ReaderRule::centre_off_plane, "G18 G3 X2. J0. I1. K0. F100.\nM2\n",
       "G18 G3 X2 I1 K0 F100\nM2\n", "p.nc:1:12"},
      {ReaderRule::circular_pocket,
       "G12 I4. F300.\nM2\n",
       "F300\nG1 X4\nG2 I-4\nG1 X0\nM2\n",
       "p.nc:1:1",
       {},
       Reader::mach},
      {ReaderRule::haas_pocket, "G12 D0 I4. F300.\nM2\n", "F300\nG1 X4\nG2 I-4\nG1 X0\nM2\n",
       "p.nc:1:1"},
      {ReaderRule::haas_mirror,
       "G101 X0.\nG0 X4.\nG100 X0.\nX1.\nM2\n",
       "G0 X-4\nX1\nM2\n",
       "p.nc:1:1",
       {},
       Reader::haas},
      {ReaderRule::home_letters, "G0 X5. Y6.\nG28 X Y\nM2\n", "G0 X5 Y6\nG53 X0\nG53 Y0\nM2\n",
       "p.nc:2:1"},
      {ReaderRule::corner, "G0 X0. Y0.\nG1 Y20. ,C2. F100.\nX30. ,R4\nY0.\nM2\n",
       "G0 X0 Y0\nG1 Y18 F100\nG1 X2 Y20\nX26\nG2 X30 Y16 R4\nG1 Y0\nM2\n", "p.nc:2:9"},
      {ReaderRule::corner, "G18 G0 X0. Z0.\nG1 Z30. ,R5. F100.\nX20.\nM2\n",
       "G18 G0 X0 Z0\nG1 Z25 F100\nG3 X5 Z30 R5\nG1 X20\nM2\n", "p.nc:2:9"},
      {ReaderRule::arc_without_axes, "G2 X2. I1. F100.\nI-1. J0\nM2\n",
       "G2 X2 I1 F100\nG2 I-1 J0\nM2\n", "p.nc:2:1"},
      {ReaderRule::home_under_tip_control, "T1 M6\nG43.4 H1\nG91 G28 Z0.\nG49\nM2\n",
       "T1 M6\nG43.4 H1\nG49\nG91 G28 Z0\nG43.4 H1\nG49\nM2\n", "p.nc:3:5", with_tools()},
      {ReaderRule::subprogram_behind_end, "%\nM98 P7\nM2\n%\nO7\nG0 X1.\nM99\n", "G0 X1\nM2\n",
       "p.nc:4:1"},
      {repeated_word, "G1 X1. F100. F200.\nM2\n", "G1 X1 F200\nM2\n", "p.nc:1:14"},
      {ReaderRule::haas_tip_control, "T1 M6\nG234 H1\nG49\nM2\n", "T1 M6\nG43.4 H1\nG49\nM2\n",
       "p.nc:2:1", with_tools()},
      {ReaderRule::checksum, "N1 G0 X1. *45\nM2\n", "G0 X1\nM2\n", "p.nc:1:11"},
      {percent_title, "(PART)\n%\nG0 X1.\n%\n", "%\nG0 X1\n%\n", "p.nc:2:1"},
      {ReaderRule::home_with_motion, "G0 G92 X1.\nX2.\nM2\n", "G92 X1\nG0 X2\nM2\n", "p.nc:1:1"},
      {ReaderRule::rotation, "G68 X0. Y0. R90.\nG0 X1. Y0.\nG69\nM2\n", "G0 X0 Y1\nM2\n",
       "p.nc:1:1"},
      {ReaderRule::macro_statement, "IF[1EQ1]GOTO9\nG0 X9.\nN9 G0 X1.\nM2\n", "G0 X1\nM2\n",
       "p.nc:1:1"},
      {ReaderRule::several_statements, "#1=1. #2=2.\nIF[1EQ1]GOTO9\nN9 G0 X#1 Y#2\nM2\n",
       "G0 X1 Y2\nM2\n", "p.nc:1:7"},
      {ReaderRule::variable_increment,
       "G0 X[POW[1.1,4]]\nM2\n",
       "G0 X1.464\nM2\n",
       "p.nc:1:4",
       {},
       Reader::fanuc},
      {ReaderRule::macro_call, "G65 P10\nM2\nO10\nG0 X1.\nM99\n", "G0 X1\nM2\n", "p.nc:1:1"},
      {ReaderRule::modal_macro_call, "G66 P10\nG0 X1.\nM2\nO10\nY1.\nM99\n", "G0 X1\nY1\nM2\n",
       "p.nc:1:1"},
      {ReaderRule::macro_output, "POPEN\nG0 X1.\nM2\n", "G0 X1\nM2\n", "p.nc:1:1"},
  };
  return all;
}

TEST(ReaderRules, AreReadAsTheirPlainFormAndReportedOnce) {
  for (const Example& one : examples()) {
    SCOPED_TRACE(one.tolerant);
    const Read tolerant = read(one.tolerant, one.reader, one.setup);
    EXPECT_EQ(tolerant.refusal, "");
    std::vector<Fault> warnings = tolerant.warnings;
    const std::map<ReaderRule, ReaderRule> kCompanions = {
        {ReaderRule::several_statements, ReaderRule::macro_statement},
        {ReaderRule::home_letters, ReaderRule::homing_cycle}};
    if (const auto other = kCompanions.find(one.rule); other != kCompanions.end()) {
      const std::string said = sentence(other->second);
      std::erase_if(warnings, [&](const Fault& fault) { return fault.message.starts_with(said); });
    }
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_EQ(to_string(warnings[0].place), one.place);
    EXPECT_TRUE(warnings[0].message.starts_with(sentence(one.rule))) << warnings[0].message;
    if (one.plain.empty()) continue;
    const Read plain = read(one.plain, Reader::linuxcnc, one.setup);
    EXPECT_EQ(plain.refusal, "");
    EXPECT_EQ(without_lines(tolerant.moves), without_lines(plain.moves));
  }
}

// Rewriters of programs get lines in LinuxCNC's language.
TEST(ReaderRules, AreGivenOutAsLinesForLinuxCnc) {
  const std::set<ReaderRule> others = {
      ReaderRule::tool_without_table,    ReaderRule::arc_radii,
      ReaderRule::unknown_length,        ReaderRule::percent_title,
      ReaderRule::local_subprogram,      ReaderRule::percent_at_end,
      ReaderRule::subprogram_repeats,    ReaderRule::call_with_words,
      ReaderRule::subprogram_behind_end, ReaderRule::subprogram_file};  // these are unrolled
  for (const Example& one : examples()) {
    if (others.contains(one.rule)) continue;
    SCOPED_TRACE(one.tolerant);
    ProgramSetup setup = one.setup;
    setup.reader = one.reader;
    if (one.reader == Reader::fanuc) setup.decimal_point = DecimalPoint::calculator;
    Interpreter interpreter(one.tolerant, "p.nc", setup);
    std::string lines;
    while (const auto block = interpreter.next_block()) {
      const bool is_call = block->block != nullptr && block->block->o_word.flow != Flow::none;
      if (!is_call && !block->text.empty()) lines += std::string(block->text) + "\n";
    }
    const Read written = read(lines, Reader::linuxcnc, one.setup);
    EXPECT_EQ(written.refusal, "") << lines;
    EXPECT_EQ(without_lines(written.moves),
              without_lines(read(one.tolerant, one.reader, one.setup).moves))
        << lines;
  }
}

TEST(ReaderRules, AreRefusedByLinuxCncAndByReadersWithoutThem) {
  for (const Example& one : examples()) {
    SCOPED_TRACE(one.tolerant);
    for (std::size_t k = 0; k < kReaders.size(); ++k) {
      const auto reader = static_cast<Reader>(k);
      if (reader == Reader::siemens) continue;  // another language
      if (one.reader != Reader::any && reader == Reader::any) continue;
      const bool has_other_words =
          one.rule == ReaderRule::scaling || one.rule == ReaderRule::rotation;
      if (has_other_words && reader == Reader::mach) continue;  // G51 X2 Y2, G68 A1 B2 R90
      const bool is_tape = reader == Reader::fanuc || reader == Reader::haas;
      if (one.rule == ReaderRule::sender_wait && is_tape) continue;  // title, or end of record
      EXPECT_EQ(read(one.tolerant, reader, one.setup).refusal.empty(), has_rule(reader, one.rule))
          << kReaders[k];
    }
    EXPECT_FALSE(has_rule(Reader::linuxcnc, one.rule));
  }
}

TEST(ReaderRules, WaitOfASenderIsTheEndOfRecordForFanuc) {
  const Read fanuc = read("G0 X1.\n%wait\nG0 X2.\nM2\n", Reader::fanuc, {});
  EXPECT_EQ(without_lines(fanuc.moves),
            without_lines(read("G0 X1.\n%\n", Reader::fanuc, {}).moves));
}

TEST(ReaderRules, HaveAnExampleEachAndSayWhoReadsSo) {
  for (const ReaderRuleEntry& rule : reader_rules()) {
    const bool has_example = std::any_of(examples().begin(), examples().end(),
                                         [&](const Example& one) { return one.rule == rule.rule; });
    EXPECT_TRUE(has_example) << rule.found;
    EXPECT_FALSE(rule.controls.empty()) << rule.found;
    EXPECT_FALSE(rule.source.empty()) << rule.found;
  }
}

TEST(Reader, ProgramsForLinuxCncAreReadAlikeByDefault) {
  const std::string program =
      "%\n(MSG, b)\nN10 G21 G90 ; c (d\nO100 sub\n G1 X[1 + #1] F100\nO100 endsub\n"
      "O100 call [2]\n/ G0 Z5\n#<n> = 3\nG2 X#<n> Y1 R10\nM2\n%\n";
  const std::string moves = read(program, Reader::linuxcnc).moves;
  ASSERT_NE(moves, "");
  const Read any = read(program, Reader::any);
  EXPECT_EQ(any.moves, moves);
  EXPECT_TRUE(any.warnings.empty());
}

TEST(Reader, RefusesWhatItsControlDoesNotHave) {
  EXPECT_EQ(refusal("T1 M6\nG234\n", Reader::haas),
            "p.nc:2:1: error: G234 requires H, the number of the tool length offset");
  EXPECT_EQ(refusal("O100 sub\nO100 endsub\nM2\n", Reader::grbl),
            "p.nc:1:1: error: O-words with keywords are not supported by grbl");
  EXPECT_EQ(refusal("G99 G81 X1. Z-2. R1. F100.\nM2\n", Reader::grbl),
            "p.nc:1:1: error: G99 is not supported by grbl");
  EXPECT_EQ(refusal("G64 P.01\nM2\n", Reader::fanuc),
            "p.nc:1:1: error: G64 with P or Q is not supported by fanuc");
  EXPECT_EQ(refusal("G91.1\n", Reader::haas), "p.nc:1:1: error: G91.1 is not supported by haas");
  EXPECT_EQ(refusal("G64 P.01\nG91.1\nG99 G81 X1. Z-2. R1. F100.\nM2\n", Reader::mach), "");
}

TEST(Reader, TwoReadingsAreRefused) {
  EXPECT_EQ(refusal("G0 X1\n%\nG0 X2\nM2\n"),
            "p.nc:2:1: error: Fanuc ends the program at this '%', other controls continue after "
            "it; choose with --reader fanuc, haas or linuxcnc");
  EXPECT_EQ(refusal("G0 X1\n%\nG0 X2\nM2\n", Reader::fanuc), "");
  EXPECT_EQ(refusal("%\nG0 X1\n%\nG0 X2\nM2\n"),
            "p.nc:3:1: error: Fanuc, Haas and LinuxCNC end the program at this '%', but blocks "
            "follow it; remove the '%', or choose with --reader fanuc, haas or linuxcnc");
  EXPECT_EQ(refusal("%\nG0 X1\n%\n(X2)\n\x1a"), "");
  EXPECT_NE(refusal("T1 M6 T2\nM2\n").find("M6 uses the first or the last"), ~0ul);
  // a control that ends the comment at its first ')' would go to X10
  EXPECT_EQ(refusal("G0 (a (b) X10)\nM2\n"), "p.nc:1:7: error: comment within a comment");
  // behind its first ')' it finds another comment
  EXPECT_EQ(refusal("G0 X1. (a (b); X10 (c))\nM2\n"), "");
  // a control with block skip off would move
  EXPECT_EQ(refusal("// G0 X1\nM2\n"),
            "p.nc:1:2: error: '//' before words: a comment on some controls, an optional block on "
            "others; use ( ) or ;");
}

TEST(Reader, FaultsKeepTheirColumns) {
  EXPECT_EQ(refusal("\xEF\xBB\xBFG0 N5 X1 (a (b) c) G99.5\nM2\n"),
            "p.nc:1:20: error: unknown G code G99.5");
}

TEST(Reader, AnUnknownToolIsRefusedWhereItsDataCount) {
  EXPECT_EQ(
      refusal("T5 M6\nG43 H5\nM2\n"),
      "p.nc:2:5: error: H5: length and diameter of tool 5 are unknown; pass a tool table with "
      "--tools");
  EXPECT_EQ(refusal("T5 M6\nG43\nM2\n"),
            "p.nc:2: error: T5: length and diameter of tool 5 are unknown; pass a tool table with "
            "--tools");
  EXPECT_EQ(
      refusal("T5 M6\nG41 D5\nG1 X1 F100\nM2\n"),
      "p.nc:2:5: error: D5: length and diameter of tool 5 are unknown; pass a tool table with "
      "--tools");
  EXPECT_EQ(refusal("T5 M6\nG0 X#5403\nM2\n"),
            "p.nc:2: error: #5403: length and diameter of tool 5 are unknown; pass a tool table "
            "with --tools");
  EXPECT_EQ(refusal("T5 M6\nG41.1 D6\nG1 X10 F100\nM2\n"), "");
}

// Work coordinates count from the part, machine coordinates from the tip of a tool of no known
// length.
TEST(Reader, WhatDependsOnAnUnknownLengthIsNull) {
  const std::string moves = read("G0 X1. Z9.\nG43 H1\nX2.\nZ5.\nG53 G0 Z0.\nG49\nX3.\nZ7.\nM2\n",
                                 Reader::any, with_unknown_lengths())
                                .moves;
  const auto rapid = [](int line, const std::string& end, const std::string& machine) {
    return "{\"t\":\"rapid\",\"line\":" + std::to_string(line) + ",\"end\":" + end +
           ",\"mend\":" + machine + "}\n";
  };
  EXPECT_EQ(moves, rapid(1, "[1,0,9,0,0,0]", "[1,0,9,0,0,0]") +
                       rapid(3, "[2,0,null,0,0,0]", "[2,0,null,0,0,0]") +
                       rapid(4, "[2,0,5,0,0,0]", "[2,0,null,0,0,0]") +
                       rapid(5, "[2,0,null,0,0,0]", "[2,0,null,0,0,0]") +
                       rapid(7, "[3,0,null,0,0,0]", "[3,0,null,0,0,0]") +
                       rapid(8, "[3,0,7,0,0,0]", "[3,0,7,0,0,0]") + "{\"t\":\"end\",\"line\":9}\n");
  EXPECT_EQ(
      read("G43 H1\nG0 X#5422\nM2\n", Reader::any, with_unknown_lengths()).refusal,
      "p.nc:2: error: #5422: Z depends on the unknown tool length; pass a tool table with --tools");
}

TEST(Reader, ATableThatLacksTheNumberShowsASlip) {
  ProgramSetup setup;
  setup.reader = Reader::any;
  setup.tools.add({.number = 1, .pocket = 1});
  try {
    interpret("T5 M6\nM2\n", "p.nc", setup);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "p.nc:1:1: error: T5 is not in the tool table");
  }
}

}  // namespace
}  // namespace servomill::controllers::program_reader_test
