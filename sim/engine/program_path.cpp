#include "sim/engine/program_path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "plant/vocabulary/tool_axis.h"

namespace servomill::sim::engine {
namespace {

// How far along the path the closest point is looked for, beyond the distance of the point itself.
constexpr double kSearchMargin = 0.1e-3;  // m

// Signs of zero included.
template <class Words>
bool has_same_bits(const Words& a, const Words& b) {
  for (int i = 0; i < a.size(); ++i) {
    if (std::bit_cast<std::uint64_t>(a[i]) != std::bit_cast<std::uint64_t>(b[i])) return false;
  }
  return true;
}

int index_of_section(std::vector<std::string>& sections, const std::string& name) {
  const auto known = std::find(sections.begin(), sections.end(), name);
  if (known != sections.end()) return static_cast<int>(known - sections.begin());
  sections.push_back(name);
  return static_cast<int>(sections.size()) - 1;
}

// Accesses to a path on the disk after which memory of what was read is given back.
constexpr std::uint32_t kAccessesInMemory = 1U << 13U;

// A vector that grows holds its elements twice for a while.
std::size_t motions_of(const MoveRange& moves) {
  std::size_t count = 0;
  for (const Move& move : moves) count += is_motion(move.kind) ? 1 : 0;
  return count;
}

}  // namespace

ProgramPath::ProgramPath(const MoveRange& moves, const AxisWords& start,
                         std::shared_ptr<const controllers::ToolCentrePoint> machine,
                         const std::map<int, Eigen::Vector3d>& tips, std::size_t most_in_memory)
    : machine_(std::move(machine)),
      pieces_("the programmed path", most_in_memory),
      rotary_ends_("the programmed path", most_in_memory) {
  AxisWords at = start;  // machine coordinates; behind a tip piece tip words with its p_ST
  std::optional<Piece> before;
  int section = 0;
  std::optional<int> tool;
  pieces_.reserve(motions_of(moves));
  for (const Move& move : moves) {
    if (move.kind == MoveKind::tool) tool = move.number;
    if (move.kind == MoveKind::message) {
      section = index_of_section(sections_, move.text);
      section_begins_.push_back(pieces_.size());
    }
    if (!is_motion(move.kind)) continue;
    Piece piece{{},
                move.end_machine,
                move.s_begin,
                move.s_end,
                move.line,
                move.tool_offset,
                tool.value_or(move.tool_offset),
                move.kind == MoveKind::rapid,
                section};
    piece.is_tip = move.tool_control != ToolControl::none;
    if (piece.is_tip) piece.p_ST = tips.at(move.tool_offset);
    piece.begin = begin_of(piece, before ? &*before : nullptr, at);
    set_tool_axes(piece, move);
    const bool is_straight = move.kind < MoveKind::arc && !piece.is_great_circle && before &&
                             piece.s_begin == before->s_end &&
                             has_same_bits(piece.begin, before->end);
    hold(piece, is_straight ? nullptr : &move);
    before = piece;
    at = move.end_machine;
  }
  pieces_.finish();
  rotary_ends_.finish();
}

// @param move  of which the curve is; nullptr: straight from the end of the piece before
void ProgramPath::hold(const Piece& piece, const Move* move) {
  Held held{piece.end.head<3>(), piece.s_end, piece.line, index_of_rotary(piece.end.tail<3>())};
  held.setting = index_of(
      {piece.tool_offset, piece.tool, piece.rapid, piece.is_tip, piece.section, piece.p_ST});
  if (move != nullptr) {
    held.curved = static_cast<std::uint32_t>(curved_.size());
    curved_.push_back({MoveCurve(piece.begin, *move), piece.begin, piece.s_begin,
                       piece.is_great_circle, piece.k_begin, piece.k_end});
  }
  pieces_.push_back(held);
}

std::uint32_t ProgramPath::index_of(const Setting& setting) {
  if (settings_.empty() || settings_.back() != setting) settings_.push_back(setting);
  return static_cast<std::uint32_t>(settings_.size() - 1);
}

std::uint32_t ProgramPath::index_of_rotary(const Eigen::Vector3d& end) {
  if (rotary_ends_.empty() || !has_same_bits(rotary_ends_.back(), end)) rotary_ends_.push_back(end);
  return static_cast<std::uint32_t>(rotary_ends_.size() - 1);
}

AxisWords ProgramPath::end_of(const Held& held) const {
  AxisWords end;
  end.head<3>() = held.end;
  end.tail<3>() = rotary_ends_[held.rotary_end];
  return end;
}

double ProgramPath::s_begin_of(std::size_t index) const {
  const std::uint32_t curved = pieces_[index].curved;
  return curved == kStraight ? pieces_[index - 1].s_end : curved_[curved].s_begin;
}

MoveCurve ProgramPath::curve_of(std::size_t index) const {
  const Held& held = pieces_[index];
  if (held.curved != kStraight) return curved_[held.curved].curve;
  return {end_of(pieces_[index - 1]), end_of(held)};
}

// To be called at each access to the path. Accesses are counted, not pieces: rows skip pieces or
// stay on one, and several runs read the path at a time.
void ProgramPath::release_behind() const {
  if (!pieces_.is_on_disk() && !rotary_ends_.is_on_disk()) return;
  thread_local std::uint32_t accesses = 0;
  if (++accesses % kAccessesInMemory != 0) return;
  pieces_.release();
  rotary_ends_.release();
}

ProgramPath::Piece ProgramPath::piece(std::size_t index) const {
  release_behind();
  const Held& held = pieces_[index];
  const Setting& setting = setting_of(held);
  Piece out{curve_of(index), end_of(held),        s_begin_of(index), held.s_end,
            held.line,       setting.tool_offset, setting.tool,      setting.rapid,
            setting.section, setting.is_tip,      setting.p_ST};
  if (held.curved == kStraight) {
    out.begin = end_of(pieces_[index - 1]);
    return out;
  }
  const Curved& curved = curved_[held.curved];
  out.begin = curved.begin;
  out.is_great_circle = curved.is_great_circle;
  out.k_begin = curved.k_begin;
  out.k_end = curved.k_end;
  return out;
}

// Start of a piece in its own coordinates; `at` is in those of the previous piece.
AxisWords ProgramPath::begin_of(const Piece& piece, const Piece* before, AxisWords at) const {
  const bool was_tip = before != nullptr && before->is_tip;
  if (was_tip == piece.is_tip && (!was_tip || before->p_ST == piece.p_ST)) return at;
  assert(machine_ != nullptr);
  if (was_tip) at = machine_->machine_words(at, before->p_ST).value_or(at);
  if (piece.is_tip) at = machine_->tip_words(at, piece.p_ST);
  return at;
}

void ProgramPath::set_tool_axes(Piece& piece, const Move& move) const {
  piece.is_great_circle = move.tool_control == ToolControl::tool_axis;
  if (!piece.is_great_circle) return;
  piece.k_begin = machine_->tool_axis(machine_->chain().layout.joints(piece.begin));
  piece.k_end = move.tool_axis;
}

ProgramPath::Indices ProgramPath::pieces_of(const MoveRange& moves) const {
  const auto holds = [this](std::size_t piece, const Move& move) {
    const Held& p = pieces_[piece];
    return p.line == move.line && s_begin_of(piece) <= move.s_begin && move.s_end <= p.s_end;
  };
  Indices out;
  out.reserve(moves.size());
  std::uint32_t piece = 0;
  for (const Move& move : moves) {
    while (is_motion(move.kind) && !holds(piece, move)) {
      if (++piece == pieces_.size()) throw std::logic_error("a move is on no line of the program");
      release_behind();
    }
    out.push_back(piece);
  }
  return out;
}

AxisWords ProgramPath::at(std::size_t index, double s) const {
  release_behind();
  const Held& p = pieces_[index];
  const double s_begin = s_begin_of(index), length = p.s_end - s_begin;
  if (!(length > 0.0)) return end_of(p);
  const double share = std::clamp((s - s_begin) / length, 0.0, 1.0);
  return p.curved == kStraight ? curve_of(index).at(share) : curved_[p.curved].curve.at(share);
}

// Share of the piece that is behind; by the turn of the rotary axes where s stands.
double ProgramPath::fraction(const Piece& p, double s, const JointLayout& layout,
                             const Joints& Q_near) const {
  const double length = p.s_end - p.s_begin;
  double share = 1.0;
  if (length > 0.0) {
    share = (s - p.s_begin) / length;
  } else if (p.is_great_circle) {
    const double angle = angle_between(p.k_begin, p.k_end);
    const Eigen::Vector3d k = machine_->tool_axis(Q_near);
    const Eigen::Vector3d across = p.k_end - p.k_begin * p.k_begin.dot(p.k_end);
    if (angle > 0.0) share = std::atan2(k.dot(across.normalized()), k.dot(p.k_begin)) / angle;
  } else {
    const Eigen::Vector3d turn = (p.end - p.begin).tail<3>();
    const Eigen::Vector3d turned = (layout.words(Q_near) - p.begin).tail<3>();
    if (!turn.isZero(0.0)) share = turn.dot(turned) / turn.squaredNorm();
  }
  return std::clamp(share, 0.0, 1.0);
}

Joints ProgramPath::joints(std::size_t index, double s, const JointLayout& layout,
                           const Joints& Q_near) const {
  if (!is_tip(index) && !stands(index)) return layout.joints(at(index, s));
  const Piece p = piece(index);
  const double share = fraction(p, s, layout, Q_near);
  const AxisWords words = p.curve.at(share);
  Joints Q = layout.joints(words);
  if (!p.is_tip) return Q;
  if (p.is_great_circle) {
    const auto k = controllers::ToolCentrePoint::axis_between(p.k_begin, p.k_end, share);
    Q.tail<kJoints - kLinearJoints>() =
        machine_->point(k, Q_near).Q.tail<kJoints - kLinearJoints>();
  }
  // the planner has been there: the linear axes can
  return machine_->joints(words.head<3>(), Q, p.p_ST).value_or(Q_near);
}

// Distance of a point from one piece, in its coordinates, and the length of the piece (m).
// @param least  a distance known already: a curve that lies farther away is not looked at
double ProgramPath::distance(const Eigen::Vector3d& point, std::size_t index, double least,
                             double& length) const {
  const auto from = [&](const MoveCurve& curve) {
    length = curve.length();
    return (curve.at(curve.closest(point)).head<3>() - point).norm();
  };
  const std::uint32_t curved = pieces_[index].curved;
  if (curved == kStraight) return from(curve_of(index));
  const Curved& here = curved_[curved];
  length = here.curve.length();
  const double at_least = (point - here.middle).norm() - here.reach;
  return at_least > least ? at_least : from(here.curve);
}

double ProgramPath::distance(const Eigen::Vector3d& point, std::size_t index) const {
  double gone = 0.0, length = 0.0;
  double best = distance(point, index, std::numeric_limits<double>::infinity(), length);
  const double reach = best + kSearchMargin;
  const auto look_at = [&](std::size_t i) {
    const double there = distance(point, i, best, length);
    if (is_tip(i) == is_tip(index)) best = std::min(best, there);
    gone += length;
  };
  for (std::size_t i = index; i + 1 < pieces_.size() && gone < reach; ++i) look_at(i + 1);
  gone = 0.0;
  for (std::size_t i = index; i > 0 && gone < reach; --i) look_at(i - 1);
  return best;
}

}  // namespace servomill::sim::engine
