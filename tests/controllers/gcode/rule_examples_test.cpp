// Programs in the words of other controls against moves worked out by hand from their manuals: one
// or more for each rule, and for each reading of each word that two controls read differently.
#include "rule_examples.h"

#include <fmt/format.h>

#include <algorithm>

#include "controllers/gcode/line_reader.h"
#include "plant/vocabulary/move_curve.h"
#include "rule_examples_cycles.h"
#include "rule_examples_differences.h"
#include "rule_examples_frames.h"
#include "rule_examples_lines.h"
#include "rule_examples_macros.h"
#include "rule_examples_motion.h"

namespace servomill::controllers::rule_examples_test {
namespace {

std::vector<RuleExample> rule_examples() {
  std::vector<RuleExample> all;
  for (const auto& family : {line_examples(), motion_examples(), cycle_examples(),
                             offset_examples(), frame_examples(), macro_examples()}) {
    all.insert(all.end(), family.begin(), family.end());
  }
  return all;
}

std::string name_of(Reader reader) {
  return std::string(kReaders[static_cast<std::size_t>(reader)]);
}

TEST(RuleExamples, MoveAsTheManualsSay) {
  for (const RuleExample& one : rule_examples()) {
    SCOPED_TRACE(name_of(one.reader) + ": " + one.program);
    const Reading found = read(one.program, one.reader, one.given);
    EXPECT_EQ(found.moves, one.moves) << one.source;
  }
}

TEST(RuleExamples, AreWarnedOfOnceWhereTheRuleIsFirstNeeded) {
  for (const RuleExample& one : rule_examples()) {
    SCOPED_TRACE(name_of(one.reader) + ": " + one.program);
    std::vector<std::string> found, wanted;
    for (const Fault& warning : read(one.program, one.reader, one.given).warnings) {
      if (warning.message.starts_with(sentence(one.rule))) {
        found.push_back(to_string(warning.place));
      }
    }
    if (!one.place.empty()) wanted.push_back(one.place);
    EXPECT_EQ(found, wanted);
  }
}

TEST(RuleExamples, AreNotReadInSilenceByLinuxCnc) {
  for (const RuleExample& one : rule_examples()) {
    if (one.place.empty()) continue;
    SCOPED_TRACE(one.program);
    const std::string strict = read(one.program, Reader::linuxcnc, one.given).moves;
    EXPECT_NE(strict.find(": error: "), std::string::npos) << strict;
  }
}

TEST(RuleExamples, CoverEveryRule) {
  const std::vector<RuleExample> all = rule_examples();
  for (const ReaderRuleEntry& rule : reader_rules()) {
    EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const RuleExample& one) {
      return one.rule == rule.rule && !one.moves.empty();
    })) << rule.found;
  }
  for (const RuleExample& one : all) EXPECT_FALSE(one.source.empty()) << one.program;
}

TEST(DifferenceExamples, MoveAsTheManualsSay) {
  for (const DifferenceExample& one : difference_examples()) {
    SCOPED_TRACE(name_of(one.reader) + ": " + one.program);
    EXPECT_EQ(read(one.program, one.reader, one.given).moves, one.moves) << one.source;
    const auto of_reader = reading_of(one.difference, one.reader);
    EXPECT_EQ(of_reader.value_or(one.reading), one.reading);
  }
}

// Each reading that a reader or an option gives.
TEST(DifferenceExamples, CoverEveryReading) {
  const std::vector<DifferenceExample> all = difference_examples();
  for (const WordDifferenceEntry& entry : word_differences()) {
    for (int k = 0; k < 2; ++k) {
      const WordReading& reading = entry.readings[static_cast<std::size_t>(k)];
      const bool can_be_chosen = reading.readers != 0 || !entry.option.empty();
      const auto is_of_it = [&](const DifferenceExample& one) {
        return one.difference == entry.difference && one.reading == k;
      };
      EXPECT_EQ(std::any_of(all.begin(), all.end(), is_of_it), can_be_chosen)
          << entry.found << ": " << reading.text;
    }
  }
}

