#include "sim/tables/table_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim::tables {
namespace {

constexpr int kPositions = 1000;

}  // namespace

Axis axis_at(const TableExport& e, int joint) {
  return *e.source.chain.layout.axis[static_cast<std::size_t>(joint)];
}

std::vector<controllers::TableText> texts_of(const std::vector<TextFile>& files) {
  std::vector<controllers::TableText> out;
  for (const TextFile& file : files) out.push_back({file.name, file.text});
  return out;
}

std::string exact_size(bool is_angle, double value) {
  return is_angle ? fmt::format("{:.4f} urad", value / urad) : fmt::format("{:.4f} um", value / um);
}

void TableComparison::check(const TableLine& line, const Comparison& c) {
  for (const int direction : {1, -1}) {
    const auto chord = chords(line, c, direction);
    for (int n = 0; n < kPositions; ++n) {
      throw_if_interrupted();
      const double q = line.from + (line.to - line.from) * n / (kPositions - 1);
      const double read = c.read(q, direction);
      const double wanted = chord(line.entry_of(q));
      if (!(std::abs(read - wanted) <= c.digit * (1.0 + kDigitSlack))) {
        fail(line, c, q, direction, read, wanted);
      }
      count(c.is_angle, read - c.needed(q, direction));
    }
  }
}

void TableComparison::count(bool is_angle, double difference) {
  double& largest = is_angle ? result_.angle : result_.length;
  largest = std::max(largest, std::abs(difference));
  ++result_.positions;
}

void TableComparison::check_points(const TableLine& line, const std::string& file,
                                   const std::vector<controllers::TablePoint>& points) const {
  const double unit = line.joint < kLinearJoints ? mm : deg;
  const char* name = line.joint < kLinearJoints ? "mm" : "deg";
  if (points.size() != line.points) {
    throw InputError({file}, fmt::format("verification failed: {} points; {} are needed",
                                         points.size(), line.points));
  }
  // last digit of positions: mm, deg
  const double digit = e_.request.format == TableFormat::heidenhain ? 1e-4 : 1e-6;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::abs(points[i].position - line.entry(i)) <= 0.501 * digit * unit) continue;
    throw InputError(
        {file, points[i].line},
        fmt::format("verification failed: position {:.6f} {}; point {} must be at {:.6f}",
                    points[i].position / unit, name, i, line.entry(i) / unit));
  }
}

// Linear interpolation between exact values at the requested points.
std::function<double(double)> TableComparison::chords(const TableLine& line, const Comparison& c,
                                                      int direction) const {
  std::vector<double> values;
  for (std::size_t i = 0; i < line.points; ++i) {
    values.push_back(c.needed(line.position(line.entry(i)), direction));
  }
  return [values, &line](double entry) {
    const double last = static_cast<double>(values.size() - 1);
    const double u = std::clamp((entry - line.first) / line.spacing, 0.0, last);
    const auto i = std::min(static_cast<std::size_t>(u), values.size() - 2);
    const double share = u - static_cast<double>(i);
    return (1.0 - share) * values[i] + share * values[i + 1];
  };
}

void TableComparison::fail(const TableLine& line, const Comparison& c, double q, int direction,
                           double read, double wanted) const {
  const bool is_linear_base = line.joint < kLinearJoints;
  throw InputError({c.file, c.line_at(q)},
                   fmt::format("verification failed: {} at {}{:.6g} {}, travelling {}: the file "
                               "gives {}, the error model {}",
                               c.title, e_.letter(line.joint), q / (is_linear_base ? mm : deg),
                               is_linear_base ? "mm" : "deg", direction > 0 ? "up" : "down",
                               exact_size(c.is_angle, read), exact_size(c.is_angle, wanted)));
}

}  // namespace servomill::sim::tables
