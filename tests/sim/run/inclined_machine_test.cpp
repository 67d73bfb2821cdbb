/// Rotary axes of machine files: their directions, and the generic machines.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "plant/kinematics/inverse.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"

namespace servomill::sim::run::inclined_machine_test {
namespace {

using Eigen::Vector3d;
namespace fs = std::filesystem;

const fs::path kMachines = SERVOMILL_SOURCE_DIR "/scenarios/machines";

// Message on reading the nutating head with `old_text` replaced, with the place of the fault.
std::string message_with(const std::string& old_text, const std::string& new_text) {
  std::ifstream in(kMachines / "generic_nutating_head_bc.toml");
  std::stringstream text;
  text << in.rdbuf();
  std::string machine = text.str();
  const std::size_t at = machine.find(old_text);
  EXPECT_NE(at, std::string::npos);
  machine.replace(at, old_text.size(), new_text);
  const fs::path file = fs::path(testing::TempDir()) / "inclined_machine_test.toml";
  std::ofstream(file) << machine;
  try {
    input::read_machine_file(file);
  } catch (const InputError& e) {
    const std::string what = e.what();
    return what.substr(what.find(".toml:") + 6);
  }
  return "accepted";
}

TEST(DirectionOfAnAxis, InclinesIt) {
  const model::MachineSettings machine =
      input::read_machine_file(kMachines / "generic_nutating_head_bc.toml");
  const auto& B = machine.chain.at(Axis::B);
  EXPECT_TRUE(B.is_inclined);
  EXPECT_LT((plant::direction_of(B) - Vector3d(0.0, std::sqrt(0.5), std::sqrt(0.5))).norm(), 1e-15);
  EXPECT_FALSE(machine.chain.at(Axis::C).is_inclined);
}

TEST(DirectionOfAnAxis, MayHaveAnyLength) {
  EXPECT_EQ(message_with("[0, 1, 1]", "[0, 1e-90, 1e-90]"), "accepted");
  EXPECT_EQ(message_with("[0, 1, 1]", "[-7.5, 0, 0.5]"), "accepted");
}

TEST(DirectionOfAnAxis, ThatIsNoneIsRefused) {
  const std::string rule = "must be [x, y, z], not all 0; the length is irrelevant";
  EXPECT_EQ(message_with("[0, 1, 1]", "[0, 0, 0]"),
            "68:13: error: axis.B.direction = [0, 0, 0]; " + rule);
  EXPECT_EQ(message_with("[0, 1, 1]", "[0, 1]"),
            "68:13: error: axis.B.direction = [0, 1]; " + rule);
  EXPECT_EQ(message_with("[0, 1, 1]", "[0, \"1\", 1]"),
            "68:17: error: axis.B.direction[1] = \"1\"; must be a number");
  EXPECT_EQ(message_with("[0, 1, 1]", "[0, nan, 1]"),
            "68:17: error: axis.B.direction[1] = nan; must be finite");
  EXPECT_EQ(message_with("[0, 1, 1]", "45"), "68:13: error: axis.B.direction = 45; must be a list");
}

TEST(DirectionOfAnAxis, OfALinearAxisIsRefused) {
  EXPECT_EQ(
      message_with("[axis.X]", "[axis.X]\ndirection = [1, 1, 0]"),
      "14:13: error: axis.X.direction = [1, 1, 0]; must not be given: only rotary axes can be "
      "inclined");
}

// Every machine of the folder, at a hundred poses within its travel.
TEST(MachineFiles, GoWhereTheirJointsSay) {
  constexpr double kRoundTrip = 1e-12;  // m or 1
  int machines = 0;
  for (const auto& entry : fs::directory_iterator(kMachines)) {
    if (entry.path().extension() != ".toml") continue;
    ++machines;
    const model::MachineSettings machine = input::read_machine_file(entry.path());
    plant::InverseSettings settings;
    settings.lower = machine.nc.lower;
    settings.upper = machine.nc.upper;
    const plant::InverseKinematics inverse(machine.chain, settings);
    const Vector3d tip{0.0, 0.0, -0.12};
    for (int n = 0; n < 100; ++n) {
      Joints Q;
      for (int j = 0; j < kJoints; ++j) {
        const double share = 0.5 + 0.49 * std::sin((1.0 + j) * n);
        const double lower = std::max(settings.lower[j], -10.0);
        Q[j] = lower + share * (std::min(settings.upper[j], 10.0) - lower);
      }
      const ToolPose P = plant::forward(machine.chain, Q, tip);
      const plant::JointSolution found = inverse.nearest(P, tip, Q);
      ASSERT_TRUE(found.is_reached()) << entry.path();
      const ToolPose got = plant::forward(machine.chain, found.Q, tip);
      ASSERT_LT((got.p_WT - P.p_WT).norm(), kRoundTrip) << entry.path();
      ASSERT_LT((got.k_W - P.k_W).norm(), kRoundTrip) << entry.path();
    }
  }
  EXPECT_GE(machines, 6);
}

}  // namespace
}  // namespace servomill::sim::run::inclined_machine_test