// Fanuc 11600#5 decides where the axis that is not named goes, from memory.
TEST(RuleExamples, ALoneAxisBehindARotationIsRefusedWhereItMatters) {
  EXPECT_EQ(read("G0 X5. Y0.\nG68 X0. Y0. R90.\nX10.\nM2\n", Reader::fanuc, {}).moves,
            "p.nc:3:1: error: X alone after G68: the control determines whether Y keeps its "
            "machine position or its coordinate from before G68 (Fanuc 11600#5); program both");
  EXPECT_EQ(read("G68 X0. Y0. R90.\nG0 X10.\nY5.\nM2\n", Reader::fanuc, {}).moves,
            "R 0 10 0 | R -5 10 0");
}

TEST(RuleExamples, WordsOfG15G51AndG68ThatTwoControlsHaveAreRefused) {
  EXPECT_EQ(read("G15 H1\nG0 X1.\nM2\n", Reader::any, {}).moves,
            "p.nc:1:5: error: H with G15 or G16 is a work coordinate system on Okuma");
  EXPECT_EQ(read("G51 X2. Y2. P3.\nM2\n", Reader::mach, {}).moves,
            "p.nc:1:13: error: P with G51: on Mach the factors are X, Y and Z");
  EXPECT_EQ(read("G68 X1. Y2. R90.\nM2\n", Reader::mach, {}).moves,
            "p.nc:1:5: error: X with G68: on Mach the centre is A and B");
  EXPECT_EQ(read("G68 A1. B2. R90.\nM2\n", Reader::haas, {}).moves,
            "p.nc:1:5: error: A with G68: the X of the centre (Mach in G17, G90) or a rotary axis");
}

TEST(RuleExamples, WordsOfOtherLanguagesAreRefusedByName) {
  const std::string siemens = "is a Siemens word; use --reader siemens";
  EXPECT_EQ(read("N10 T=\"MILL\"\nM2\n", Reader::fanuc, {}).moves,
            "p.nc:1:6: error: 'T=' " + siemens);
  EXPECT_EQ(read("G3 X1. Y2. CR=4. F100.\nM2\n", Reader::fanuc, {}).moves,
            "p.nc:1:13: error: 'CR=' " + siemens);
  EXPECT_EQ(read("GROUP_BEGIN(0,\"TOP\")\nM2\n", Reader::any, {}).moves,
            "p.nc:1:2: error: 'GROUP_BEGIN(...)' is a word of Siemens or the machine builder; for "
            "Siemens programs use --reader siemens");
  EXPECT_EQ(read("G1 X10. ,R1. F100.\nM2\n", Reader::grbl, {}).moves,
            "p.nc:1:9: error: ',R' rounds the corner to the next move (Fanuc, Haas), which is not "
            "supported; program the arc");
}

TEST(RuleExamples, ACornerThatIsNotBetweenTwoLinesIsRefused) {
  const auto refusal = [](const std::string& program) {
    const std::string said = read(program + "\nM2\n", Reader::fanuc, {}).moves;
    const std::string before = "p.nc:1:9: error: ";
    return said.starts_with(before) ? said.substr(before.size()) : said;
  };
  EXPECT_EQ(refusal("G1 X10. ,R1. F100."),
            "',R' requires a linear move with plain numbers in the next block");
  EXPECT_EQ(refusal("G1 X10. ,C1. F100.\nY#1"),
            "',C' requires a linear move with plain numbers in the next block");
  EXPECT_EQ(refusal("G1 X10. ,R1. F100.\nG0 Y5."),
            "',R' is supported only between lines (G1), not next to G0; program the corner");
  EXPECT_EQ(refusal("G1 X10. ,R1. F100.\nG2 X12. Y2. R2."),
            "',R' is supported only between lines (G1), not next to G2; program the corner");
  EXPECT_EQ(refusal("G0 X10. ,R1. F100.\nG1 Y2."),
            "',R' is supported only between lines (G1), not next to G0; program the corner");
  EXPECT_EQ(refusal("G1 X10. ,R1. F100.\nY5. Z-1."),
            "',R' is not supported with Z in this or the next block; program the corner");
  EXPECT_EQ(refusal("G1 X10. ,R1. F100.\nG91 Y5."),
            "',R' is not supported with G91 in the next block; program the corner");
  EXPECT_EQ(refusal("G1 X10. ,R1. F100.\nX20."), "',R1': the lines form no corner");
  EXPECT_EQ(refusal("G1 X10. ,R1. F100.\nX5."), "',R1': the lines form no corner");
  EXPECT_EQ(refusal("G1 X10. ,R0. F100.\nY5."), "',R0': the lines form no corner");
  EXPECT_EQ(refusal("G1 X10. ,R6. F100.\nY5."),
            "',R6' requires 6 of each line; the shorter one is 5");
  EXPECT_EQ(read("G93\nG1 X10. ,C2. F100.\nY5. F100.\nM2\n", Reader::any, {}).moves,
            "p.nc:2:9: error: ',C' is supported only in G94, without G16, G51, G54.1 and G68; "
            "program the corner");
  EXPECT_EQ(read("(TITLE)\nG0 X1.\n,R5.\nM2\n", Reader::fanuc, {}).moves,
            "p.nc:3:1: error: ',R' requires a linear move in its block");
}

