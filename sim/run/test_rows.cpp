#include "sim/run/test_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/comparison.h"

namespace servomill::sim::run {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
constexpr std::array kLetters = {'X', 'Y', 'Z'};

std::size_t column(const char* name, char label, const evaluation::CaseData& one) {
  const auto found = one.servo->column(name, label);
  if (!found) throw InputError({one.name}, fmt::format("test needs the signal {}", name));
  return *found;
}

std::array<std::size_t, 3> columns(const char* name, const evaluation::CaseData& one) {
  return {column(name, 'X', one), column(name, 'Y', one), column(name, 'Z', one)};
}

// By which a rewritten program may be off: less than would confuse two stops.
double tolerance_of(const model::MachineTest& test) {
  constexpr double kPart = 0.4, kMax = 0.25 * mm;
  if (test.standard == model::TestStandard::circles) return std::min(kPart * test.radius, kMax);
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
  for (std::size_t i = 0; i < kLetters.size(); ++i) {
    ref_[i] = one.servo->column("ref_linear", kLetters[i]).value_or(kNone);
  }
  const auto found = std::find(one.sections.begin(), one.sections.end(), test.name);
  const std::size_t section = column("section", '\0', one);
  const auto number = static_cast<double>(found - one.sections.begin());
  for (std::size_t row = 0; row < series_.rows(); ++row) {
    if (series_.at(row, section) == number) add(row);
  }
}

double TestRows::time(std::size_t row) const { return series_.at(row, time_); }

Vector3d TestRows::ref(std::size_t row) const {
  Vector3d out = Vector3d::Zero();
  for (std::size_t i = 0; i < ref_.size(); ++i) {
    if (ref_[i] != kNone) out[static_cast<Eigen::Index>(i)] = series_.at(row, ref_[i]) * mm;
  }
  return out;
}

Vector3d TestRows::position(std::size_t row, const Columns& of) const {
  return Vector3d(series_.at(row, of[0]), series_.at(row, of[1]), series_.at(row, of[2])) * mm;
}

void TestRows::add(std::size_t row) {
  constexpr double kSame = 1e-9;  // m
  const Vector3d at = ref(row);
  if (!all_.empty() && all_.back().end == row && (at - all_.back().ref).norm() < kSame) {
    ++all_.back().end;
  } else {
    all_.push_back({at, row, row + 1});
  }
}

Vector3d TestRows::mean(const Standstill& one, double from, double to) const {
  const double begin = time(one.begin), duration = end_of(one) - begin;
  Vector3d sum = Vector3d::Zero();
  std::size_t count = 0;
  for (std::size_t row = one.begin; row < one.end; ++row) {
    const double part = (time(row) - begin) / duration;
    if (part < from || part > to) continue;
    sum += actual(row);
    ++count;
  }
  return sum / static_cast<double>(count);
}

// Standstills at the stops in their order, the first of them given; as many as are found. Their
// distances from the first stop identify them, which work offsets do not change.
std::vector<Standstill> TestRows::found_from(std::size_t first, const std::vector<Standstill>& all,
                                             const std::vector<Vector3d>& stops) const {
  const double tolerance = tolerance_of(test_);
  std::vector<Standstill> out;
  auto next = all.begin() + static_cast<std::ptrdiff_t>(first);
  const Vector3d zero = next->ref;
  for (const Vector3d& stop : stops) {
    const Vector3d at = zero + stop - stops.front();
    next = std::find_if(next, all.end(),
                        [&](const Standstill& one) { return (one.ref - at).norm() < tolerance; });
    if (next == all.end()) break;
    out.push_back(*next++);
  }
  return out;
}

// The last that fit: before them the axes may have been at rest elsewhere, for a tool change.
std::vector<Standstill> TestRows::at_stops() const {
  std::vector<Vector3d> stops;
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
