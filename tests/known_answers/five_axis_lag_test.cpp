/// Residual of feedback compensation in five axes, against its closed form.
///
/// The axes move by -d(Q), with d from PoseCompensation, each tau_j late: 1/Kv and what the
/// hardware takes (lag_test.cpp). With the Jacobians of the ideal machine, tip and tool axis are
/// then off by
///
///     dp = J_pQ (tau o dd/dt),   dk = J_kQ (tau o dd/dt)                                     (1)
///
/// beside what the loops do to the program itself: that is what the same machine shows without
/// errors and without strategy (case "perfect").
#include <gtest/gtest.h>

#include "plant/kinematics/chain.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/comparison.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "strategies/pose_compensation.h"
#include "tests/sim/five_axis_program.h"

namespace servomill::sim::five_axis_lag_test {
namespace {

using Eigen::Vector3d;

constexpr double kFeed = 3000.0;           // mm/min
constexpr double kHardware = 8.0 * 10e-6;  // s, as in lag_test.cpp
constexpr double kClosedForm = 0.03;       // share of the lag, rms
constexpr double kIdealTip = 0.1;          // um, wanted
constexpr double kIdealAxis = 1.0;         // urad, wanted
constexpr double kLeft = 0.1;              // share of the lag that the lead may leave: wanted

const std::string kAll = "axes = \"all\"\n";

const model::Scenario& s_part() {
  static const model::Scenario kScenario = trunnion_scenario(
      s_shaped_program(kFeed),
      "[[case]]\nname = \"perfect\"\nmachine_errors = \"\"\n[[case]]\nname = \"uncompensated\"\n"
      "servo = \"ideal\"\n" +
          corrected_case("ideal", "ideal", "feedback", kAll) +
          corrected_case("feedback", "cascade", "feedback", kAll) +
          corrected_case("lead", "cascade", "feedback",
                         kAll + "extrapolation_time_ms = \"auto\"\n"));
  return kScenario;
}

TEST(FiveAxisFeedback, LeavesLessThanATenthOfAMicrometreOnIdealAxes) {
  const Deviation before = deviation_in(run_named_case(s_part(), "uncompensated"), "flank");
  EXPECT_GT(before.tip, 20.0);
  EXPECT_GT(before.axis, 20.0);
  const Deviation left = deviation_in(run_named_case(s_part(), "ideal"), "flank");
  EXPECT_LT(left.tip, kIdealTip);
  EXPECT_LT(left.axis, kIdealAxis);
}

// Rows of the flank from 0.2 s after its begin: entering it is a corner.
std::vector<std::size_t> flank(const run::CaseOutput& out) {
  const records::Series& series = out.result.servo;
  const std::size_t section = *series.column("section"), time = *series.column("time");
  std::vector<std::size_t> rows;
  double begin = -1.0;
  for (std::size_t n = 1; n + 1 < series.rows(); ++n) {
    if (out.sections[static_cast<std::size_t>(series.at(n, section))] != "flank") continue;
    if (begin < 0.0) begin = series.at(n, time);
    if (series.at(n, time) > begin + 0.2) rows.push_back(n);
  }
  return rows;
}

Joints reference(const records::Series& series, std::size_t row) {
  Joints Q;
  const std::size_t linear = *series.column("ref_linear", 'X');
  const std::size_t rotary = *series.column("ref_rotary", 'A');
  for (std::size_t j = 0; j < 3; ++j) Q[static_cast<int>(j)] = series.at(row, linear + j) * mm;
  for (std::size_t j = 0; j < 2; ++j) Q[static_cast<int>(3 + j)] = series.at(row, rotary + j) * deg;
  return Q;
}

Vector3d vector(const records::Series& series, const std::string& name, char first,
                std::size_t row) {
  const std::size_t column = *series.column(name, first);
  return {series.at(row, column), series.at(row, column + 1), series.at(row, column + 2)};
}

// e + tau_h dd/dt of equation (2) for every row; d is taken to change evenly from row to row.
std::vector<Joints> behind_by_closed_form(const records::Series& series,
                                          const strategies::PoseCompensation& compensation,
                                          const Joints& Kv) {
  const std::size_t time = *series.column("time");
  const auto d = [&](std::size_t row) {
    return compensation.of_feedback(strategies::Action::compensate, reference(series, row));
  };
  std::vector<Joints> out(series.rows(), Joints::Zero());
  Joints e = Joints::Zero(), before = d(0);
  for (std::size_t n = 1; n < series.rows(); ++n) {
    const double dt = series.at(n, time) - series.at(n - 1, time);
    const Joints now = d(n), rate = (now - before) / dt;
    for (int j = 0; j < kJoints; ++j) {
      const double kept = std::exp(-Kv[j] * dt);
      e[j] = kept * e[j] + (1.0 - kept) * rate[j] / Kv[j];
    }
    out[n] = e + kHardware * rate;
    before = now;
  }
  return out;
}

// Root mean squares of three-dimensional differences.
struct Rms {
  double tip = 0.0, axis = 0.0;  // um, urad
};

// Difference between two cases of one motion, less the predicted one.
template <class Predict>
Rms difference(const run::CaseOutput& one, const run::CaseOutput& other, Predict predict) {
  const records::Series &a = one.result.servo, &b = other.result.servo;
  const std::vector<std::size_t> rows = flank(one);
  EXPECT_EQ(rows, flank(other));
  Rms sum;
  for (const std::size_t n : rows) {
    const auto [dp, dk] = predict(a, n);
    const auto off = [&](const char* name, char first) {
      return Vector3d(vector(a, name, first, n) - vector(b, name, first, n));
    };
    sum.tip += (off("tool_position_true", 'X') * mm - dp).squaredNorm();
    sum.axis += (off("tool_axis_true", 'I') - dk).squaredNorm();
  }
  const auto count = static_cast<double>(rows.size());
  return {std::sqrt(sum.tip / count) / um, std::sqrt(sum.axis / count) / urad};
}

TEST(FiveAxisFeedback, LagsAsTheClosedFormSaysAndIsLed) {
  const model::Scenario& scenario = s_part();
  const run::CaseOutput perfect = run_named_case(scenario, "perfect"),
                        feedback = run_named_case(scenario, "feedback"),
                        lead = run_named_case(scenario, "lead");
  const model::MachineSettings& machine = scenario.machine;
  strategies::IdentifiedMachine identified{
      machine.chain.layout, plant::VolumetricModel(machine.chain, scenario.errors.at("machine"))};
  identified.p_ST = Vector3d(0.0, 0.0, -120.0 * mm);
  const strategies::PoseCompensation compensation(identified, strategies::Iterations::one,
                                                  1.0 * deg);
  Joints Kv;
  for (int j = 0; j < kJoints; ++j) {
    Kv[j] = machine.nc.cascade[static_cast<std::size_t>(j)].Kv;
  }
  const std::vector<Joints> behind = behind_by_closed_form(perfect.result.servo, compensation, Kv);
  const auto closed_form = [&](const records::Series& series, std::size_t n) {
    const auto J = plant::jacobian(machine.chain, reference(series, n), identified.p_ST);
    return std::pair<Vector3d, Vector3d>(J.J_pQ * behind[n], J.J_kQ * behind[n]);
  };
  const auto nothing = [](const records::Series&, std::size_t) {
    return std::pair<Vector3d, Vector3d>(Vector3d::Zero(), Vector3d::Zero());
  };
  const Rms lag = difference(feedback, perfect, nothing);
  const Rms unexplained = difference(feedback, perfect, closed_form);
  const Rms left = difference(lead, perfect, nothing);
  RecordProperty("lag", fmt::format("{:.4f} um, {:.4f} urad", lag.tip, lag.axis));
  RecordProperty("unexplained",
                 fmt::format("{:.4f} um, {:.4f} urad", unexplained.tip, unexplained.axis));
  RecordProperty("left", fmt::format("{:.4f} um, {:.4f} urad", left.tip, left.axis));
  EXPECT_GT(lag.tip, 0.2);
  EXPECT_LT(unexplained.tip, kClosedForm * lag.tip);
  EXPECT_LT(unexplained.axis, kClosedForm * lag.axis);
  EXPECT_LT(left.tip, kLeft * lag.tip);
  EXPECT_LT(left.axis, kLeft * lag.axis);
}

}  // namespace
}  // namespace servomill::sim::five_axis_lag_test
