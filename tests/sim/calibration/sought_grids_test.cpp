/// Errors over two axes that a calibration finds.
#include "sim/calibration/sought_grids.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "plant/geometry/volumetric.h"
#include "plant/vocabulary/units.h"
#include "sim/calibration/error_effects.h"
#include "sim/calibration/identified_errors.h"
#include "sim/calibration/make_up.h"
#include "sim/calibration/report.h"
#include "sim/input/machine_description.h"
#include "sim/input/read_machine.h"
#include "sim/input/uncertain_errors.h"
#include "sim/model/tip_uncertainty.h"
#include "tests/sim/calibration/random_machine.h"
#include "tests/text.h"

namespace servomill::sim::calibration::sought_grids_test {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using Eigen::VectorXd;
using plant::operator""_err;

CalibrationSettings with_grid(const plant::ErrorName& name, Axis across) {
  CalibrationSettings out;
  FormSettings form;
  form.grids.push_back({.across = across, .knots = {}});
  out.forms.emplace_back(name, form);
  out.form_linear.number_of_knots = 11;
  return out;
}

// A machine with errors drawn at random, also in its grids.
Truth truth_with_grids(const Unknowns& unknowns, Normal& normal) {
  Truth out = random_truth(unknowns, normal);
  for (const SoughtGrid& grid : unknowns.grids) {
    for (int i = 0; i < grid.basis.size(); ++i) out.values[grid.first + i] = normal(5e-6);
    out.errors.component(grid.name).grids.emplace_back(
        grid.basis.points(out.values.segment(grid.first, grid.basis.size())));
  }
  return out;
}

// Positions of X on three lines, whose heights differ.
TEST(SoughtGrids, AreFoundByAnExactInstrument) {
  Normal normal(3);
  const readings::Readings empty = shop_readings();
  const CalibrationSettings settings = with_grid("EZX"_err, Axis::Z);
  const Truth truth = truth_with_grids(calibrated(empty, settings).adjustment.unknowns, normal);
  readings::Readings all = empty;
  for (readings::Group& group : all.groups) group.uncertainty = 1e-12;
  all.instruments[0].scale_uncertainty = 1e-12;
  make_up(all, gantry(), truth.errors, 7);
  const Calibration found = calibrated(all, settings);
  EXPECT_TRUE(found.adjustment.left_out.empty()) << unidentifiable_sentences(found).front();
  ASSERT_EQ(found.adjustment.unknowns.grids.size(), 1U);
  EXPECT_EQ(found.adjustment.unknowns.grids[0].basis.size(), 10 * 2);
  for (const double z : {0.2, 0.6, 0.9}) {
    for (const double x : {0.0, 0.33, 1.0}) {
      const Joints Q = (Joints() << x, 0.8, z, 0.0, 0.0).finished();
      const Vector3d p_ST(0.02, -0.03, -0.2);
      const auto tip = [&](const plant::ErrorModel& errors) {
        return plant::VolumetricModel(gantry(), errors).error(Q, p_ST).dp_W;
      };
      EXPECT_NEAR((tip(truth.errors) - tip(found.adjustment.errors)).norm(), 0.0, 1e-10);
    }
  }
  // functions of X alone leave what depends on Z
  CalibrationSettings alone = settings;
  alone.forms.clear();
  const Calibration without = calibrated(all, alone);
  EXPECT_GT(without.adjustment.squares, 1e6 * found.adjustment.squares);
}

// Whitened squares of what is found less what is true: as many as unknowns, over 8 machines.
TEST(SoughtGrids, HaveTheUncertaintyThatIsStated) {
  const readings::Readings empty = shop_readings();
  const CalibrationSettings settings = with_grid("EXX"_err, Axis::Y);
  const Unknowns unknowns = calibrated(empty, settings).adjustment.unknowns;
  double squares = 0.0, count = 0.0;
  for (int machine = 0; machine < 8; ++machine) {
    Normal normal(static_cast<std::uint64_t>(100 + machine));
    const Truth truth = truth_with_grids(unknowns, normal);
    readings::Readings all = empty;
    make_up(all, gantry(), truth.errors, static_cast<std::uint64_t>(machine));
    const Adjustment found = calibrated(all, settings).adjustment;
    ASSERT_TRUE(found.left_out.empty());
    const SoughtGrid& grid = found.unknowns.grids.at(0);
    const auto n = Eigen::Index(grid.basis.size());
    const VectorXd off = found.values.segment(grid.first, n) - truth.values.segment(grid.first, n);
    squares += off.dot(found.covariance.block(grid.first, grid.first, n, n).ldlt().solve(off));
    count += double(n);
  }
  EXPECT_NEAR(squares / count, 1.0, 4.0 * std::sqrt(2.0 / count));
}

// EXX over X and Z, linear in Z, is what a pitch of X does to a point that is lower: angles alone
// tell them apart.
TEST(SoughtGrids, NameWhatIsDeterminedOnlyInCombination) {
  CalibrationSettings settings = with_grid("EXX"_err, Axis::Z);
  settings.errors = {"EXX"_err, "EBX"_err};
  readings::Readings all = shop_readings();
  const auto grid_of = [&](const Calibration& found) {
    return known_grids(found.adjustment).at(0);
  };
  EXPECT_FALSE(grid_of(calibrated(all, settings)).is_combined);
  std::erase_if(all.groups, [](const auto& one) {
    return one.kind != readings::Kind::positioning || one.axis != Axis::X;
  });
  const Calibration found = calibrated(all, settings);
  EXPECT_TRUE(grid_of(found).is_combined);
  const std::string all_sentences = joined(unidentifiable_sentences(found));
  EXPECT_NE(all_sentences.find("a part of EXX over X and Z is determined only in combination"),
            std::string::npos)
      << all_sentences;
  EXPECT_NE(report(found).find("EXX over X and Z"), std::string::npos);
}

const std::string kRouter = SERVOMILL_SOURCE_DIR "/scenarios/calibration/router/readings.toml";
const std::string kMachine = SERVOMILL_SOURCE_DIR "/scenarios/machines/router_3axis.toml";

// The file has a grid from end to end of the travel, and its covariance is that of the adjustment.
TEST(SoughtGrids, ComeBackFromTheFileWithTheirUncertainty) {
  const input::MachineDescription machine = input::read_machine_description(kMachine);
  const plant::MachineChain& chain = machine.machine->chain;
  CalibrationSettings settings = read_settings(kRouter, chain.layout);
  FormSettings form;
  form.grids.push_back({.across = Axis::Y, .knots = {5, 3}});
  settings.forms.emplace_back("EXX"_err, form);
  const Calibration found =
      calibrate(readings::read_readings(kRouter, chain, machine.machine->nc.lower,
                                        machine.machine->nc.upper, readings::Numbers::required),
                chain, settings);
  const std::string file = (fs::path(testing::TempDir()) / "servomill_grid.toml").string();
  write_identified_errors(file, found, kMachine, "identified", true);
  const input::MachineDescription read = input::read_machine_description(file);
  const auto& grids = read.errors.at("identified").component("EXX"_err).grids;
  ASSERT_EQ(grids.size(), 1U);
  EXPECT_EQ(grids[0].points().at[0].front(), machine.machine->nc.lower[0]);
  EXPECT_EQ(grids[0].points().at[0].back(), machine.machine->nc.upper[0]);
  const auto errors = input::uncertain_errors_of_file(file, "identified", chain.layout);
  fs::remove(file);
  ASSERT_TRUE(errors);
  const model::TipUncertainty tip(chain, *errors);
  const ErrorEffects effects(chain, found.adjustment.unknowns);
  const Vector3d p_ST(0.0, 0.0, -60 * mm);
  for (const double x : {50.0, 333.0, 900.0}) {
    Joints Q = Joints::Zero();
    Q.head<3>() = Vector3d(x, 0.6 * x, -0.1 * x) * mm;
    const Eigen::Matrix3d wanted = tip_covariance(effects, found.adjustment, Q, p_ST);
    const Eigen::Matrix3d in_file = tip.covariance(Q, p_ST, Joints::Zero());
    EXPECT_LE((in_file - wanted).norm(), 1e-6 * wanted.norm()) << x;
    const auto shift = [&](const plant::ErrorModel& model) {
      return plant::VolumetricModel(chain, model).error(Q, p_ST).dp_W;
    };
    EXPECT_LE((shift(read.errors.at("identified")) - shift(found.adjustment.errors)).norm(), 1e-12);
  }
}

TEST(SoughtGrids, RefuseAxesThatTurnOnAndAxesThatStood) {
  readings::Readings all = shop_readings();
  for (readings::Group& group : all.groups) {
    for (readings::Reading& row : group.rows) row.Q[2] = 0.5;
    group.at[2] = 0.5;
  }
  all.path = "shop.toml";
  std::erase_if(all.groups, [](const auto& group) {
    return group.axis == Axis::Z || group.kind == readings::Kind::squareness;
  });
  EXPECT_EQ(fault_messages([&] { calibrated(all, with_grid("EZX"_err, Axis::Z)); }),
            "adjustment.form.EZX.grid: the lines of X are all at one position of Z; two are "
            "needed\n");
  readings::Readings turning = shop_readings();
  add_spheres(turning, trunnion());
  turning.lower.head<4>().setConstant(-2.0);
  turning.upper.head<4>().setConstant(2.0);
  EXPECT_EQ(
      fault_messages([&] { calibrate(turning, trunnion(), with_grid("EXA"_err, Axis::C)); }),
      "adjustment.form.EXA.grid: C has no travel limits; grids require axes with travel limits\n");
}

}  // namespace
}  // namespace servomill::sim::calibration::sought_grids_test
