#include "sim/preparation/tool_passes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/interrupt.h"

namespace servomill::sim::preparation {
namespace {

using Eigen::Vector3d;

constexpr double kChord = 0.05 * um;  // between the path and the straight steps that remove
constexpr int kFirstParts = 8;        // of a curved move
constexpr int kMaxHalvings = 12;
// Share at which whole turns in a step do not pass for a straight one.
constexpr double kOddShare = 0.381966;

// Bound of the distance (m) of the cutter from its position on a straight step, at a share of it.
double departure(const Stage& stage, const plant::CutterPosition& from,
                 const plant::CutterPosition& to, const plant::CutterPosition& at, double share) {
  const double reach = stage.cutter != nullptr ? stage.cutter->length : 0.0;
  const Vector3d tip = at.tip - (from.tip + share * (to.tip - from.tip));
  const Vector3d axis = at.axis - (from.axis + share * (to.axis - from.axis)).normalized();
  return tip.norm() + reach * axis.norm();
}

}  // namespace

ToolPasses::ToolPasses(const CuttingPlanInputs& in)
    : in_(in),
      path_(in.program->path),
      frame_(model::work_frame(in.chain, in.work_offset)),
      Q_near_(in.start) {
  int tool = 0, direction = 0;
  double speed = 0.0;
  std::size_t piece = 0;
  for (const Move& move : in_.program->moves) {
    throw_if_interrupted();
    if (move.kind == MoveKind::tool) tool = move.number;
    if (move.kind == MoveKind::spindle) {
      direction = move.direction;
      speed = move.value;
    }
    if (!is_motion(move.kind)) continue;
    const int in_spindle = tool != 0 ? tool : move.tool_offset;
    const auto cutter = in_.cutters.find(in_spindle);
    const auto p = path_.piece(piece);
    const bool turns = (p.end - p.begin).tail<3>() != Vector3d::Zero() || p.is_great_circle;
    stages_.push_back({piece++, in_spindle, cutter == in_.cutters.end() ? nullptr : &cutter->second,
                       direction == 0 ? 0.0 : std::abs(speed) / (2.0 * std::numbers::pi),
                       direction >= 0, move.kind < MoveKind::arc && !turns});
  }
}

plant::CutterPosition ToolPasses::position(const Stage& stage, double share) {
  const engine::ProgramPath::Piece p = path_.piece(stage.piece);
  const JointLayout& layout = in_.chain.layout;
  const double length = p.s_end - p.s_begin;
  // where s stands still, the programmed joints choose the position
  const Joints near = length > 0.0 ? Q_near_ : layout.joints(p.begin + share * (p.end - p.begin));
  Q_near_ = path_.joints(stage.piece, p.s_begin + share * length, layout, near);
  const ToolPose pose = plant::forward(in_.chain, Q_near_, in_.program->tips.at(p.tool_offset));
  return {frame_.point(pose.p_WT), frame_.direction(pose.k_W).normalized()};
}

// Successive stages with the same cutter form one pass. `counts` maps each position of a stage to
// the number of cutting positions up to it, so that the material at any point of the program is
// known.
plant::RemovedVolume ToolPasses::remove() {
  std::vector<plant::CutterPass> passes;
  const plant::Cutter* before = nullptr;
  std::size_t count = 0;
  for (Stage& stage : stages_) {
    throw_if_interrupted();
    std::vector<plant::CutterPosition> positions = {position(stage, 0.0)};
    stage.shares = {0.0};
    const int parts = stage.is_straight ? 1 : kFirstParts;
    for (int n = 1; n <= parts; ++n) {
      throw_if_interrupted();
      const double end = static_cast<double>(n) / parts;
      add_steps(stage, end, position(stage, end), positions, 0);
    }
    for (const auto& at : positions) stage.tips.extend(at.tip);
    if (stage.cutter != nullptr) {
      if (stage.cutter != before) passes.push_back({*stage.cutter, {}});
      for (const auto& at : positions) {
        stage.counts.push_back(++count);
        passes.back().positions.push_back(at);
      }
    } else {
      stage.counts.assign(stage.shares.size(), count);
    }
    before = stage.cutter;
  }
  return plant::RemovedVolume(passes);
}

void ToolPasses::add_steps(Stage& stage, double end, const plant::CutterPosition& at_end,
                           std::vector<plant::CutterPosition>& positions, int halvings) {
  const plant::CutterPosition from = positions.back();
  if (!stage.is_straight && halvings < kMaxHalvings) {
    const double begin = stage.shares.back();
    const auto at_share = [&](double share) {
      return position(stage, begin + share * (end - begin));
    };
    const plant::CutterPosition at = at_share(0.5);
    if (departure(stage, from, at_end, at, 0.5) > kChord ||
        departure(stage, from, at_end, at_share(kOddShare), kOddShare) > kChord) {
      const double middle = 0.5 * (begin + end);
      add_steps(stage, middle, at, positions, halvings + 1);
      add_steps(stage, end, at_end, positions, halvings + 1);
      return;
    }
  }
  stage.shares.push_back(end);
  positions.push_back(at_end);
}

std::size_t ToolPasses::positions_before(const Stage& stage, double share) const {
  const engine::ProgramPath::Piece p = path_.piece(stage.piece);
  const double behind = share - 0.5 * kBehind / (p.s_end - p.s_begin);
  const auto next = std::upper_bound(stage.shares.begin(), stage.shares.end(), behind);
  const auto last = std::max<std::ptrdiff_t>(0, next - stage.shares.begin() - 1);
  return stage.counts[static_cast<std::size_t>(last)];
}

}  // namespace servomill::sim::preparation
