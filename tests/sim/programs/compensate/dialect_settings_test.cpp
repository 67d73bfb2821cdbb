// Programs for other controls under the settings that a request names: retract, smoothing, preset,
// functions that the control lacks.
#include "tests/sim/programs/compensate/dialect_trial.h"

namespace servomill::sim::programs::dialect_settings_test {
namespace {

TEST(DialectSettings, SmoothingHoldsForFeedsOnly) {
  const auto smoothed = [](Dialect dialect) {
    Trial trial = dialect_trial(dialect, kDialectStart +
                                             "G0 X1 Y1\nZ5\nG1 Z-1 F100\nX2\nG0 Z40\nG53 G0 Z0\n"
                                             "G0 X5\nZ5\nG1 X9\nM2\n");
    trial.request.smoothing = 10e-6;
    const Compensated done = trial.run();
    EXPECT_TRUE(done.report[2].starts_with(
        "smoothing: the control may leave the corrected path by 10 um at corners of short blocks; "
        "simulated: by "))
        << done.report[2];
    const std::string text = body(trial);
    return text.substr(text.find("G54") == std::string::npos ? 0 : text.find("Z5"));
  };
  EXPECT_EQ(smoothed(Dialect::fanuc),
            "Z5.\n"
            "G5.1 Q1\n"
            "G1 Z-1. F100.\n"
            "X2.\n"
            "G0 Z40.\n"
            "G5.1 Q0\n"
            "G90 G49 G53 G0 Z0.\n"
            "X5.\n"
            "G43 H1 Z5.\n"
            "G5.1 Q1\n"
            "G1 X9.\n"
            "G5.1 Q0\n");
  EXPECT_EQ(smoothed(Dialect::siemens),
            "Z5\n"
            "CYCLE832(0.01,1,1)\n"
            "G1 Z-1 F100\n"
            "X2\n"
            "G0 Z40\n"
            "CYCLE832(0,0,1)\n"
            "SUPA G0 Z0 D0\n"
            "X5\n"
            "D1 Z5\n"
            "CYCLE832(0.01,1,1)\n"
            "G1 X9\n"
            "CYCLE832(0,0,1)\n");
  EXPECT_NE(smoothed(Dialect::heidenhain)
                .find("CYCL DEF 32.0 TOLERANCE\nCYCL DEF 32.1 T0.01\nL Z-1 F100\n"),
            std::string::npos);
}

TEST(DialectSettings, CodesThatTheControlDoesNotHaveAreLeftOut) {
  Trial trial = dialect_trial(Dialect::fanuc, kDialectStart + "G0 X1 Y1 Z5\nM2\n");
  trial.request.without = {"polar", "scaling", "mirror", "surface-speed", "preset"};
  const std::string text = said(trial);
  EXPECT_NE(text.find("N1 G21\nN2 G17 G40 G64 G80 G90 G94\nN3 G69\nN4 G52 X0. Y0. Z0.\nN5 G90 G49 "
                      "G53 G0 Z-2.\n"),
            std::string::npos)
      << text;
  EXPECT_NE(trial.run().program.find("(ASSUMED: NO G92 HAS SHIFTED THE WORK SYSTEMS, SO THAT G92.1 "
                                     "IS OMITTED)\n"),
            std::string::npos);
  trial.request.dialect = Dialect::siemens;
  EXPECT_THROW(trial.run(), InputError);
}

// Any row of the preset table, verified.
TEST(DialectSettings, PresetsOfAnyNumberAreVerified) {
  for (const int preset : {0, 1, 10, 9999}) {
    Trial trial = dialect_trial(Dialect::heidenhain, kDialectStart + "G0 X1 Y1 Z5\nM2\n");
    trial.request.preset = preset;
    EXPECT_NE(said(trial).find(fmt::format("Q339=+{} ;", preset)), std::string::npos);
  }
}

// A circle of short lines: smoothed by more it takes less time, and leaves the path by as much.
TEST(DialectSettings, SmoothingIsSimulated) {
  std::string program = kDialectStart + "G0 X20 Y0\nZ5\nG1 Z-1 F3000\n";
  for (int i = 1; i <= 60; ++i) {
    program += fmt::format("X{:.4f} Y{:.4f}\n", 20.0 * std::cos(i * 6.0 * deg),
                           20.0 * std::sin(i * 6.0 * deg));
  }
  Trial trial = dialect_trial(Dialect::fanuc, program + "M2\n");
  const auto numbers = [&](double smoothing) {
    trial.request.smoothing = smoothing;
    const std::string line = trial.run().report[2];
    const auto part =
        Pattern(".*simulated: by ([0-9.]+) um, ([0-9.]+) s at feed; limited to 1 um: ([0-9.]+) s")
            .parts_of(line);
    EXPECT_EQ(part.size(), 4U) << line;
    return std::array<double, 3>{std::stod(part.at(1)), std::stod(part.at(2)),
                                 std::stod(part.at(3))};
  };
  const auto [by_10, time_10, held_10] = numbers(10e-6);
  const auto [by_50, time_50, held_50] = numbers(50e-6);
  EXPECT_GT(by_10, 1.0);
  EXPECT_LE(by_10, 10.0);
  EXPECT_LE(by_50, 50.0);
  EXPECT_GE(by_50, by_10);
  EXPECT_LT(time_10, held_10);
  EXPECT_LE(time_50, time_10);
  EXPECT_EQ(held_10, held_50);
  trial.request.machine_file = written("ten.toml", "structure = \"[w b X Y Z (C1) t]\"\n");
  EXPECT_NE(
      trial.run().report[2].find("(not simulated: the machine file gives no v_max, a_max, j_max)"),
      std::string::npos);
}

// G54 and tool 1 have Z48 at the machine's Z-2.
TEST(DialectSettings, RetractsFromTheirOwnHeightAreWrittenAndVerified) {
  EXPECT_EQ(refusal(Dialect::fanuc, kDialectStart + "G0 X1 Y1\nZ5\nZ48\nM2\n"), "taken");
}

// A start given for LinuxCNC holds there; for other controls Z retracts first.
TEST(DialectSettings, TheStartOfZIsUnknownBehindTheRetract) {
  Trial trial = dialect_trial(Dialect::fanuc, "G21 G90\nG1 X1 F100\nM2\n");
  trial.request.start = "X=0,Y=0,Z=0";
  EXPECT_EQ(
      refusal(trial),
      "plate.ngc:2: error: feeds while the position of Z is unknown: no block since the start, the "
      "last tool change or the last stop programs it; program it in a rapid first");
  trial.request.dialect = Dialect::linuxcnc;
  EXPECT_EQ(refusal(trial), "taken");
}

// The errors of a trial for which the place matters.
Trial with_errors(Dialect dialect, const std::string& program) {
  Trial trial = dialect_trial(dialect, program);
  trial.request.error_file = written("scale.toml", "[errors.scale]\nEXX = { um_per_m = 100.0 }\n");
  return trial;
}

TEST(DialectSettings, RetractsOutsideTheTravelAreRefused) {
  Trial trial = with_errors(Dialect::fanuc, kDialectStart + "G0 X1 Y1\nZ5\nM2\n");
  trial.request.retract_Z = 50 * mm;
  try {
    trial.run();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "--retract Z=50: error: is outside the travel of Z, -150 ... 0 mm");
  }
}

// G54 and tool 1 have Z48 at the machine's Z-2.
TEST(DialectSettings, RetractsThatGoDownAreRefused) {
  const std::string program = kDialectStart + "G0 X1 Y1\nZ45\nZ5\nM2\n";
  EXPECT_EQ(refusal(with_errors(Dialect::fanuc, program)), "taken");
  Trial trial = with_errors(Dialect::siemens, program);
  trial.request.retract_Z = -60 * mm;
  EXPECT_EQ(refusal(trial),
            "plate.ngc:6: error: moves to machine Z-5.000, above the retract height Z-60; raise "
            "--retract, or check --work-offset and the tool length");
}

}  // namespace
}  // namespace servomill::sim::programs::dialect_settings_test
