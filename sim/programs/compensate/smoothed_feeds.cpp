#include "sim/programs/compensate/smoothed_feeds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/path/trajectory.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/move_curve.h"
#include "plant/vocabulary/units.h"
#include "sim/programs/compensate/program_corrector.h"

namespace servomill::sim::programs {
namespace {

constexpr std::size_t kMaxBlocks = 200'000;  // some hundred bytes each
constexpr std::size_t kLongestRun = 20'000;  // blocks; then the motion is taken to stop
constexpr double kApart = 50e-6;             // m, of samples, about
constexpr double kMaxSamples = 2e5;          // of a run

// Distance of a point from the blocks around one of them.
double distance(const Eigen::Vector3d& p, const std::vector<MoveCurve>& curves, std::size_t near) {
  double best = 1.0;
  const std::size_t first = near > 1 ? near - 2 : 0, last = std::min(near + 3, curves.size());
  for (std::size_t i = first; i < last; ++i) {
    best = std::min(best, (p - curves[i].at(curves[i].closest(p)).head<3>()).norm());
  }
  return best;
}

}  // namespace

SmoothedFeeds::SmoothedFeeds(const model::MachineSettings& machine, double smoothing,
                             double tolerance)
    : machine_(machine), smoothing_(smoothing), tolerance_(tolerance) {
  for (int j = 0; j < kJoints; ++j) {
    if (!machine.chain.layout.has(j)) continue;
    has_limits_ &=
        machine.nc.v_max[j] > 0.0 && machine.nc.a_max[j] > 0.0 && machine.nc.j_max[j] > 0.0;
  }
}

void SmoothedFeeds::add(const Step& step) {
  is_cut_short_ |= blocks_ >= kMaxBlocks;
  if (!has_limits_ || is_cut_short_ || !(step.move->feed > 0.0)) return;
  const WorkFrame& frame = step.programmed.frame;
  if (run_.empty()) begin_ = at_ = frame.machine(step.begin);
  for (const FittedBlock& block : step.blocks) {
    Move move = *step.move;
    move.kind = block.arc ? MoveKind::arc : MoveKind::feed;
    move.end = move.end_machine = frame.machine(block.end);
    if (block.arc) {
      AxisWords centre = AxisWords::Zero();
      centre.head<3>() = block.arc->centre;
      move.arc = *block.arc;
      move.centre_machine = move.arc.centre = frame.machine(centre).head<3>();
    }
    move.path_mode = PathMode::continuous;
    const double way = MoveCurve(at_, move).length();
    const double turned = (move.end_machine - at_).tail<3>().norm();
    const double share = block.t_end - block.t_begin;
    if (step.programmed.turns_axes() && share > 0.0 && way > 0.0) {  // its share of the time
      const double length = step.programmed.length();
      const double whole =
          length > 0.0 ? length : (step.programmed.end - step.programmed.begin).tail<3>().norm();
      move.feed = way * step.move->feed / (share * whole);
    }
    if (way == 0.0 && turned == 0.0) continue;
    move.s_begin = run_.empty() ? 0.0 : run_.back().s_end;
    move.s_end = move.s_begin + way;
    at_ = move.end_machine;
    run_.push_back(std::move(move));
    ++blocks_;
  }
  if (run_.size() >= kLongestRun) end_run();
}

SmoothedFeeds::Plan SmoothedFeeds::plan(double tolerance) const {
  std::vector<Move> moves = run_;
  for (Move& move : moves) move.path_tolerance = tolerance;
  const JointLayout& layout = machine_.chain.layout;
  controllers::PathOptions options;
  options.tolerance = tolerance;
  options.block_time = machine_.nc.block_time;
  const controllers::Trajectory trajectory =
      controllers::plan(moves, layout, layout.joints(begin_),
                        {machine_.nc.v_max, machine_.nc.a_max, machine_.nc.j_max}, options);
  std::vector<MoveCurve> curves;
  AxisWords from = begin_;
  for (const Move& move : moves) {
    curves.emplace_back(from, move);
    from = move.end_machine;
  }
  Plan out{trajectory.duration(), 0.0};
  const double samples = std::clamp(moves.back().s_end / kApart, 10.0, kMaxSamples);
  controllers::Trajectory::Cursor cursor;
  for (double i = 0.0; i <= samples; i += 1.0) {
    const auto sample = trajectory.at(out.time * i / samples, cursor);
    const Eigen::Vector3d p = layout.words(sample.Q_ref).head<3>();
    out.distance = std::max(out.distance, distance(p, curves, sample.move));
  }
  return out;
}

void SmoothedFeeds::end_run() {
  if (run_.empty()) return;
  throw_if_interrupted();
  for (const auto& [tolerance, sum] : {std::pair{smoothing_, &smoothed_}, {tolerance_, &held_}}) {
    const Plan one = plan(tolerance);
    sum->time += one.time;
    sum->distance = std::max(sum->distance, one.distance);
  }
  run_.clear();
}

std::string SmoothedFeeds::text() const {
  const std::string allowed = fmt::format(
      "smoothing: the control may leave the corrected path by {:g} um at corners of short blocks",
      smoothing_ / um);
  if (!has_limits_)
    return allowed + " (not simulated: the machine file gives no v_max, a_max, j_max)";
  if (blocks_ == 0) return allowed;
  return fmt::format(
      "{}; simulated{}: by {:.1f} um, {:.1f} s at feed; limited to {:g} um: {:.1f} s", allowed,
      is_cut_short_ ? fmt::format(" for the first {} blocks", blocks_) : "",
      smoothed_.distance / um, smoothed_.time, tolerance_ / um, held_.time);
}

}  // namespace servomill::sim::programs
