#include "sim/run/machine_tests.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/comparison.h"
#include "sim/model/machine_test.h"
#include "sim/run/rotary_tests.h"
#include "sim/run/test_rows.h"
#include "sim/standards/circle_test.h"
#include "sim/standards/diagonal_report.h"
#include "sim/standards/positioning_readings.h"
#include "sim/standards/positioning_report.h"

namespace servomill::sim::run {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using metrology::Sense;
using model::TestStandard;
using standards::PositioningTest;
using standards::Source;

struct TrueReadings {
  std::vector<PositioningTest> lines;
  double creep = 0.0;  // m
};

// Deviation along a line at a standstill, mean of a part of it.
// @param travel  from the first target to that of the standstill
using Deviation =
    std::function<double(const Standstill& at, double travel, double from, double to)>;

double creep_at(const Deviation& deviation, const Standstill& at) {
  return std::abs(deviation(at, 0.0, 0.75, 1.0) - deviation(at, 0.0, 0.5, 0.75));
}

double creep_at(const TestRows& rows, const Standstill& at, const Vector3d& beam) {
  return std::abs(beam.dot(rows.mean(at, 0.75, 1.0) - rows.mean(at, 0.5, 0.75)));
}

// Deviation that the device measures between the first and the last target of a line.
Deviation deviation_of(const model::MachineTest& test, const evaluation::CaseData& one,
                       const TestRows& rows, const Standstill& first, const Standstill& last) {
  if (test.is_rotary()) {
    const auto device = std::make_shared<const RotaryDevice>(test, one, rows, first);
    return [device](const Standstill& at, double travel, double from, double to) {
      return device->deviation(at, travel, from, to);
    };
  }
  const Vector3d beam = (rows.nominal(last) - rows.nominal(first)).normalized();
  const Vector3d zero = rows.mean(first, 0.5, 1.0);
  return [&rows, beam, zero](const Standstill& at, double travel, double from, double to) {
    return beam.dot(rows.mean(at, from, to) - zero) - travel;
  };
}

// Deviations along the line from its first target on.
TrueReadings true_readings(const model::MachineTest& test, const evaluation::CaseData& one,
                           const TestRows& rows) {
  std::vector<model::TestStop> stops = model::stops(test);
  std::erase_if(stops, [](const model::TestStop& stop) { return !stop.is_measured(); });
  const std::vector<Standstill> at = rows.at_stops();
  const std::size_t of_line = stops.size() / test.lines.size();
  TrueReadings out;
  for (std::size_t first = 0; first < stops.size(); first += of_line) {
    const Standstill& last = at[first + test.cycle.targets.size() - 1];
    const Deviation deviation = deviation_of(test, one, rows, at[first], last);
    const double zero = deviation(at[first], 0.0, 0.5, 1.0);
    std::vector<standards::TargetReading> readings;
    for (std::size_t i = first; i < first + of_line; ++i) {
      const standards::CycleStop& stop = stops[i].on_line;
      const double travel = stop.position - stops[first].on_line.position;
      standards::TargetReading reading;
      reading.target = stop.position;
      reading.direction = stop.direction;
      reading.run = stop.run;
      reading.deviation = deviation(at[i], travel, 0.5, 1.0) - zero;
      reading.time = rows.end_of(at[i]);
      reading.place = test.place;
      readings.push_back(reading);
      out.creep = std::max(out.creep, creep_at(deviation, at[i]));
    }
    out.lines.push_back(standards::arrange(readings, test.is_rotary()));
  }
  return out;
}

// A ball bar on one turn: angles, and deviations of the radius.
struct Turn {
  std::vector<double> angles, deviations;  // rad, m
  std::size_t first = 0, last = 0;         // rows
};

struct BallBar {
  Vector3d centre_ref, centre;  // m; as interpolated, and where the TCP was
};

// Readings at equal angles of the arc, linear between rows; its begin and end are not measured.
Turn read_turn(const model::MachineTest& test, const TestRows& rows, const BallBar& bar,
               std::size_t begin, std::size_t end, Sense sense) {
  const double sign = sense == Sense::counter_clockwise ? 1.0 : -1.0;
  const int a = index_of(test.axes[0]), b = index_of(test.axes[1]);
  const double step = test.reading_spacing();
  Turn out;
  double turned = -model::kFeedIn, angle = -sign * model::kFeedIn, deviation = 0.0;
  for (std::size_t row = begin; row < end; ++row) {
    const Vector3d v = rows.ref(row).head<3>() - bar.centre_ref;
    const double turned_before = turned, deviation_before = deviation, angle_before = angle;
    angle = std::atan2(v[b], v[a]);
    turned += sign * std::remainder(angle - angle_before, 2.0 * std::numbers::pi);
    deviation = (rows.actual(row) - bar.centre).norm() - test.radius;
    if (row == begin) continue;
    for (; static_cast<int>(out.angles.size()) < test.readings; out.last = row) {
      const double next = static_cast<double>(out.angles.size()) * step;
      if (turned < next) break;
      if (out.angles.empty()) out.first = row;
      const double share = (next - turned_before) / (turned - turned_before);
      out.angles.push_back(sign * next);
      out.deviations.push_back(deviation_before + share * (deviation - deviation_before));
    }
  }
  return out;
}

// One direction without targets of its own, as the errors of a device are added to it.
PositioningTest as_readings(const Turn& turn) {
  PositioningTest out;
  const auto n = static_cast<Eigen::Index>(turn.angles.size());
  out.targets = Eigen::ArrayXd::Zero(n);
  out.up = Eigen::Map<const Eigen::ArrayXd>(turn.deviations.data(), n);
  out.time_up = Eigen::ArrayXd::LinSpaced(n, 0.0, 1.0);
  return out;
}

standards::CircleTest read_circles(const model::MachineTest& test, const TestRows& rows,
                                   TestResult& result) {
  const std::vector<Standstill> at = rows.at_stops();
  const BallBar bar{at[0].ref.head<3>(), rows.mean(at[0], 0.5, 1.0)};
  for (int i = 0; i < 3; ++i) {
    result.creep = std::max(result.creep, creep_at(rows, at[0], Vector3d::Unit(i)));
  }
  const std::vector<std::pair<Sense, Turn>> turns = {
      {Sense::counter_clockwise,
       read_turn(test, rows, bar, at[1].end, at[2].begin, Sense::counter_clockwise)},
      {Sense::clockwise, read_turn(test, rows, bar, at[2].end, at[3].begin, Sense::clockwise)}};
  for (const auto& [sense, turn] : turns) {
    result.feeds = rows.feeds(turn.first, turn.last, result.feeds);
  }
  const std::vector<PositioningTest> read =
      standards::read_by_device({as_readings(turns[0].second), as_readings(turns[1].second)},
                                test.device, test.seed, {Source::set_up});
  standards::CircleTest out{test.name, test.radius, {}};
  for (std::size_t k = 0; k < turns.size(); ++k) {
    standards::CirclePath path{turns[k].first, {}};
    for (std::size_t i = 0; i < turns[k].second.angles.size(); ++i) {
      const double angle = turns[k].second.angles[i];
      const double r = test.radius + read[k].up(static_cast<Eigen::Index>(i), 0);
      path.points.push_back(r * Vector2d(std::cos(angle), std::sin(angle)));
    }
    out.turns.push_back(std::move(path));
  }
  return out;
}

void evaluate_lines(const model::MachineTest& test, const evaluation::CaseData& one,
                    const TestRows& rows, TestResult& out) {
  TrueReadings readings = true_readings(test, one, rows);
  out.creep = readings.creep;
  out.is_angle = test.is_rotary();
  if (test.standard == TestStandard::positioning) {
    standards::PositioningFile file;
    file.name = out.report.name;
    file.test = standards::read_by_device(readings.lines.front(), test.device, test.seed);
    const standards::MonteCarloSettings trials{.seed = test.seed};
    out.report =
        standards::positioning_report(file, standards::UncertaintyInput{test.device, trials});
    out.lines = {{test.name, std::move(file.test)}};
    return;
  }
  auto read = standards::read_by_device(std::move(readings.lines), test.device, test.seed,
                                        {Source::calibration, Source::temperature});
  std::vector<standards::PositioningFile> files;
  for (std::size_t k = 0; k < read.size(); ++k) {
    files.push_back({read[k], test.lines[k].name, {}});
    out.lines.push_back({test.lines[k].name, std::move(read[k])});
  }
  const std::string name = out.report.name;
  out.report = standards::diagonal_report(files);
  out.report.name = name;
  out.report.headline = fmt::format("{} diagonals of {:.6g} mm, the largest parameters of all",
                                    out.lines.size(), out.lines.front().test.travel() / mm);
}

void evaluate_circles(const model::MachineTest& test, const TestRows& rows, TestResult& out) {
  standards::CircleTest circle = read_circles(test, rows, out);
  circle.name = out.report.name;
  out.circle = std::make_shared<const standards::CircleTest>(std::move(circle));
  out.report = standards::circle_report(*out.circle);
}

// The reached feed, where it is not the programmed one.
void add_feeds(const model::MachineTest& test, double programmed, TestResult& out) {
  constexpr double kReached = 0.99;
  if (out.feeds.max == 0.0 || out.feeds.min >= kReached * programmed) return;
  const double unit = test.is_rotary() ? deg_per_min : mm_per_min;
  const char* const name = test.is_rotary() ? "deg/min" : "mm/min";
  out.report.remarks.push_back(
      fmt::format("the programmed feed of {:.5g} {} is not reached: {:.5g} to {:.5g} {} while the "
                  "device is read",
                  programmed / unit, name, out.feeds.min / unit, out.feeds.max / unit, name));
}

}  // namespace

