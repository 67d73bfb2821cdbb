// A real drive: the EMPS benchmark (Janot, Gautier, Brunot 2019). The project does not ship the
// recording; where it is not there the tests are skipped.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

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
  Experiment experiment(const std::string& rest) {
    std::ofstream(files_.path("emps.toml")) << fmt::format(R"(machine = "machine.toml"
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
                                                           rest, kRecording);
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

}  // namespace
}  // namespace servomill::sim::identification::emps_test
