// A real drive: the EMPS benchmark (Janot, Gautier, Brunot 2019). The project does not ship the
// recording; where it is not there the tests are skipped.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "sim/identification/experiment.h"
#include "sim/identification/identification.h"
#include "sim/identification/identify.h"
#include "tests/sim/identification/axis_experiment.h"

namespace servomill::sim::identification::emps_test {
namespace {

const std::string kRecording =
    std::string(SERVOMILL_SOURCE_DIR) + "/../shared/data/measured/emps_train.mat";

class Emps : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kRecording)) GTEST_SKIP() << "no recording of the EMPS";
  }
  Experiment experiment(const std::string& rest, const std::string& machine = "machine.toml") {
    std::ofstream(files_.path("emps.toml")) << fmt::format(R"(machine = "{}"
[loop]
period_ms = 1.0
position_gain = "160.18 1/s"
velocity_gain = "8557.2675 N s/m"
feedback_mean_of = 2
{}
[[recording]]
file = "{}"
axis.X.command = {{ channel = "qg", unit = "m" }}
axis.X.feedback = {{ channel = "qm", unit = "m" }}
axis.X.force = {{ channel = "vir", factor = 35.15 }}
)",
                                                           machine, rest, kRecording);
    return read_experiment(files_.path("emps.toml"));
  }
  AxisExperiment files_;
};

constexpr const char* kLiterature = R"(
[[estimate]]
key = "axis.X.moving_mass"
[[estimate]]
key = "axis.X.slide_viscous_friction"
[[estimate]]
keys = ["axis.X.friction.coulomb", "axis.X.friction.breakaway"]
start = "20 N"
[[estimate]]
key = "axis.X.gravity_load"
)";

TEST_F(Emps, InverseDynamicsGivesTheNumbersOfTheLiterature) {
  const Experiment e = experiment(kLiterature);
  const InverseDynamics found = inverse_dynamics(e.records[0].record, false, {.held = false});
  EXPECT_NEAR(found.values[0], 95.11, 0.2);
  EXPECT_NEAR(found.values[1], 203.5, 2.0);
  EXPECT_NEAR(found.values[2], 20.39, 0.2);
  EXPECT_NEAR(found.values[3], -3.16, 0.05);
  const Uncertainty& u = found.uncertainty;
  EXPECT_LE(2.0 * u.standard(0), 0.02 * 95.11);
  EXPECT_LE(2.0 * u.standard(1), 0.10 * 203.5);
  EXPECT_LE(2.0 * u.standard(2), 0.05 * 20.39);
  EXPECT_GE(u.standard(1), 4.0 * u.counted[1]);
}

TEST_F(Emps, AForceThatIsHeldAgreesWithTheSimulation) {
  const Experiment e = experiment(kLiterature);
  const InverseDynamics held = inverse_dynamics(e.records[0].record, false);
  const Identification found = identify(e, 2);
  EXPECT_NEAR(held.values[1], found.fit.values[1], 2.0);
  EXPECT_NEAR(held.values[2], found.fit.values[2], 0.1);
}

TEST_F(Emps, TheSymmetricLawIsRejected) {
  const Experiment e = experiment(kLiterature);
  EXPECT_TRUE(test_symmetry(inverse_dynamics(e.records[0].record, true)).rejected());
}

TEST_F(Emps, TheLiteraturesModelLeavesWhatTheLiteratureSays) {
  const Identification found = identify(experiment(kLiterature), 2);
  // 1.776 um with its own start, which is at rest; the recording begins in motion
  EXPECT_LT(found.estimation[0].feedback_rms, 1.776e-6);
  EXPECT_LT(found.estimation[0].force_rms, 0.0527);
  EXPECT_NEAR(found.fit.values[0], 95.11, 0.5);
}

// Ten parameters, from rough guesses.
constexpr const char* kOwn = R"(
[[estimate]]
key = "axis.X.moving_mass"
start = "80 kg"
[[estimate]]
key = "axis.X.friction.viscous"
start = "180 N s/m"
[[estimate]]
key = "axis.X.friction.viscous_negative"
start = "220 N s/m"
[[estimate]]
key = "axis.X.friction.coulomb"
start = "20 N"
[[estimate]]
key = "axis.X.friction.coulomb_negative"
start = "20 N"
[[estimate]]
keys = ["axis.X.friction.breakaway", "axis.X.friction.breakaway_negative"]
start = "15 N"
[[estimate]]
key = "axis.X.friction.stribeck_velocity"
start = "15 mm/s"
[[estimate]]
key = "axis.X.friction.bristle_stiffness"
start = "1e6 N/m"
[[estimate]]
key = "axis.X.friction.bristle_damping"
start = "2000 N s/m"
[[estimate]]
key = "loop.dead_time_ms"
start = 0.3
min = 0.0
)";

TEST_F(Emps, FrictionByDirectionThatRisesWithTheSpeedLeavesHalf) {
  std::ofstream(files_.path("lugre.toml")) << R"(based_on = "machine.toml"
[axis.X]
slide_viscous_friction = "0 N s/m"
[axis.X.friction]
model = "lugre"
breakaway = "15 N"
breakaway_negative = "15 N"
coulomb_negative = "20 N"
stribeck_velocity = "15 mm/s"
bristle_stiffness = "1e6 N/m"
bristle_damping = "2000 N s/m"
)";
  const Experiment e = experiment(kOwn, "lugre.toml");
  const auto begin = std::chrono::steady_clock::now();
  const Identification found = identify(e, 2);
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
  const RecordResult& record = found.estimation[0];
  std::printf("position rms %.3f um, force rms %.2f %%, in %.1f s\n", 1e6 * record.feedback_rms,
              100.0 * record.force_rms, time.count());
  EXPECT_LE(record.feedback_rms, 1.0e-6);
  EXPECT_LE(record.force_rms, 0.033);
  for (std::size_t k = 0; k < found.estimates.size(); ++k) {
    EXPECT_TRUE(found.uncertainty.identifiable[k]) << k;
  }
  EXPECT_GT(found.fit.values[2] - found.fit.values[1], 5.0 * found.uncertainty.standard(1))
      << "viscous friction by direction";
  EXPECT_LT(found.fit.values[5], found.fit.values[3]) << "friction falls towards zero speed";
}

}  // namespace
}  // namespace servomill::sim::identification::emps_test
