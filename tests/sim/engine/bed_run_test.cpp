/// Runs of a machine whose bed the drives push back.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <atomic>
#include <complex>
#include <numbers>

#include "sim/engine/simulate.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/prepare_cases.h"
#include "tests/sim/engine/circles.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::engine::bed_run_test {
namespace {

const std::string kRecord = "[record]\nperiod_ms = 0.2\n";

std::string bed(const std::string& prefix, double mass = 3000.0, double f = 18.0) {
  std::string out;
  for (const char axis : {'X', 'Y'}) {
    out += fmt::format(
        "[{}machine_override.axis.{}.machine_bed]\nmass = {}\nfrequency_Hz = {}\ndamping = "
        "0.04\n",
        prefix, axis, mass, f);
  }
  return out;
}

constexpr const char* kMoves = "G21 G90 G94\nG1 X12 F6000\nG1 X3 Y8\nG1 X0 Y0\nM30\n";

records::Series servo_of(const std::string& program, const std::string& text,
                         const std::string& name = "one") {
  return run_named_case(small_scenario(program, text), name).result.servo;
}

// Largest difference of two recordings in one signal (in its unit), and the largest of the first.
struct Difference {
  double most = 0.0, largest = 0.0;
};
Difference difference(const records::Series& a, const records::Series& b,
                      const std::string& signal) {
  EXPECT_EQ(a.rows(), b.rows());
  const std::size_t from = *a.column(signal, 'X'), to = *b.column(signal, 'X');
  Difference out;
  for (std::size_t n = 0; n < std::min(a.rows(), b.rows()); ++n) {
    for (std::size_t c = 0; c < 3; ++c) {
      out.most = std::max(out.most, std::abs(a.at(n, from + c) - b.at(n, to + c)));
      out.largest = std::max(out.largest, std::abs(a.at(n, from + c)));
    }
  }
  return out;
}

// On a circle of the angular speed W:  b = share W^2 / (w^2 - W^2 + 2 i zeta w W) x.
TEST(BedRun, moves_on_a_circle_as_the_closed_form) {
  constexpr double R = 2.0, v = 40.0;  // mm, mm/s
  const model::Scenario scenario =
      small_scenario(circles(R, 60.0 * v, 10), bed("") + "[[case]]\nname = \"one\"\n" + kRecord);
  const records::Series servo = run_named_case(scenario, "one").result.servo;
  const std::size_t x = *servo.column("true_linear", 'X'),
                    b = *servo.column("bed_displacement", 'X'), section = *servo.column("section");
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  for (std::size_t n = 0; n < servo.rows(); ++n) {
    if (servo.at(n, section) != 1.0) continue;
    const Eigen::Vector3d a(servo.at(n, x), servo.at(n, x + 1), 1.0);
    normal += a * a.transpose();
    right += a * Eigen::RowVector2d(servo.at(n, b), servo.at(n, b + 1));
  }
  const Eigen::Matrix2d map = (normal.inverse() * right).topRows<2>().transpose();  // um/mm
  const double W = v / R;
  for (int i = 0; i < 2; ++i) {
    const plant::FeedDriveParams& p = scenario.machine.drives[static_cast<std::size_t>(i)];
    const std::complex<double> closed =
        1e3 * p.bed_share() * W * W /
        std::complex<double>(p.bed.w * p.bed.w - W * W, 2.0 * p.bed.zeta * p.bed.w * W);
    EXPECT_NEAR(map(i, i), closed.real(), 3e-3 * std::abs(closed));
    // clockwise: y is a quarter of a turn ahead of x
    EXPECT_NEAR(map(i, 1 - i), (i == 0 ? 1.0 : -1.0) * closed.imag(), 3e-3 * std::abs(closed));
  }
}

// The scale reads the slide against the bed, which so couples into the loop.
TEST(BedRun, disturbs_the_position_loops) {
  const std::string both =
      "[[case]]\nname = \"fixed\"\n[[case]]\nname = \"one\"\n" + bed("case.") + kRecord;
  const records::Series with = servo_of(kMoves, both), without = servo_of(kMoves, both, "fixed");
  EXPECT_FALSE(without.column("bed_displacement", 'X').has_value());
  EXPECT_GT(difference(with, without, "following_error_linear").most, 0.05);  // um
  EXPECT_GT(difference(with, with, "bed_displacement").largest, 1.0);
}

TEST(BedRun, of_both_integrators_agrees) {
  for (const char* friction :
       {"", "friction_model = \"set_valued\"\n", "friction_model = \"lugre\"\n"}) {
    const auto text = [&](const char* integrator) {
      return fmt::format("[machine_override]\nintegrator = \"{}\"\n{}", integrator, friction) +
             bed("") + "[[case]]\nname = \"one\"\n" + kRecord + "resolution_nm = 0.0\n";
    };
    const records::Series exact = servo_of(kMoves, text("exact"));
    const records::Series cvode = servo_of(kMoves, text("cvode"));
    EXPECT_LE(difference(exact, cvode, "true_linear").most, 3e-6) << friction;       // mm
    EXPECT_LE(difference(exact, cvode, "bed_displacement").most, 3e-3) << friction;  // um
  }
}

// Neither neighbours in the lanes nor a bed among them change a run by a bit.
TEST(BedRun, is_the_same_alone_and_beside_others) {
  const model::Scenario scenario =
      small_scenario(kMoves, "[[case]]\nname = \"fixed\"\n[[case]]\nname = \"one\"\n" +
                                 bed("case.") + "[[case]]\nname = \"three\"\n" + kRecord);
  const std::vector<preparation::PreparedCase> prepared = preparation::prepare_cases(scenario);
  std::vector<CaseInputs> inputs;
  inputs.reserve(prepared.size());
  std::vector<CaseInputs*> together;
  for (const preparation::PreparedCase& one : prepared) {
    inputs.push_back(one.inputs());
    together.push_back(&inputs.back());
    ASSERT_TRUE(share_lanes(inputs.front(), inputs.back()));
  }
  const StopFlag never = false;
  std::atomic<float> progress = 0.0F;
  const std::vector<CaseResult> results = simulate(together, never, progress);
  for (std::size_t n = 0; n < prepared.size(); ++n) {
    const run::CaseOutput alone = run_named_case(scenario, prepared[n].spec().name);
    EXPECT_EQ(results[n].servo.by_rows(), alone.result.servo.by_rows()) << prepared[n].spec().name;
  }
  EXPECT_EQ(results[0].servo.by_rows(), results[2].servo.by_rows());
  EXPECT_NE(results[0].servo.by_rows(), results[1].servo.by_rows());
}

TEST(BedRun, that_is_heavy_and_stiff_is_that_of_a_fixed_bed) {
  const std::string cases = "[[case]]\nname = \"fixed\"\n[[case]]\nname = \"one\"\n" +
                            bed("case.", 5e5, 4000.0) + kRecord;
  EXPECT_LE(
      difference(servo_of(kMoves, cases), servo_of(kMoves, cases, "fixed"), "true_linear").most,
      1e-6);  // mm
}

}  // namespace
}  // namespace servomill::sim::engine::bed_run_test
