#include "sim/run/test_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/comparison.h"

namespace servomill::sim::run {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

std::size_t column(const char* name, char label, const evaluation::CaseData& one) {
  const auto found = one.servo->column(name, label);
  if (!found) throw InputError({one.name}, fmt::format("test needs the signal {}", name));
  return *found;
}

std::array<std::size_t, 3> columns(const char* name, const evaluation::CaseData& one,
                                   const char* labels = "XYZ") {
  return {column(name, labels[0], one), column(name, labels[1], one), column(name, labels[2], one)};
}

// By which a rewritten program may be off: less than would confuse two stops.
double tolerance_of(const model::MachineTest& test) {
  constexpr double kPart = 0.4, kMax = 0.25 * mm;  // and 0.25 mrad
  if (test.standard == model::TestStandard::circles) return std::min(kPart * test.radius, kMax);
  if (!test.has_lines()) return std::min(kPart * test.cycle.overrun, kMax);
  const std::vector<double>& targets = test.cycle.targets;
  double least = test.cycle.overrun;
  for (std::size_t i = 1; i < targets.size(); ++i) {
    least = std::min(least, targets[i] - targets[i - 1]);
  }
  return std::min(kPart * least, kMax);
}

}  // namespace

TestRows::TestRows(const model::MachineTest& test, const evaluation::CaseData& one)
    : test_(test),
      case_(one),
      series_(*one.servo),
      time_(column("time", '\0', one)),
      nominal_(columns("tool_position_nominal", one)),
      actual_(columns("tool_position_true", one)) {
  for (const Axis axis : kAllAxes) {
    const bool is_followed = is_linear(axis) || test.is_rotary();
    ref_[static_cast<std::size_t>(index_of(axis))] =
        is_followed ? one.servo->column(is_linear(axis) ? "ref_linear" : "ref_rotary", letter(axis))
                          .value_or(kNone)
                    : kNone;
  }
  if (test.needs_orientation()) {
    axis_ = columns("tool_axis_true", one, "IJK");
    side_ = columns("tool_side_true", one, "IJK");
  }
  const auto found = std::find(one.sections.begin(), one.sections.end(), test.name);
  const std::size_t section = column("section", '\0', one);
  const auto number = static_cast<double>(found - one.sections.begin());
  for (std::size_t row = 0; row < series_.rows(); ++row) {
    if (series_.at(row, section) == number) add(row);
  }
}

double TestRows::time(std::size_t row) const { return series_.at(row, time_); }

AxisWords TestRows::ref(std::size_t row) const {
  AxisWords out = AxisWords::Zero();
  for (const Axis axis : kAllAxes) {
    const std::size_t of = ref_[static_cast<std::size_t>(index_of(axis))];
    if (of != kNone) out[index_of(axis)] = series_.at(row, of) * (is_linear(axis) ? mm : deg);
  }
  return out;
}

Eigen::Matrix3d TestRows::spindle(std::size_t row) const {
  const auto direction = [&](const Columns& of) {
    return Vector3d(series_.at(row, of[0]), series_.at(row, of[1]), series_.at(row, of[2]));
  };
  Eigen::Matrix3d out;
  out.col(2) = direction(axis_).normalized();
  out.col(1) = out.col(2).cross(direction(side_)).normalized();
  out.col(0) = out.col(1).cross(out.col(2));
  return out;
}

Vector3d TestRows::position(std::size_t row, const Columns& of) const {
  return Vector3d(series_.at(row, of[0]), series_.at(row, of[1]), series_.at(row, of[2])) * mm;
}

FeedRange TestRows::feeds(std::size_t first, std::size_t last, FeedRange others) const {
  constexpr std::size_t kStride = 16;  // rows: above the steps of the interpolator
  for (std::size_t row = first; row + kStride <= last; row += kStride) {
    const AxisWords step = ref(row + kStride) - ref(row);
    double square = 0.0;
    for (const Axis axis : test_.axes) square += step[index_of(axis)] * step[index_of(axis)];
    const double feed = std::sqrt(square) / (time(row + kStride) - time(row));
    others.min = others.max == 0.0 ? feed : std::min(others.min, feed);
    others.max = std::max(others.max, feed);
  }
  return others;
}

void TestRows::add(std::size_t row) {
  constexpr double kSame = 1e-9;  // m, rad
  const AxisWords at = ref(row);
  if (!all_.empty() && all_.back().end == row && (at - all_.back().ref).norm() < kSame) {
    ++all_.back().end;
  } else {
    all_.push_back({at, row, row + 1});
  }
}

// Standstills at the stops in their order, the first of them given; as many as are found. Their
// distances from the first stop identify them, which work offsets do not change.
std::vector<Standstill> TestRows::found_from(std::size_t first, const std::vector<Standstill>& all,
                                             const std::vector<AxisWords>& stops) const {
  const double tolerance = tolerance_of(test_);
  std::vector<Standstill> out;
  auto next = all.begin() + static_cast<std::ptrdiff_t>(first);
  const AxisWords zero = next->ref;
  AxisWords counts =
      AxisWords::Ones();  // about a ball, linear axes stop where TCP control has them
  if (test_.standard == model::TestStandard::ball) counts.head<kLinearJoints>().setZero();
  for (const AxisWords& stop : stops) {
    const AxisWords at = zero + stop - stops.front();
    next = std::find_if(next, all.end(), [&](const Standstill& one) {
      return (one.ref - at).cwiseProduct(counts).norm() < tolerance;
    });
    if (next == all.end()) break;
    out.push_back(*next++);
  }
  return out;
}

// The last that fit: before them the axes may have been at rest elsewhere, for a tool change.
std::vector<Standstill> TestRows::at_stops() const {
  std::vector<AxisWords> stops;
  for (const model::TestStop& stop : model::stops(test_)) {
    if (stop.is_measured()) stops.push_back(stop.position);
  }
  std::vector<Standstill> all;
  for (const Standstill& one : all_) {
    if (end_of(one) - time(one.begin) > 0.5 * test_.dwell) all.push_back(one);
  }
  std::size_t most = 0;
  for (std::size_t first = all.size(); first-- > 0;) {
    std::vector<Standstill> found = found_from(first, all, stops);
    if (found.size() == stops.size()) return found;
    most = std::max(most, found.size());
  }
  throw InputError(test_.place,
                   fmt::format("case {}: test {}: {} of {} standstills at targets are in the "
                               "recording; each must last dwell_s and be at its target",
                               case_.name, test_.name, most, stops.size()));
}

}  // namespace servomill::sim::run
