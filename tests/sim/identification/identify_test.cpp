#include "sim/identification/identify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>

#include "sim/identification/experiment.h"
#include "sim/identification/identification.h"
#include "sim/identification/identified_machine.h"
#include "sim/identification/report.h"
#include "sim/identification/synthesize.h"
#include "sim/input/identified_values.h"
#include "sim/input/write_identified.h"
#include "tests/sim/identification/axis_experiment.h"
#include "tests/text.h"

namespace servomill::sim::identification::identify_test {
namespace {

constexpr const char* kFour = R"(
[[estimate]]
key = "axis.X.moving_mass"
start = "70 kg"
[[estimate]]
key = "axis.X.slide_viscous_friction"
start = "100 N s/m"
[[estimate]]
keys = ["axis.X.friction.coulomb", "axis.X.friction.breakaway"]
start = "12 N"
[[estimate]]
key = "axis.X.gravity_load"
)";

AxisModel truth() {
  AxisModel model{small_axis(), small_loop()};
  model.drive.M = 88.0;
  model.drive.b_load = 170.0;
  model.drive.F_load = 4.0;
  model.drive.friction.Fc_positive = model.drive.friction.Fc_negative = 17.0;
  model.drive.friction.Fs_positive = model.drive.friction.Fs_negative = 17.0;
  return model;
}

const NoiseSettings kNoise{.force_rms = 1.0, .force_time = 5e-3, .feedback_step = 50e-9};

// The result points into the experiment.
struct Identified {
  Experiment experiment;
  Identification found;
  Identified(const AxisExperiment& files, const std::string& rest)
      : experiment(read_experiment(files.write(rest))), found(identify(experiment, 2)) {}
};

TEST(Identify, WithoutNoiseTheValuesAreThoseOfTheAxis) {
  const AxisExperiment files;
  files.write_recording(recorded(ramps(2.0), truth()));
  const Identified result(files, kFour);
  const Identification& found = result.found;
  EXPECT_NEAR(found.fit.values[0], 88.0, 1e-3);
  EXPECT_NEAR(found.fit.values[1], 170.0, 1e-2);
  EXPECT_NEAR(found.fit.values[2], 17.0, 1e-3);
  EXPECT_NEAR(found.fit.values[3], 4.0, 1e-3);
  EXPECT_LT(found.estimation[0].feedback_rms, 1e-9);
}

TEST(Identify, WithNoiseTheIntervalsHoldTheTruthAndTheMachineIsWritten) {
  const AxisExperiment files;
  files.write_recording(synthesize(ramps(4.0), truth(), kNoise));
  const Experiment experiment = read_experiment(files.write(kFour));
  const Identification found = identify(experiment, 2);
  const double true_values[] = {88.0, 170.0, 17.0, 4.0};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_TRUE(found.uncertainty.identifiable[k]);
    EXPECT_NEAR(found.fit.values[k], true_values[k], 2.0 * found.uncertainty.half_width(k)) << k;
  }
  EXPECT_EQ(warnings(found), std::vector<std::string>{});
  const input::IdentifiedFile file = identified_machine(experiment, found, files.path("out.toml"));
  EXPECT_EQ(file.based_on, "machine.toml");
  EXPECT_EQ(file.identified.keys.size(), 5u) << "one for each key of the file";
  EXPECT_EQ(file.identified.covariance(2, 3), file.identified.covariance(2, 2));
  input::write_identified_file(files.path("out.toml"), file, false);
}

