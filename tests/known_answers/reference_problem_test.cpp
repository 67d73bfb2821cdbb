/// The positions of the reference problem against those of an independent integration, for 10 s of
/// five axes.
#include "tests/known_answers/reference_problem.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace servomill::reference_problem::reference_problem_test {
namespace {

// nm. The reference itself is good to 2e-5; servomill turns by exact rotations where the reference
// takes small angles, which moves the virtual encoder by 4e-4.
constexpr double kLinearTol = 1e-3;
constexpr double kFrictionTol = 0.05;  // nm, asked for; the exact step adds 2e-4

// Largest |x - x_ref| (nm) over all axes and rows.
double largest_error(const sim::model::MachineSettings& machine, const std::string& reference) {
  const auto x_ref = read_reference(reference);
  Problem run({&machine});
  double largest = 0.0;
  std::size_t row = 0;
  run.until(kEnd,
            [&](std::size_t, const sim::engine::AxisSetpoint&, const sim::engine::ServoAxes& axes) {
              largest = std::max(largest, (axes.Q_true() - x_ref.at(row++)).cwiseAbs().maxCoeff());
            });
  return 1e9 * largest;
}

void expect_reference(const sim::model::MachineSettings& machine, const std::string& reference,
                      double tolerance) {
  const double error = largest_error(machine, reference);
  testing::Test::RecordProperty("error_nm", fmt::format("{:.3g}", error));
  EXPECT_LE(error, tolerance) << "nm";
}

TEST(ReferenceProblem, LinearDrives) {
  expect_reference(read_machine("axes.csv", false), "x_ref_L.f64", kLinearTol);
}

TEST(ReferenceProblem, RegularisedFrictionAndLimits) {
  expect_reference(read_machine("axes.csv", true), "x_ref_N.f64", kFrictionTol);
}

TEST(ReferenceProblem, FrictionTenTimesSharper) {
  expect_reference(read_machine("axes_sharp.csv", true), "x_ref_N_sharp.f64", kFrictionTol);
}

// Eight machines with gains and friction of their own, in lockstep.
TEST(ReferenceProblem, GivesTheSameBitsAloneAndAmongOthers) {
  constexpr Tick kShort = 40'000;
  std::vector<sim::model::MachineSettings> machines(8, read_machine("axes.csv", true));
  for (std::size_t m = 0; m < machines.size(); ++m) {
    const double share = 1.0 + 0.03 * static_cast<double>(m);
    for (std::size_t j = 0; j < kJoints; ++j) {
      machines[m].nc.cascade[j].Kv *= share;
      machines[m].drives[j].friction.Fc_positive *= share;
      machines[m].drives[j].friction.Fc_negative /= share;
    }
  }
  std::vector<const sim::model::MachineSettings*> all;
  for (const auto& machine : machines) all.push_back(&machine);
  std::vector<std::vector<Joints>> together(machines.size());
  Problem(all).until(kShort, [&](std::size_t run, const auto&, const auto& axes) {
    together[run].push_back(axes.Q_true(run));
  });
  for (std::size_t m = 0; m < machines.size(); ++m) {
    std::vector<Joints> alone;
    Problem({all[m]}).until(kShort, [&](std::size_t, const auto&, const auto& axes) {
      alone.push_back(axes.Q_true());
    });
    EXPECT_TRUE(alone == together[m]) << "run " << m;
  }
}

}  // namespace
}  // namespace servomill::reference_problem::reference_problem_test
