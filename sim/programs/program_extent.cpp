#include "sim/programs/program_extent.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/spline_curve.h"

namespace servomill::sim::programs {
namespace {

constexpr double kStill = 1e-12;  // m, rad: what rounding leaves of positions

void include(AxisRanges& ranges, const AxisWords& position, const AxisFlags& is_known) {
  for (std::size_t i = 0; i < kAxisWords; ++i) {
    if (is_known[i]) ranges[i].include(position[static_cast<Eigen::Index>(i)]);
  }
}

// The quadrant points that lie on the arc, where its plane is known at both ends.
void include_extremes(AxisRanges& ranges, const ArcSweep& arc, const AxisFlags& begin,
                      const AxisFlags& end) {
  const auto a = static_cast<std::size_t>(arc.a), b = static_cast<std::size_t>(arc.b);
  if (!begin[a] || !begin[b] || !end[a] || !end[b]) return;
  constexpr double kQuarter = std::numbers::pi / 2.0;
  const double low = std::min(arc.angle, arc.angle + arc.sweep);
  const double high = std::max(arc.angle, arc.angle + arc.sweep);
  const double first = std::ceil(low / kQuarter);
  for (int n = 0; n < 4 && (first + n) * kQuarter <= high; ++n) {  // a full turn has four
    const Eigen::Vector3d point = arc.point(((first + n) * kQuarter - arc.angle) / arc.sweep);
    ranges[a].include(point[arc.a]);
    ranges[b].include(point[arc.b]);
  }
}

// The farthest X and Y, where they are known at both ends.
void include_extremes(AxisRanges& ranges, const SplineCurve& curve, const Eigen::Vector3d& shift,
                      const AxisFlags& begin, const AxisFlags& end) {
  if (!begin[0] || !begin[1] || !end[0] || !end[1]) return;
  const auto [low, high] = curve.extent();
  for (std::size_t i = 0; i < 2; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    for (const Eigen::Vector3d& corner : {low, high}) ranges[i].include(corner[k] - shift[k]);
  }
}

}  // namespace

void AxisRange::include(double position) {
  lower = std::min(lower, position);
  upper = std::max(upper, position);
}

void ProgramExtent::count_unknown(const Move& move, const MoveKnowledge& known) {
  for (std::size_t i = 0; i < kAxisWords; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const bool learns = known.end_work_is_known[i] && !known.begin_work_is_known[i];
    if (!learns && std::abs(move.end_machine[k] - known.begin_machine[k]) <= kStill) continue;
    if (moved_[i] == 0) moved_[i] = move.line;
    const bool is_work = known.end_work_is_known[i] || known.is_place;
    if (!is_work && unknown_work_[i] == 0) unknown_work_[i] = move.line;
    if (!known.end_machine_is_known[i] && unknown_machine_[i] == 0) unknown_machine_[i] = move.line;
  }
}

void ProgramExtent::add(const Move& move, const MoveKnowledge& known) {
  count_unknown(move, known);
  const bool is_arc = move.kind == MoveKind::arc && !known.is_tilted;
  include(machine_, move.end_machine, known.end_machine_is_known);
  if (is_arc) {
    include_extremes(machine_, arc_sweep(move, known.begin_machine.head<3>()),
                     known.begin_machine_is_known, known.end_machine_is_known);
  }
  if (move.kind == MoveKind::spline) {
    include_extremes(machine_, move.spline->curve, Eigen::Vector3d::Zero(),
                     known.begin_machine_is_known, known.end_machine_is_known);
  }
  if (known.is_tilted && tilted_ == 0) tilted_ = move.line;
  if (known.is_place || known.is_tilted) return;
  WorkExtent& extent = work_[known.work_system];
  const AxisWords begin = known.begin_work - known.system_offset;
  const AxisWords end = move.end - known.system_offset;
  const Eigen::Vector3d offset = known.system_offset.head<3>();
  const bool is_feed = move.kind != MoveKind::rapid;
  for (AxisRanges* ranges : {&extent.motion, &extent.feed}) {
    if (ranges == &extent.feed && !is_feed) continue;
    if (ranges == &extent.feed) include(*ranges, begin, known.begin_work_is_known);
    include(*ranges, end, known.end_work_is_known);
    if (move.kind == MoveKind::spline) {
      include_extremes(*ranges, curve_in_work(*move.spline), offset, known.begin_work_is_known,
                       known.end_work_is_known);
    }
    if (!is_arc) continue;
    const ArcSweep arc(begin.head<3>(), end.head<3>(), move.arc.centre - offset,
                       move.arc.normal_axis, move.arc.turns);
    include_extremes(*ranges, arc, known.begin_work_is_known, known.end_work_is_known);
  }
}

}  // namespace servomill::sim::programs