TEST(Identify, PredictsRecordingsThatItHasNotSeen) {
  const AxisExperiment files;
  files.write_recording(synthesize(ramps(3.0), truth(), kNoise));
  NoiseSettings other = kNoise;
  other.seed = 2;
  files.write_recording(synthesize(ramps(2.0), truth(), other), "later.csv");
  const Identified result(files, std::string(R"(
[[recording]]
file = "later.csv"
use = "validation"
axis.X = { command = "q", feedback = "y", force = "F" }
)") + kFour);
  const Identification& found = result.found;
  ASSERT_EQ(found.validation.size(), 1u);
  EXPECT_NEAR(found.validation[0].feedback_rms / found.estimation[0].feedback_rms, 1.0, 0.25);
}

// Three experiments that cannot tell what they are asked for.
TEST(Identify, CoulombFrictionByDirectionAndTheLoadAreIdentifiedInCombinationsOnly) {
  const AxisExperiment files;
  Record motion = ramps(3.0);
  files.write_recording(synthesize(motion, truth(), kNoise));
  const Identified result(files, R"(
[[estimate]]
key = "axis.X.gravity_load"
[[estimate]]
keys = ["axis.X.friction.coulomb", "axis.X.friction.breakaway"]
start = "15 N"
[[estimate]]
keys = ["axis.X.friction.coulomb_negative", "axis.X.friction.breakaway_negative"]
start = "15 N"
)");
  const Identification& found = result.found;
  for (const std::size_t k : {0u, 1u, 2u}) EXPECT_FALSE(found.uncertainty.identifiable[k]) << k;
  ASSERT_EQ(unidentifiable_sentences(found).size(), 1u);
  EXPECT_NE(unidentifiable_sentences(found)[0].find(
                "axis.X.gravity_load, axis.X.friction.coulomb, "
                "axis.X.friction.coulomb_negative: only combinations"),
            std::string::npos)
      << unidentifiable_sentences(found)[0];
}

TEST(Identify, MotorInertiaAndMassOfARigidAxisAreOneNumber) {
  const AxisExperiment files;
  files.write_recording(synthesize(ramps(2.0), truth(), kNoise));
  const Identified result(files, R"(
[[estimate]]
key = "axis.X.moving_mass"
[[estimate]]
key = "axis.X.motor_inertia"
start = "1e-6 kg m^2"
)");
  const Identification& found = result.found;
  EXPECT_FALSE(found.uncertainty.identifiable[0] || found.uncertainty.identifiable[1]);
  ASSERT_EQ(unidentifiable_sentences(found).size(), 1u);
}

TEST(Identify, WhatTheRecordingDoesNotDependOnIsSaid) {
  const AxisExperiment files;
  files.write_recording(synthesize(ramps(2.0), truth(), kNoise));
  const Identified result(files, R"(
[[estimate]]
key = "axis.X.moving_mass"
[[estimate]]
key = "axis.Y.moving_mass"
)");
  const Identification& found = result.found;
  EXPECT_TRUE(found.uncertainty.identifiable[0]);
  EXPECT_FALSE(found.uncertainty.identifiable[1]);
  EXPECT_EQ(
      unidentifiable_sentences(found),
      (std::vector<std::string>{
          "axis.Y.moving_mass: the recordings do not depend on it; the start value is kept"}));
}

TEST(Identify, AForeignLoopShowsInTheResidual) {
  const AxisExperiment files;
  AxisModel other = truth();
  other.loop.Kv = 60.0;
  files.write_recording(recorded(ramps(2.0), other));
  const Identified result(files, kFour);
  const auto said = warnings(result.found);
  ASSERT_FALSE(said.empty());
  EXPECT_NE(said.back().find("off the recorded one; the loop is not that of the recording"),
            std::string::npos);
}

TEST(Identify, AMassOf95TonsIsNamed) {
  const AxisExperiment files;
  Record record = recorded(ramps(2.0), truth());
  for (double& force : record.force) force *= 1000.0;  // mN taken for N
  files.write_recording(record);
  std::ofstream(files.path("open.toml")) << R"(machine = "machine.toml"
[loop]
kind = "open"
period_ms = 1.0
[[recording]]
file = "recording.csv"
axis.X = { feedback = "y", force = "F" }
[[estimate]]
key = "axis.X.moving_mass"
)";
  const Experiment experiment = read_experiment(files.path("open.toml"));
  const Identification found = identify(experiment, 2);
  ASSERT_FALSE(found.implausible.empty());
  EXPECT_NE(warnings(found).front().find("recording.csv: axis.X.moving_mass = "), std::string::npos)
      << warnings(found).front();
  EXPECT_NE(
      warnings(found).front().find("times its start value: a channel has the wrong unit or factor"),
      std::string::npos);
}

TEST(Identify, AValueAtItsBoundIsNamed) {
  const AxisExperiment files;
  files.write_recording(recorded(ramps(1.0), truth()));
  const Identified result(files, R"(
[[estimate]]
key = "axis.X.moving_mass"
min = "92 kg"
)");
  const auto said = warnings(result.found);
  EXPECT_NE(std::find(said.begin(), said.end(), "axis.X.moving_mass has ended at its bound 92 kg"),
            said.end());
}

// The mass is held there; what the others are known to is for that mass.
TEST(Identify, AValueAtItsBoundIsWrittenWithoutAnUncertainty) {
  const AxisExperiment files;
  files.write_recording(recorded(ramps(1.0), truth()));
  const Identified result(files, R"(
[[estimate]]
key = "axis.X.moving_mass"
min = "92 kg"
[[estimate]]
key = "axis.X.slide_viscous_friction"
)");
  EXPECT_TRUE(has_value_at_bound(result.found));
  EXPECT_TRUE(faults(result.found).empty());
  EXPECT_FALSE(result.found.uncertainty.identifiable[0]);
  EXPECT_NE(report(result.experiment, result.found).find("at its bound"), std::string::npos);
  const std::string path = files.path("out.toml");
  const auto file = identified_machine(result.experiment, result.found, path);
  EXPECT_EQ(file.identified.keys, std::vector<std::string>{"axis.X.slide_viscous_friction"});
  EXPECT_NE(identified_text(file).find("moving_mass = \"92 kg\"  # at its bound\n"),
            std::string::npos)
      << identified_text(file);
  input::write_identified_file(path, file, false);
}

