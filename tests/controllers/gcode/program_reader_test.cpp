// What is read beyond LinuxCNC's rules: each rule with a program that needs it and one that does
// not and means the same; nothing is read in silence, and nothing that two controls read
// differently.
#include "controllers/gcode/reader.h"

#include <gtest/gtest.h>

#include "controllers/gcode/canon_json.h"
#include "controllers/gcode/interpreter.h"
#include "controllers/gcode/line_reader.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::controllers {
namespace {

struct Read {
  std::string moves, refusal;
  std::vector<Fault> warnings;
};

Read read(const std::string& text, Reader reader) {
  Read out;
  ProgramSetup setup;
  setup.reader = reader;
  try {
    Interpreter interpreter(text, "p.nc", setup);
    while (const Move* move = interpreter.next()) out.moves += canon_json(*move) + "\n";
    out.warnings = interpreter.warnings();
  } catch (const InputError& error) {
    out.refusal = error.what();
  }
  return out;
}

std::string refusal(const std::string& text, Reader reader = Reader::any) {
  return read(text, reader).refusal;
}

struct Example {
  ReaderRule rule;
  std::string tolerant, plain;  // with the same moves in the same lines
  std::string place;            // of the warning
};

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
  };
  return all;
}

// Line numbers apart: an example may have a line more.
std::string without_lines(std::string moves) {
  for (std::size_t at; (at = moves.find("\"line\":")) != std::string::npos;) {
    moves.erase(at, moves.find_first_of(",}", at) - at);
  }
  return moves;
}

TEST(ReaderRules, AreReadAsTheirPlainFormAndReportedOnce) {
  for (const Example& one : examples()) {
    SCOPED_TRACE(one.tolerant);
    const Read tolerant = read(one.tolerant, Reader::any);
    EXPECT_EQ(tolerant.refusal, "");
    ASSERT_EQ(tolerant.warnings.size(), 1u);
    EXPECT_EQ(to_string(tolerant.warnings[0].place), one.place);
    EXPECT_EQ(tolerant.warnings[0].message, sentence(one.rule));
    if (one.plain.empty()) continue;
    const Read plain = read(one.plain, Reader::linuxcnc);
    EXPECT_EQ(plain.refusal, "");
    EXPECT_EQ(without_lines(tolerant.moves), without_lines(plain.moves));
  }
}

TEST(ReaderRules, AreRefusedByLinuxCncAndByReadersWithoutThem) {
  for (const Example& one : examples()) {
    SCOPED_TRACE(one.tolerant);
    for (std::size_t k = 0; k < kReaders.size(); ++k) {
      const auto reader = static_cast<Reader>(k);
      EXPECT_EQ(refusal(one.tolerant, reader).empty(), has_rule(reader, one.rule)) << kReaders[k];
    }
    EXPECT_FALSE(has_rule(Reader::linuxcnc, one.rule));
  }
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

TEST(Reader, ProgramsForLinuxCncAreReadAlikeByAll) {
  const std::string program =
      "%\n(MSG, b)\nN10 G21 G90 ; c (d\nO100 sub\n G1 X[1 + #1] F100\nO100 endsub\n"
      "O100 call [2]\n/ G0 Z5\n#<n> = 3\nG2 X#<n> Y1 R10\nM2\n%\n";
  const std::string moves = read(program, Reader::linuxcnc).moves;
  ASSERT_NE(moves, "");
  for (std::size_t k = 0; k < kReaders.size(); ++k) {
    if (static_cast<Reader>(k) == Reader::heidenhain) continue;  // another language
    const Read other = read(program, static_cast<Reader>(k));
    EXPECT_EQ(other.moves, moves) << kReaders[k];
    EXPECT_TRUE(other.warnings.empty()) << kReaders[k];
  }
}

TEST(Reader, TwoReadingsAreRefused) {
  EXPECT_EQ(refusal("G0 X1\n%\nG0 X2\nM2\n"),
            "p.nc:2:1: error: Fanuc ends the program at this '%', other controls go on behind it; "
            "choose with --reader");
  EXPECT_EQ(refusal("G0 X1\n%\nG0 X2\nM2\n", Reader::fanuc), "");
  // a control that ends the comment at its first ')' would go to X10
  EXPECT_EQ(refusal("G0 (a (b) X10)\nM2\n"), "p.nc:1:7: error: comment within a comment");
  // a control with block skip off would move
  EXPECT_EQ(refusal("// G0 X1\nM2\n"),
            "p.nc:1:2: error: unexpected '/'; a word starts with one of ABCDFGHIJKLMPQRSTXYZ@^");
}

TEST(Reader, ATextThatEndsInASubroutineIsNoProgram) {
  EXPECT_EQ(refusal("O1 sub\nG0 X1\n"),
            "p.nc:2: error: the program ends while it skips to O1 from line 1");
  EXPECT_EQ(refusal("%\nO1 if [0]\nG0 X1\n%\n"),
            "p.nc:4: error: the program ends while it skips to O1 from line 2");
}

TEST(Reader, AnEmptyTextIsNoProgram) {
  for (const char* text : {"", "\n\n"}) {
    EXPECT_NE(refusal(text).find("the program ends without M2, M30 or a closing '%'"),
              std::string::npos);
  }
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
  EXPECT_EQ(refusal("T5 M6\nG41\nG1 X1 F100\nM2\n"),
            "p.nc:2:1: error: G41: the diameter of tool 5 is unknown; pass a tool table with "
            "--tools");
  EXPECT_EQ(refusal("T5 M6\nG0 X#5403\nM2\n"),
            "p.nc:2: error: #5403: length and diameter of tool 5 are unknown; pass a tool table "
            "with --tools");
  EXPECT_EQ(refusal("T5 M6\nG41.1 D6\nG1 X10 F100\nM2\n"), "");
}

TEST(Reader, ATableThatLacksTheNumberShowsASlip) {
  ProgramSetup setup;
  setup.reader = Reader::any;
  setup.tools.add({.number = 1, .pocket = 1});
  try {
    interpret("T5 M6\nM2\n", "p.nc", setup);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "p.nc:1:1: error: T5: no such tool in the tool table of 1 tools");
  }
}

TEST(Reader, OtherLanguagesAreRefusedByName) {
  EXPECT_EQ(
      refusal("G1 X1 F1\nTOOL CALL 1 Z S1\n"),
      "p.nc:2:2: error: 'TOOL CALL' is Heidenhain conversational; --reader heidenhain reads it");
  EXPECT_EQ(refusal("N10 CYCLE81(5,0,2,-10)\n"),
            "p.nc:1:6: error: 'CYCLE' is a word of Siemens' language; programs in G-code are read "
            "here");
  EXPECT_EQ(refusal("G1 X1 F100 E0.5\nM2\n"),
            "p.nc:1:12: error: an E word feeds the extruder of a printer; programs for milling are "
            "read here");
}

TEST(TolerantLine, KeepsEveryColumn) {
  for (const Example& one : examples()) {
    const std::string line = one.tolerant.substr(0, one.tolerant.find('\n'));
    EXPECT_EQ(tolerant_line(line, Reader::any).text.size(), line.size());
    EXPECT_EQ(tolerant_line(line, Reader::linuxcnc).text, line);
  }
}

}  // namespace
}  // namespace servomill::controllers
