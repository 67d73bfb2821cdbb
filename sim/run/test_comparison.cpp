#include "sim/run/test_comparison.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "sim/evaluation/comparison.h"
#include "sim/model/machine_test.h"
#include "sim/model/scenario.h"
#include "sim/run/machine_tests.h"
#include "sim/run/run_case.h"
#include "sim/run/test_sheet.h"
#include "sim/standards/ball_test.h"
#include "sim/standards/circle_test.h"
#include "sim/standards/diagonal_report.h"
#include "sim/standards/error_motion.h"
#include "sim/standards/positioning_report.h"

namespace servomill::sim::run {
namespace {

using model::MachineTest;
using model::TestStandard;
using standards::Report;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr int kAngles = 72;  // of circles without errors

standards::PositioningFile without_errors(const MachineTest& test, const std::string& name) {
  standards::PositioningFile out;
  out.name = name;
  const auto n = static_cast<Eigen::Index>(test.cycle.targets.size());
  out.test.angular = test.is_rotary();
  out.test.targets = Eigen::Map<const Eigen::ArrayXd>(test.cycle.targets.data(), n);
  out.test.up = out.test.down = Eigen::ArrayXXd::Zero(n, test.cycle.runs);
  out.test.time_up = out.test.time_down = out.test.up;
  return out;
}

Report report_of_circles(const MachineTest& test) {
  standards::CircleTest circle{test.name, test.radius, {}};
  for (const auto sense : {metrology::Sense::counter_clockwise, metrology::Sense::clockwise}) {
    standards::CirclePath& turn = circle.turns.emplace_back();
    turn.sense = sense;
    for (int i = 0; i < kAngles; ++i) {
      const double angle =
          (sense == metrology::Sense::clockwise ? -1.0 : 1.0) * kTurn * i / kAngles;
      turn.points.emplace_back(test.radius * std::cos(angle), test.radius * std::sin(angle));
    }
  }
  return standards::circle_report(circle);
}

Report report_of_error_motion(const MachineTest& test) {
  const Eigen::ArrayXXd zero = Eigen::ArrayXXd::Zero(kAngles, test.revolutions);
  standards::RotationSensors sensors = {{"x", zero}, {"y", zero}, {"z", zero}};
  if (test.distance > 0.0) {
    sensors["x2"] = zero;
    sensors["y2"] = zero;
  }
  const Eigen::ArrayXd theta =
      Eigen::ArrayXd::LinSpaced(kAngles, 0.0, kTurn * (kAngles - 1) / kAngles);
  return standards::rotation_report(
      standards::rotation_of(test.name, theta, sensors, test.distance));
}

Report report_of_ball(const MachineTest& test) {
  standards::BallTest ball{test.name, {"radial", "tangential", "axial"}, {}};
  for (const int direction : {1, -1}) ball.paths.push_back({direction, {{0.0}, {0.0}, {0.0}}});
  return standards::ball_report(ball);
}

// Report of a machine without errors, which has all parameters of the test.
Report report_without_errors(const MachineTest& test) {
  switch (test.standard) {
    case TestStandard::positioning:
      return standards::positioning_report(without_errors(test, test.name), std::nullopt);
    case TestStandard::diagonals: {
      std::vector<standards::PositioningFile> files;
      for (const model::TestLine& line : test.lines) {
        files.push_back(without_errors(test, line.name));
      }
      return standards::diagonal_report(files);
    }
    case TestStandard::circles:
      return report_of_circles(test);
    case TestStandard::error_motion:
      return report_of_error_motion(test);
    case TestStandard::ball:
      break;
  }
  return report_of_ball(test);
}

}  // namespace

std::vector<evaluation::ComparisonRow> rows_of_tests(const model::Scenario& scenario,
                                                     std::span<const CaseOutput> outputs) {
  std::vector<Report> wanted;
  for (const auto& test : scenario.tests) wanted.push_back(report_without_errors(*test));
  std::vector<evaluation::ComparisonRow> out;
  for (std::size_t c = 0; c < scenario.cases.size(); ++c) {
    const bool has_values = c < outputs.size() && !outputs[c].tests.empty();
    for (std::size_t t = 0; t < wanted.size(); ++t) {
      const Report& report = has_values ? outputs[c].tests[t]->report : wanted[t];
      for (const standards::ReportValue& value : report.values) {
        const ReportUnit unit = unit_of(value.dimension);
        evaluation::ComparisonRow& row = out.emplace_back();
        row.case_name = scenario.cases[c].name;
        row.quantity = value.symbol;
        row.unit = unit.name;
        row.sections = scenario.tests[t]->name;
        row.value =
            has_values ? value.value / unit.factor : std::numeric_limits<double>::quiet_NaN();
      }
    }
  }
  return out;
}

}  // namespace servomill::sim::run
