#include "sim/program_path.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>

namespace servomill::sim {
namespace {

// How far along the path the closest point is looked for, beyond the distance of the point itself.
constexpr double kSearchMargin = 0.1e-3;  // m

int index_of_section(std::vector<std::string>& sections, const std::string& name) {
  const auto known = std::find(sections.begin(), sections.end(), name);
  if (known != sections.end()) return static_cast<int>(known - sections.begin());
  sections.push_back(name);
  return static_cast<int>(sections.size()) - 1;
}

}  // namespace

ProgramPath::ProgramPath(std::span<const Move> moves, const AxisWords& start,
                         std::shared_ptr<const controllers::ToolCentrePoint> machine,
                         const std::map<int, Eigen::Vector3d>& tips)
    : machine_(std::move(machine)) {
  AxisWords at = start;  // machine coordinates; behind a tip piece tip words with its p_ST
  const Piece* before = nullptr;
  int section = 0;
  for (const Move& move : moves) {
    if (move.kind == MoveKind::message) section = index_of_section(sections_, move.text);
    if (!is_motion(move.kind)) continue;
    Piece piece{{},
                move.end_machine,
                move.s_begin,
                move.s_end,
                move.line,
                move.tool_offset,
                move.kind == MoveKind::rapid,
                section};
    piece.is_tip = move.tool_control != ToolControl::none;
    if (piece.is_tip) piece.p_ST = tips.at(move.tool_offset);
    piece.curve = MoveCurve(begin_of(piece, before, at), move);
    pieces_.push_back(piece);
    before = &pieces_.back();
    at = move.end_machine;
  }
}

// Where a piece begins, in its own coordinates; `at` is in those of the piece before.
AxisWords ProgramPath::begin_of(const Piece& piece, const Piece* before, AxisWords at) const {
  const bool was_tip = before != nullptr && before->is_tip;
  if (was_tip == piece.is_tip && (!was_tip || before->p_ST == piece.p_ST)) return at;
  assert(machine_ != nullptr);
  if (was_tip) at = machine_->machine_words(at, before->p_ST).value_or(at);
  if (piece.is_tip) at = machine_->tip_words(at, piece.p_ST);
  return at;
}

std::size_t ProgramPath::piece_at(double s, std::size_t near) const {
  assert(near < pieces_.size());
  while (near + 1 < pieces_.size() && s > pieces_[near].s_end) ++near;
  while (near > 0 && s < pieces_[near].s_begin) --near;
  return near;
}

AxisWords ProgramPath::at(std::size_t index, double s) const {
  const Piece& p = pieces_[index];
  const double length = p.s_end - p.s_begin;
  return length > 0.0 ? p.curve.at(std::clamp((s - p.s_begin) / length, 0.0, 1.0)) : p.end;
}

Joints ProgramPath::joints(std::size_t index, double s, const JointLayout& layout,
                           const Joints& Q_ref) const {
  const Piece& p = pieces_[index];
  Joints Q = layout.joints(at(index, s));
  Q.tail<kJoints - kLinearJoints>() = Q_ref.tail<kJoints - kLinearJoints>();
  if (!p.is_tip) return Q;
  // the planner has been there: the linear axes can
  return machine_->joints(at(index, s).head<3>(), Q, p.p_ST).value_or(Q_ref);
}

double ProgramPath::distance(const Eigen::Vector3d& point, std::size_t index) const {
  const bool is_tip = pieces_[index].is_tip;
  const auto to_piece = [&](const Piece& p) {
    if (p.is_tip != is_tip) return std::numeric_limits<double>::infinity();
    return (p.curve.at(p.curve.closest(point)).head<3>() - point).norm();
  };
  double best = to_piece(pieces_[index]);
  const double reach = best + kSearchMargin;
  double gone = 0.0;
  for (std::size_t i = index; i + 1 < pieces_.size() && gone < reach; ++i) {
    best = std::min(best, to_piece(pieces_[i + 1]));
    gone += pieces_[i + 1].curve.length();
  }
  gone = 0.0;
  for (std::size_t i = index; i > 0 && gone < reach; --i) {
    best = std::min(best, to_piece(pieces_[i - 1]));
    gone += pieces_[i - 1].curve.length();
  }
  return best;
}

}  // namespace servomill::sim
