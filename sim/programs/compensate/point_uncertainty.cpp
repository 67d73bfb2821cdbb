#include "sim/programs/compensate/point_uncertainty.h"

#include <fmt/format.h>

#include <cmath>

#include "plant/vocabulary/units.h"
#include "sim/programs/compensate/program_corrector.h"
#include "sim/system/json.h"

namespace servomill::sim::programs {
namespace {

constexpr double kUnmoved = 1e-12;    // m, rad: what rounding leaves of positions
constexpr double kJustBefore = 0.01;  // of a block

std::string three(const Eigen::Vector3d& v) {
  return fmt::format("[{:.4f}, {:.4f}, {:.4f}]", v[0] / um, v[1] / um, v[2] / um);
}

}  // namespace

void PointUncertainty::add(const Step& step, const Correction& correction) {
  const ProgrammedMove& move = step.programmed;
  const bool is_feed = step.is_corrected && step.move->kind != MoveKind::rapid;
  for (const FittedBlock& block : step.blocks) {
    const AxisWords at = move.frame.machine(move.at(block.t_end));
    const double before = block.t_end - kJustBefore * (block.t_end - block.t_begin);
    const AxisWords way = at - move.frame.machine(move.at(before));
    for (int i = 0; i < kAxisWords; ++i) {
      if (std::abs(way[i]) > kUnmoved) directions_[i] = way[i] > 0.0 ? 1.0 : -1.0;
    }
    if (!is_feed) continue;
    const Eigen::Vector3d U =
        tip_.expanded(layout_.joints(at), correction.tool(), layout_.joints(directions_));
    if (U.maxCoeff() > largest_.maxCoeff() || count_ == 0) largest_line_ = step.move->line;
    ++count_;
    largest_ = largest_.cwiseMax(U);
    squares_ += U.cwiseAbs2();
    if (keeps_) points_.push_back({step.move->line, at.head<3>(), U});
  }
}

Eigen::Vector3d PointUncertainty::rms() const {
  if (count_ == 0) return Eigen::Vector3d::Zero();
  return (squares_ / static_cast<double>(count_)).cwiseSqrt();
}

std::string PointUncertainty::report() const {
  const Eigen::Vector3d mean = rms();
  std::string out = "uncertainty of the corrected points (k = 2):";
  for (int i = 0; i < 3; ++i) {
    out += fmt::format("{} {} {:.2f} um (rms {:.2f})", i == 0 ? "" : ",", "XYZ"[i],
                       largest_[i] / um, mean[i] / um);
  }
  return out + fmt::format(" at most, largest in line {}", largest_line_);
}

std::string PointUncertainty::json() const {
  return system::JsonObject(system::JsonSpacing::none)
      .raw("largest_um", three(largest_))
      .raw("rms_um", three(rms()))
      .integer("line", largest_line_)
      .integer("points", count_)
      .line();
}

std::string PointUncertainty::csv() const {
  std::string out = "line,X_mm,Y_mm,Z_mm,U_X_um,U_Y_um,U_Z_um\n";
  for (const Point& point : points_) {
    out += fmt::format("{},{:.6f},{:.6f},{:.6f},{:.4f},{:.4f},{:.4f}\n", point.line,
                       point.machine[0] / mm, point.machine[1] / mm, point.machine[2] / mm,
                       point.expanded[0] / um, point.expanded[1] / um, point.expanded[2] / um);
  }
  return out;
}

}  // namespace servomill::sim::programs
