// Programs that are precompensated for what a model of the machine predicts.
#include "sim/programs/compensate/servo_offset.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "plant/vocabulary/input_error.h"
#include "sim/programs/verification/verification.h"
#include "tests/sim/programs/compensate/trial.h"

namespace servomill::sim::programs {
namespace {

const std::string kPart =
    "G17 G21 G90 G94 G64 P0.001 G54\nT1 M6 G43 H1\nG0 X50 Y0 Z5\nG4 P0.3\nG1 Z-1 F600\n"
    "G3 I-50 F1500\nG1 X20 Y-30\nG4 P0.3\nG0 Z5\nM30\n";

Trial servo_trial(const std::string& program = kPart) {
  Trial trial(program);
  trial.request.inputs.parameter_file.clear();
  trial.request.servo_file = kRouter;
  trial.request.work_offsets = {"X=500,Y=400,Z=-60"};
  trial.request.start = "X=500,Y=380,Z=-10";
  return trial;
}

std::string refusal_of(const Trial& trial) {
  try {
    trial.run();
  } catch (const InputError& error) {
    return error.faults().front().message;
  }
  return "nothing is refused";
}

// The arcs and lines of a router whose errors and lag are known.
TEST(ServoOffset, LeavesOfThePredictedContourErrorLittle) {
  const Compensated done = servo_trial().run();
  ASSERT_TRUE(done.summary.servo.has_value());
  const ServoPrediction& servo = *done.summary.servo;
  EXPECT_GT(servo.before.contour, 100e-6);
  EXPECT_LT(servo.after.contour, 0.02 * servo.before.contour);
  EXPECT_LT(servo.after.tip_rms, 0.01 * servo.before.tip_rms);
  EXPECT_LT(servo.after.duration, 1.02 * servo.before.duration);
}

std::string text_of_file(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(ServoOffset, IsTheSameInEveryDialect) {
  const ServoPrediction linuxcnc = *servo_trial().run().summary.servo;
  for (const Dialect dialect : {Dialect::heidenhain, Dialect::fanuc, Dialect::siemens}) {
    Trial trial = servo_trial();
    trial.request.dialect = dialect;
    trial.request.program_name = "PART";
    trial.request.program_number = 12;
    trial.request.retract_Z = -5e-3;
    const ServoPrediction other = *trial.run().summary.servo;
    EXPECT_EQ(other.after.contour, linuxcnc.after.contour);
    EXPECT_EQ(other.after.duration, linuxcnc.after.duration);
  }
}

// A block put elsewhere by more than the tolerance is no precompensated program any more.
TEST(ServoOffset, IsVerifiedFromTheText) {
  const Trial trial = servo_trial();
  std::string text = trial.run().program;
  EXPECT_NO_THROW(verify_compensated(trial.request, text));
  const std::size_t at = text.rfind(" Y-30");
  ASSERT_NE(at, std::string::npos);
  text.replace(at, 5, " Y-30.1");
  EXPECT_THROW(verify_compensated(trial.request, text), InputError);
}

// The start of the program cannot be displaced: where axes lag by a millimetre, the first blocks
// would have to lead back.
TEST(ServoOffset, ThatLeadsBackOnThePathIsRefused) {
  std::string machine = text_of_file(kRouter);
  const std::string gain = "Kv = \"25 1/s\"\n";
  machine.replace(machine.find(gain), gain.size(), gain + "velocity_feed_forward = 0.0\n");
  Trial trial = servo_trial();
  trial.request.servo_file = written("far_behind.toml", machine);
  EXPECT_NE(refusal_of(trial).find("differs in effect"), std::string::npos);
}

TEST(ServoOffset, OfAnotherMachineIsRefused) {
  Trial trial = servo_trial();
  trial.request.servo_file = SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml";
  EXPECT_EQ(refusal_of(trial),
            "is the model of another machine: 'GF/Mikron HSM 600U', where --machine is "
            "'three-axis router'");
}

TEST(ServoOffset, NeedsAStartInTheTravel) {
  Trial trial = servo_trial();
  trial.request.start.clear();
  EXPECT_NE(refusal_of(trial).find("needs --start"), std::string::npos);
  trial.request.start = "X=500,Y=380,Z=10";
  EXPECT_NE(refusal_of(trial).find("outside the travel"), std::string::npos);
}

TEST(ServoOffset, ThatLeavesTheTravelIsRefused) {
  EXPECT_NE(
      refusal_of(servo_trial(kPart.substr(0, kPart.find("G4 P0.3\nG0")) + "G1 X50 Y-400\nM30\n"))
          .find("travel"),
      std::string::npos);
}

TEST(ServoOffset, RefusesWhatTheModelCannotBeTold) {
  Trial smoothed = servo_trial();
  smoothed.request.smoothing = 10e-6;
  EXPECT_NE(refusal_of(smoothed).find("smoothing of other controls"), std::string::npos);
  Trial elsewhere = servo_trial();
  elsewhere.request.work_offsets.emplace_back("G55:X=10");
  EXPECT_NE(refusal_of(elsewhere).find("runs programs in G54"), std::string::npos);
}

}  // namespace
}  // namespace servomill::sim::programs
