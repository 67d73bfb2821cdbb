/// The file of a calibration holds the uncertainty of the tip that the adjustment has found.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "plant/vocabulary/units.h"
#include "sim/calibration/error_effects.h"
#include "sim/calibration/identified_errors.h"
#include "sim/calibration/short_waves.h"
#include "sim/input/machine_description.h"
#include "sim/input/read_machine.h"
#include "sim/input/uncertain_errors.h"
#include "sim/model/tip_uncertainty.h"
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
    const plant::MachineChain& chain = machine_.machine->chain;
    result_ =
        calibrate(readings::read_readings(kRouter, chain, machine_.machine->nc.lower,
                                          machine_.machine->nc.upper, readings::Numbers::required),
                  chain, read_settings(kRouter, chain.layout));
    write_identified_errors(file_, result_, kMachine, "identified", true);
  }
  ~IdentifiedUncertainty() override { fs::remove(file_); }

  input::MachineDescription machine_;
  std::string file_;
  Calibration result_;
};

TEST_F(IdentifiedUncertainty, OfTheTipIsThatOfTheAdjustment) {
  const plant::MachineChain& chain = machine_.machine->chain;
  const auto errors = input::uncertain_errors_of_file(file_, "identified", chain.layout);
  ASSERT_TRUE(errors);
  const model::TipUncertainty tip(chain, *errors);
  const ErrorEffects effects(chain, result_.adjustment.unknowns);
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

// Waves between the knots of a table, which the report states: nothing where the table was measured
// but its mean line, most in between. The file has a few periods of them in place of all.
TEST_F(IdentifiedUncertainty, OfShortWavesIsThatOfTheReportBetweenTheKnots) {
  const plant::MachineChain& chain = machine_.machine->chain;
  const ErrorEffects effects(chain, result_.adjustment.unknowns);
  const auto& functions = result_.adjustment.unknowns.functions;
  const auto table = std::find_if(functions.begin(), functions.end(), [](const auto& one) {
    return one.basis.form().knots.size() >= kMinKnots;
  });
  ASSERT_NE(table, functions.end());
  const double wave = 20 * um;
  const Vector3d p_ST(0.0, 0.0, -60 * mm);
  const auto found_at = [&](const Joints& Q) {
    const auto errors = input::uncertain_errors_of_file(file_, "identified", chain.layout);
    return model::TipUncertainty(chain, *errors).covariance(Q, p_ST, Joints::Zero()).eval();
  };
  const std::vector<double>& knots = table->basis.form().knots;
  std::vector<Joints> places;
  std::vector<Matrix3d> without;
  for (const double share : {0.0, 0.125, 0.25, 0.5, 0.75, 0.9}) {
    Joints Q = Joints::Zero();
    Q[index_of(table->name.axis)] = knots[3] + share * (knots[4] - knots[3]);
    places.push_back(Q);
    without.push_back(found_at(Q));
  }
  result_.adjustment.short_waves.at(std::size_t(table - functions.begin())) = wave;
  write_identified_errors(file_, result_, kMachine, "identified", true);
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Joints& Q = places[k];
    const double s = Q[index_of(table->name.axis)];
    const double wanted = wave * wave * interpolation_variance(table->basis, s);
    const Matrix3d grown = found_at(Q) - without[k];
    const double ratio = std::sqrt(grown(1, 1) / wanted);
    EXPECT_GT(ratio, 0.92) << s;  // four periods in place of all
    EXPECT_LT(ratio, 1.15) << s;
    EXPECT_LT(std::abs(grown(2, 2)), 1e-3 * wave * wave) << s;
  }
}

TEST_F(IdentifiedUncertainty, IsUnknownOfOtherModelsAndFiles) {
  const JointLayout& layout = machine_.machine->chain.layout;
  EXPECT_FALSE(input::uncertain_errors_of_file(file_, "measured", layout));
  EXPECT_FALSE(input::uncertain_errors_of_file(kMachine, "measured", layout));
}

}  // namespace
}  // namespace servomill::sim::calibration::identified_uncertainty_test