// The comma is missing: an alarm, or a corner where the control is so set.
TEST(RuleExamples, ARadiusBesideALineIsRefusedByName) {
  EXPECT_EQ(read("G1 X30. R5. F100.\nY20.\nM2\n", Reader::any, {}).moves,
            "p.nc:1:9: error: R with G1: corner rounding to the next line on lathes and with Fanuc "
            "parameter 3405#4, an alarm otherwise; program ,R5 after G1, or the arc");
  EXPECT_EQ(read("G2 X2. R1. F100.\nG1 X5.\nM2\n", Reader::any, {}).moves,
            "CW 2 0 0 o 1 0 0 f100 | F 5 0 0");
}

TEST(RuleExamples, PocketsOfHaasThatCannotBeAreRefused) {
  const auto refusal = [](const std::string& block) {
    return read("T1 M6\n" + block + "\nM2\n", Reader::haas, {.has_tools = true}).moves;
  };
  EXPECT_EQ(refusal("G12 D1 I.5 F100."),
            "p.nc:2:1: error: G12: the tool of radius 1 does not fit in I0.5");
  EXPECT_EQ(refusal("G12 D1 I2. K3. F100."),
            "p.nc:2:1: error: G12 requires G17, I > 0, and Q > 0 with K > I");
  EXPECT_EQ(
      refusal("G13 D1 I2. L3 F100."),
      "p.nc:2:12: error: G13 with L repeats it deeper by Z: requires G91, Z and an integer L");
}

// ,R5 is 5 um where X30 is 30 um.
TEST(RuleExamples, ACornerWithoutADecimalPointIsAsOtherLengthsAre) {
  EXPECT_EQ(read("G1 X30000 ,R5000 F100.\nY20000\nM2\n", Reader::fanuc,
                 {.decimal_point = DecimalPoint::increments})
                .moves,
            "F 25 0 0 f100 | CCW 30 5 0 o 25 5 0 | F 30 20 0");
}

// The radius changes in proportion to the angle: 5.04, 5.00, 4.96 mm (Fanuc B-63324EN/01, section
// 4.4).
TEST(RuleExamples, ASpiralIsHalfwayBetweenItsRadiiInTheMiddle) {
  const auto moves =
      interpret("G2 X10. Y0. I5.04 F100.\nM2\n", "p.nc", setup_of({}, Reader::fanuc));
  const AxisWords middle = MoveCurve(AxisWords::Zero(), moves[0]).at(0.5);
  EXPECT_NEAR(middle[0], 5.04 * mm, 1e-15);
  EXPECT_NEAR(middle[1], 5.00 * mm, 1e-15);
}

TEST(TolerantLine, KeepsEveryColumn) {
  for (const RuleExample& one : rule_examples()) {
    const std::string line = one.program.substr(0, one.program.find('\n'));
    EXPECT_EQ(tolerant_line(line, Reader::any).text.size(), std::min(line.size(), kLongestLine));
    EXPECT_EQ(tolerant_line(line, Reader::linuxcnc).text, line);
  }
}

}  // namespace
}  // namespace servomill::controllers::rule_examples_test