TEST(Identify, NothingIsWrittenOfAFitThatIsNone) {
  const AxisExperiment files;
  files.write_recording(recorded(ramps(1.0), truth()));
  Identified result(files, kFour);
  EXPECT_EQ(faults(result.found), std::vector<std::string>{});
  Identification& found = result.found;
  found.fit.converged = false;
  found.fit.message = "Maximum number of iterations reached.";
  found.estimation[0].feedback_rms = 100.0;
  found.uncertainty.covariance(0, 0) = std::numeric_limits<double>::infinity();
  const std::string messages =
      fault_messages([&] { identified_machine(result.experiment, found, files.path("out.toml")); });
  EXPECT_EQ(messages.find("not written: the fit has not converged: Maximum number of iterations "
                          "reached.; start from the printed values, or estimate fewer parameters\n"
                          "not written: recording.csv: the simulation is 1e+08 um rms off the "
                          "recording, whose motion is "),
            0u)
      << messages;
  EXPECT_TRUE(
      messages.ends_with(" um rms itself; the loop is not that of the recording\n"
                         "not written: the covariance of the values is not finite\n"))
      << messages;
}

// 160 1/s with 10 ms: 1.6 of a step at once, and a velocity loop of 8557 N s/m / 95 kg 0.9 more.
TEST(Identify, ALoopWithWhichTheMotionDivergesIsRefused) {
  const AxisExperiment files;
  files.write_recording(recorded(ramps(1.0), truth()));
  std::ifstream file(files.write(kFour));
  std::string text(std::istreambuf_iterator<char>(file), {});
  const std::string period = "period_ms = 1.0";
  ASSERT_NE(text.find(period), std::string::npos);
  text.replace(text.find(period), period.size(), "period_ms = 10");
  std::ofstream(files.path("slow.toml")) << text;
  const Experiment slow = read_experiment(files.path("slow.toml"));
  EXPECT_EQ(fault_messages([&] { identify(slow, 2); }),
            "the motion that is simulated with the starting values diverges: the loop (period_ms = "
            "10, gains, signs) or a starting value is not that of the recording\n");
}

TEST(Identify, ANumberWithoutAUnitHasThatOfItsKey) {
  const AxisExperiment files;
  files.write_recording(recorded(ramps(0.5), truth()));
  const Experiment experiment = read_experiment(files.write(R"(
[[estimate]]
key = "axis.X.slide_viscous_friction"
start = 100
min = 10
[[estimate]]
key = "axis.X.velocity_reset_time_ms"
start = 20
[[estimate]]
key = "loop.dead_time_ms"
start = 0.1
[[estimate]]
key = "loop.velocity_feed_forward"
start = 0.5
)"));
  std::vector<std::string> units;
  for (const Estimate& one : experiment.estimates) units.push_back(one.unit);
  EXPECT_EQ(units, (std::vector<std::string>{"N s/m", "ms", "ms", ""}));
}

TEST(Identify, NamesLawsThatPredictFarWorseThanTheyFit) {
  Identification result;
  result.fit.converged = true;
  const auto law = [&](const char* name, double held_out) -> LawResult& {
    result.laws.emplace_back().name = name;
    result.laws.back().rms = 1e-6;
    result.laws.back().held_out = held_out;
    return result.laws.back();
  };
  law("viscous", 2.1e-6);
  law("Coulomb", 1.9e-6);
  law("LuGre", 80.0);
  law("Stribeck", 1.0).refused = "too stiff";
  ASSERT_EQ(warnings(result).size(), 1U);
  EXPECT_EQ(
      warnings(result).back(),
      "friction law 'viscous', 'LuGre': the held-out error is above 2 times the rms of the "
      "fit, since two thirds of the recording do not determine all values; compare the laws on "
      "a longer recording with more reversals");
}

TEST(Identify, AMachineInTheExperimentCannotBeLaidOver) {
  const AxisExperiment files;
  files.write_recording(recorded(ramps(0.5), truth()));
  Experiment experiment = read_experiment(files.write(kFour));
  experiment.machine_path.clear();
  EXPECT_EQ(fault_messages([&] { identified_machine(experiment, {}, "out.toml"); }),
            "describes the machine itself; name a machine file (machine = \"FILE\") so that the "
            "identified values can override it\n");
}

}  // namespace
}  // namespace servomill::sim::identification::identify_test
