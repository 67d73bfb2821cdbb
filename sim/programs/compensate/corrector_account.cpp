// Account of what a corrected program changes, move by move.
#include <algorithm>
#include <cmath>

#include "sim/programs/compensate/point_uncertainty.h"
#include "sim/programs/compensate/program_corrector.h"
#include "sim/programs/compensate/smoothed_feeds.h"

namespace servomill::sim::programs {
namespace {

constexpr double kResidualStep = 5e-3;  // m, between two looks, about
constexpr double kStill = 1e-12;        // m, rad: what rounding leaves of positions

bool is_worse(const strategies::Residual& a, const strategies::Residual& b) {
  constexpr double kAxis = 1e-6;  // rad: of less nothing is said
  const bool by_axis = std::max(a.axis, b.axis) > kAxis;
  return by_axis ? a.axis > b.axis : a.tip > b.tip;
}

}  // namespace

void ProgramCorrector::sample_residual(const Step& step) {
  if (step.move->kind == MoveKind::rapid) return;
  const double length = step.programmed.length();
  const int looks = std::max(1, static_cast<int>(length / kResidualStep));
  for (int i = 1; i <= looks; ++i) {
    const AxisWords at =
        step.programmed.frame.machine(step.programmed.at(static_cast<double>(i) / looks));
    const strategies::Residual left = correction_.residual(at);
    if (summary_.most_left && !is_worse(left, summary_.left)) continue;
    summary_.left = left;
    summary_.most_left = Summary::At{step.move->line, at, AxisWords::Zero()};
  }
}

void ProgramCorrector::warn_of_travel(const Step& step) {
  const JointLayout& layout = correction_.layout();
  for (const FittedBlock& block : step.blocks) {
    const AxisWords at = step.programmed.frame.machine(block.end);
    const Joints Q = layout.joints(at);
    bool is_outside = false;
    for (int j = 0; j < kJoints; ++j) {
      if (!layout.has(j) || !is_known(*layout.axis[static_cast<std::size_t>(j)])) continue;
      is_outside |= Q[j] < options_.lower[j] || Q[j] > options_.upper[j];
    }
    if (!is_outside) continue;
    ++summary_.outside_count;
    if (!summary_.outside) summary_.outside = Summary::At{step.move->line, at, AxisWords::Zero()};
  }
}

// F is kept, so that the time of a corrected block scales with its length; G93 fixes it instead.
void ProgramCorrector::count(const Step& step) {
  const Move& move = *step.move;
  ++summary_.blocks_before;
  summary_.blocks_after += step.blocks.size();
  summary_.points_added += step.blocks.size() - 1;
  if (move.kind == MoveKind::arc) {
    ++summary_.arcs_before;
    std::size_t arcs = 0;
    for (const FittedBlock& block : step.blocks) arcs += block.arc ? 1 : 0;
    ++(arcs == 0 ? summary_.arcs_to_lines : arcs == 1 ? summary_.arcs_kept : summary_.arcs_split);
  }
  const WorkFrame& frame = step.programmed.frame;
  for (const FittedBlock& block : step.blocks) {
    const AxisWords at = step.programmed.at(block.t_end);
    const AxisWords d = frame.turned(block.end - at);
    summary_.largest_turn = std::max(summary_.largest_turn, d.tail<3>().cwiseAbs().maxCoeff());
    const double most = std::max(kStill, summary_.largest.correction.head<3>().norm());
    if (d.head<3>().norm() <= most) continue;
    summary_.largest = {move.line, frame.machine(at), d};
  }
  if (move.kind == MoveKind::rapid) return;
  const double length = step.programmed.length();
  double after = 0.0;
  AxisWords from = step.begin;
  for (const FittedBlock& block : step.blocks) {
    after += block.arc ? ArcSweep(from.head<3>(), block.end.head<3>(), block.arc->centre,
                                  block.arc->normal_axis, block.arc->turns)
                             .length()
                       : (block.end - from).head<3>().norm();
    from = block.end;
  }
  summary_.length += length;
  summary_.corrected_length += after;
  const double turned = (step.programmed.end - step.programmed.begin).tail<3>().norm();
  const double way = length > 0.0 ? length : turned;
  const double time = move.feed > 0.0 ? way / move.feed : 0.0;
  summary_.time += time;
  const bool is_inverse = move.feed_mode == FeedMode::inverse_time;
  summary_.corrected_time += length > 0.0 && !is_inverse ? time * after / length : time;
}

void ProgramCorrector::arrive(const Step& step, const AxisWords& machine) {
  if (step.is_corrected) {
    count(step);
    sample_residual(step);
    if (record_ != nullptr) record_->add(step, correction_);
  } else {
    ++summary_.blocks_before;
    ++summary_.blocks_after;
  }
  if (uncertainty_ != nullptr) uncertainty_->add(step, correction_);
  if (feeds_ != nullptr) {
    const bool is_feed = step.is_corrected && step.move->kind != MoveKind::rapid;
    if (is_feed) feeds_->add(step);
    if (!is_feed) feeds_->end_run();
  }
  warn_of_travel(step);
  programmed_ = step.move->end_machine;
  out_ = machine;
}

}  // namespace servomill::sim::programs
