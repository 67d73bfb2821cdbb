#include "sim/program_path.h"

#include <algorithm>
#include <cassert>

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

ProgramPath::ProgramPath(std::span<const Move> moves, const AxisWords& start) {
  AxisWords at = start;
  int section = 0;
  for (const Move& move : moves) {
    if (move.kind == MoveKind::message) section = index_of_section(sections_, move.text);
    if (!is_motion(move.kind)) continue;
    pieces_.push_back({MoveCurve(at, move), move.end_machine, move.s_begin, move.s_end, move.line,
                       move.tool_offset, move.kind == MoveKind::rapid, section});
    at = move.end_machine;
  }
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

double ProgramPath::distance(const Eigen::Vector3d& point, std::size_t index) const {
  const auto to_piece = [&](const Piece& p) {
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