TestResult evaluate_test(const model::MachineTest& test, const evaluation::CaseData& one,
                         double feed_override) {
  const TestRows rows(test, one);
  TestResult out;
  out.name = test.name;
  out.report.name = fmt::format("{}, case {}", test.name, one.name);
  switch (test.standard) {
    case TestStandard::positioning:
    case TestStandard::diagonals:
      evaluate_lines(test, one, rows, out);
      break;
    case TestStandard::circles:
      evaluate_circles(test, rows, out);
      break;
    case TestStandard::error_motion:
      evaluate_error_motion(test, one, rows, out);
      break;
    case TestStandard::ball:
      evaluate_ball(test, one, rows, out);
      break;
  }
  add_feeds(test, test.feed * feed_override, out);
  return out;
}

std::optional<std::string> note_of_creep(const TestResult& result, double dwell) {
  constexpr double kStandstill = 0.02 * um;  // a difference that the sheet shows
  constexpr double kTurn = 0.1 * urad;       // the step of an autocollimator
  if (!(result.creep > (result.is_angle ? kTurn : kStandstill))) return std::nullopt;
  return fmt::format(
      "test {}: the axis still moved by up to {:.2g} {} during the reading, which counts as its "
      "error; increase dwell_s above {:g}",
      result.name, result.creep / um, result.is_angle ? "urad" : "um", dwell);
}

}  // namespace servomill::sim::run
