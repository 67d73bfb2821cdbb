// Motions of programs for other controls: arcs in every plane, rapids and endless axes.
#include "tests/sim/programs/compensate/dialect_trial.h"

namespace servomill::sim::programs::dialect_motion_test {
namespace {

TEST(DialectMotion, PolarMovesAreWrittenWhileZIsUnknown) {
  EXPECT_EQ(body(Dialect::fanuc, "G21 G90\nG0 X1 Y1\nG91 @1\nM2\n"),
            "G54\n"
            "G0 X1. Y1.\n"
            "X1.707 Y1.707\n");
}

// Axes may run at their own rates: up before across, across before down.
TEST(DialectMotion, RapidsInZAndOtherAxesAreTwo) {
  EXPECT_EQ(body(Dialect::siemens, kDialectStart + "G0 X1 Y1 Z5\nX20 Z10\nX30 Z2\nX40 Z2\nM2\n"),
            "T1\n"
            "M6\n"
            "G17 G40 G64 G90 G94 G710 G54\n"
            "TRANS\n"
            "S1000 M3\n"
            "G0 X1 Y1\n"
            "D1 Z5\n"
            "Z10\n"
            "X20\n"
            "X30\n"
            "Z2\n"
            "X40\n");
}

TEST(DialectMotion, ArcsStayArcs) {
  const std::string program = kDialectStart +
                              "G0 X10 Y0 Z5\nG1 Z0 F100\nG2 X0 Y-10 I-10 J0\nG3 X0 Y-10 I0 J10\n"
                              "G3 X10 Y0 Z-1 I0 J10\nG18 G2 X0 Z-11 I-10 K0\nM2\n";
  const auto from = [&](Dialect dialect, const std::string& first) {
    const std::string text = body(dialect, program);
    const std::size_t begin = text.find(first);
    return begin == std::string::npos ? text : text.substr(begin, 100);
  };
  EXPECT_TRUE(from(Dialect::fanuc, "G2 ")
                  .starts_with("G2 X0. Y-10. I-10. J0.\n"
                               "G3 X0. Y-10. I0. J10.\n"
                               "X10. Y0. Z-1. I0. J10. F99.798\n"
                               "G1 X"));
  EXPECT_TRUE(from(Dialect::siemens, "G2 ")
                  .starts_with("G2 X0 Y-10 I-10 J0\n"
                               "G3 X0 Y-10 I0 J10\n"
                               "X10 Y0 Z-1 I0 J10\n"
                               "CIP X-7.07107 Z6.07107 "));
  EXPECT_TRUE(from(Dialect::heidenhain, "CC ")
                  .starts_with("CC X+0 Y+0\n"
                               "C X+0 Y-10 DR-\n"
                               "CC X+0 Y+0\n"
                               "C X+0 Y-10 DR+\n"
                               "CC X+0 Y+0\n"
                               "CP IPA+90 Z-1 DR+\n"
                               "L X"));
}

std::vector<std::string> warnings_about_arcs(const Trial& trial) {
  std::vector<std::string> out;
  for (const Fault& fault : trial.run().warnings) {
    if (fault.message.starts_with("arcs in G18")) out.push_back(fault.message);
  }
  return out;
}

const std::string kArcsInAllPlanes = kDialectStart +
                                     "G0 X10 Y0 Z5\nG1 Z0 F100\nG18 G3 X0 Z10 I-10 K0\n"
                                     "G19 G2 Y10 Z0 J0 K-10\nG2 Y10 Z0 J-10 K0\n"
                                     "G18 G2 X10 Y11 Z10 I10 K0\nM2\n";

// G18 and G19 exchange the components of the tool length where SD42940 is 0. CIP needs no plane
// (6FC5398-2EP40-0BA0 p. 750, p. 198); a circle has its end where it begins and becomes two.
TEST(DialectMotion, ArcsOfSiemensInOtherPlanesGoThroughAPoint) {
  const Trial trial = dialect_trial(Dialect::siemens, kArcsInAllPlanes);
  const std::string text = body(trial);
  const std::size_t begin = text.find("CIP");
  ASSERT_NE(begin, std::string::npos) << text;
  EXPECT_TRUE(
      text.substr(begin).starts_with("CIP X-7.07107 Z-7.07107 I1=AC(3.82683) J1=AC(0) "
                                     "K1=AC(-9.2388)\n"
                                     "X0 Z10 I1=AC(-9.2388) J1=AC(0) K1=AC(3.82683)\n"
                                     "Y10 Z0 I1=AC(0) J1=AC(7.07107) K1=AC(7.07107)\n"
                                     "Y-10 Z0 I1=AC(0) J1=AC(0) K1=AC(-10)\n"
                                     "Y10 Z0 I1=AC(0) J1=AC(0) K1=AC(10)\n"
                                     "G1 X"))
      << text.substr(begin, 400);
  EXPECT_EQ(text.find("G18"), std::string::npos);
  EXPECT_EQ(text.find("G19"), std::string::npos);
  EXPECT_EQ(warnings_about_arcs(trial),
            std::vector<std::string>{
                "arcs in G18 and G19 written as lines: 1; G18 may assign the tool length to "
                "another axis (SD42940), and CIP cannot describe a helix"});
}

TEST(DialectMotion, ArcsInOtherPlanesAreLinesWhereTheLengthMayFollow) {
  EXPECT_EQ(warnings_about_arcs(dialect_trial(Dialect::fanuc, kArcsInAllPlanes)),
            std::vector<std::string>{"arcs in G18 and G19 written as lines: 4; the tool length may "
                                     "follow a change of the plane (No. 5001#1, TLB, may be 1; "
                                     "--without length-b)"});
  EXPECT_EQ(warnings_about_arcs(dialect_trial(Dialect::heidenhain, kArcsInAllPlanes)),
            std::vector<std::string>{"arcs in G18 and G19 written as lines: 4; circles are in the "
                                     "plane normal to the tool axis (TNC 407 manual p. 5-20)"});
  EXPECT_TRUE(
      warnings_about_arcs(dialect_trial(Dialect::fanuc, kDialectStart + "G0 X1 Y1 Z5\nM2\n"))
          .empty());
}

// The errors of the router move the third axis, too: a circle through a point may be tilted by 1
// um.
TEST(DialectMotion, CorrectedArcsInOtherPlanesAreVerified) {
  Trial trial = dialect_trial(Dialect::siemens, kArcsInAllPlanes);
  trial.request.error_file.clear();
  EXPECT_EQ(warnings_about_arcs(trial).size(), 1U);
}

// Its digits would make a full circle of it, or nothing.
TEST(DialectMotion, ArcsShorterThanTheDigitsAreLines) {
  const std::string text =
      body(Dialect::fanuc,
           kDialectStart + "G0 X10 Y0 Z5\nG1 Z0 F100\nG3 X10 Y0.0004 I-10 J0.0002\nG1 X0 Y5\nM2\n");
  EXPECT_EQ(text.find("G3 "), std::string::npos) << text;
}

TEST(DialectMotion, RotaryAxesBesideLinearOnesFeedByTime) {
  Trial trial = dialect_trial(Dialect::heidenhain,
                              kDialectStart + "G0 X0 Y0 B0 C0\nZ5\nG1 X10 C90 F600\nM2\n");
  trial.request.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml";
  const std::string text = body(trial);
  EXPECT_NE(text.find("L X+10 C+90 FT1\n"), std::string::npos) << text;
  EXPECT_NE(trial.run().program.find("PLANE RESET STAY"), std::string::npos);
}

// Axes without ends may be modulo axes: a plain angle leaves the way to the builder, and one
// outside 0 ... 360 is another angle. B of this machine has ends, C has none.
TEST(DialectMotion, EndlessAxesOfSiemensSayTheirWay) {
  Trial trial = dialect_trial(Dialect::siemens,
                              "G21 G90 G17 G54\nT1 M6\nG0 X1 Y1 B-30 C350\nC10\nC-40\nC400\nC20\n"
                              "G55 C30\nM0\nC-10\nM2\n");
  trial.request.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml";
  EXPECT_EQ(body(trial),
            "T1\n"
            "M6\n"
            "G17 G40 G64 G90 G94 G710 G54\n"
            "TRANS\n"
            "TRAFOOF\n"
            "G0 X1 Y1 B-30 C=AC(350)\n"
            "C=AC(10)\n"
            "C=IC(-50)\n"
            "C=IC(440)\n"
            "C=IC(-380)\n"
            "G55\n"
            "C=AC(30)\n"
            "M0\n"
            "C-10\n");
}

// Below half a turn a control whose axes roll over and one whose axes count go the same way.
TEST(DialectMotion, EndlessAxesOfFanucTurnByLessThanHalfATurn) {
  const std::string start = "G21 G90 G17 G54\nT1 M6\nG0 X1 Y1 B0 C350\n";
  Trial trial = dialect_trial(Dialect::fanuc, start + "C500\nM0\nC10\nM2\n");
  trial.request.machine_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml";
  EXPECT_NE(body(trial).find("C350.\nC500.\nM0\nC10.\n"), std::string::npos) << body(trial);
  trial.request.program_file = written("plate.ngc", start + "C100\nM2\n");
  EXPECT_EQ(refusal(trial),
            "plate.ngc:4: error: rotates C by 250 deg in one block, for which a control with "
            "rollover axes (No. 1008#0, ROA = 1) takes the shorter direction; split it, or pass "
            "--without rollover if ROA = 0; it cannot be expressed in fanuc");
  trial.request.without = {"rollover"};
  EXPECT_NE(body(trial).find("C350.\nC100.\n"), std::string::npos) << body(trial);
}

// G18 and G19 are in force for arcs only.
TEST(DialectMotion, ArcsOfFanucInOtherPlanesAreOnTheUsersWord) {
  Trial trial = dialect_trial(Dialect::fanuc, kArcsInAllPlanes);
  trial.request.without = {"length-b"};
  const std::string text = body(trial);
  EXPECT_TRUE(text.substr(std::min(text.find("G18"), text.size()))
                  .starts_with("G18 G3 X0. Z10. I-10. K0.\n"
                               "G19 G2 Y10. Z0. J0. K-10.\n"
                               "Y10. Z0. J-10. K0.\n"
                               "G18 X10. Y11. Z10. I10. K0. F99.977\n"))
      << text;
  EXPECT_TRUE(warnings_about_arcs(trial).empty());
  const std::string all = trial.run().program;
  EXPECT_NE(all.find("(ASSUMED: THE TOOL LENGTH ACTS ALONG Z IN EVERY PLANE [NO. 5001#1, TLB, IS "
                     "0])\n"),
            std::string::npos)
      << all;
  trial.request.program_file = written(
      "plate.ngc", kDialectStart + "G0 X10 Y0 Z5\nG1 Z0 F100\nG18 G3 X0 Z10 I-10 K0\nG1 X5\nM2\n");
  EXPECT_NE(body(trial).find("K0.\nG17 G1 X5.\n"), std::string::npos) << body(trial);
}

TEST(DialectMotion, BlocksThatChangeTheToolLengthAreLines) {
  const std::string program =
      kDialectStart + "G0 X10 Y0\nZ5\nG53 G0 Z0\nG3 X0 Y10 Z20 I-10 J0 F100\nM2\n";
  for (const Dialect dialect : {Dialect::fanuc, Dialect::siemens}) {
    const std::string text = body(dialect, program);
    EXPECT_EQ(text.find("G3 "), std::string::npos) << text;
  }
}

// Verification takes a rapid across whether its axes arrive together or not: what is beside its
// line is the user's word. Siemens moves along it where G64 is in force ([P] p. 181).
TEST(DialectMotion, RapidsThatMayLeaveTheirLineAreTheUsersWord) {
  const auto is_assumed = [](Dialect dialect, const std::string& moves) {
    const std::string written =
        dialect_trial(dialect, kDialectStart + moves + "M2\n").run().program;
    std::string text;
    for (const char c : written) text += static_cast<char>(std::tolower(c));
    return text.find("rapids of several axes are collision-free off their line") !=
           std::string::npos;
  };
  for (const Dialect dialect : {Dialect::fanuc, Dialect::heidenhain}) {
    EXPECT_TRUE(is_assumed(dialect, "G0 X1 Y1\nZ5\n"));
    EXPECT_FALSE(is_assumed(dialect, "G0 X1\nY1\nZ5\nG1 X2 Y2 F100\n"));
  }
  EXPECT_FALSE(is_assumed(Dialect::siemens, "G0 X1 Y1\nZ5\n"));
  EXPECT_TRUE(is_assumed(Dialect::siemens, "G61.1\nG0 X1 Y1\nZ5\n"));
}

}  // namespace
}  // namespace servomill::sim::programs::dialect_motion_test
