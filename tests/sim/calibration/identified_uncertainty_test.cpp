/// The file of a calibration holds the uncertainty of the tip that the adjustment has found.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "plant/vocabulary/units.h"
#include "sim/calibration/error_effects.h"
#include "sim/calibration/identified_errors.h"
#include "sim/input/read_machine.h"
#include "sim/input/uncertain_errors.h"
#include "sim/readings/readings.h"

namespace servomill::sim::calibration::identified_uncertainty_test {
namespace {

namespace fs = std::filesystem;
using Eigen::Matrix3d;
using Eigen::Vector3d;

const std::string kRouter = SERVOMILL_SOURCE_DIR "/scenarios/calibration/router/readings.toml";
const std::string kMachine = SERVOMILL_SOURCE_DIR "/scenarios/machines/router_3axis.toml";

class IdentifiedUncertainty : public testing::Test {
 protected:
  IdentifiedUncertainty()
      : machine_(input::read_machine_description(kMachine)),
        file_((fs::path(testing::TempDir()) / "servomill_uncertainty.toml").string()) {
    const plant::MachineChain& chain = machine_.machine.chain;
    result_ =
        calibrate(readings::read_readings(kRouter, chain, machine_.machine.nc.lower,
                                          machine_.machine.nc.upper, readings::Numbers::required),
                  chain, read_settings(kRouter, chain.layout));
    write_identified_errors(file_, result_, kMachine, "identified", true);
  }
  ~IdentifiedUncertainty() override { fs::remove(file_); }

  input::MachineDescription machine_;
  std::string file_;
  Calibration result_;
};

TEST_F(IdentifiedUncertainty, OfTheTipIsThatOfTheAdjustment) {
  const plant::MachineChain& chain = machine_.machine.chain;
  const auto errors = input::uncertain_errors_of_file(file_, "identified", chain.layout);
  ASSERT_TRUE(errors);
  const model::TipUncertainty tip(chain, *errors);
  const ErrorEffects effects(chain, result_.adjustment.unknowns);
  // between the targets, the adjustment adds waves that the file does not hold
  result_.adjustment.short_waves.assign(result_.adjustment.short_waves.size(), 0.0);
  for (const double x : {50.0, 333.0, 900.0}) {
    for (const double length : {60.0, 120.0}) {
      Joints Q = Joints::Zero();
      Q.head<3>() = Vector3d(x, 0.6 * x, -0.1 * x) * mm;
      const Vector3d p_ST(0.0, 0.0, -length * mm);
      const Matrix3d wanted = tip_covariance(effects, result_.adjustment, Q, p_ST);
      const Matrix3d found = tip.covariance(Q, p_ST, Joints::Zero());
      EXPECT_GT(wanted.trace(), um * um);
      // the numbers of the file cancel each other: a thousand times what is left
      EXPECT_LE((found - wanted).norm(), 1e-6 * wanted.norm()) << x << ' ' << length;
    }
  }
}

TEST_F(IdentifiedUncertainty, IsUnknownOfOtherModelsAndFiles) {
  const JointLayout& layout = machine_.machine.chain.layout;
  EXPECT_FALSE(input::uncertain_errors_of_file(file_, "measured", layout));
  EXPECT_FALSE(input::uncertain_errors_of_file(kMachine, "measured", layout));
}

}  // namespace
}  // namespace servomill::sim::calibration::identified_uncertainty_test
