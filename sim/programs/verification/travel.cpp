#include "sim/programs/verification/travel.h"

#include <cmath>
#include <numbers>

#include "plant/vocabulary/arc_sweep.h"

namespace servomill::sim::programs {
namespace {

constexpr double kStill = 1e-12;    // m, rad: what rounding leaves of positions
constexpr double kShortest = 1e-9;  // of an arc: shorter pieces are rounding

// Angles at which a coordinate of the circle turns: the first axis of the plane at 0 and pi, the
// second between them.
std::vector<double> turning_shares(const ArcSweep& arc, const std::array<bool, kAxisWords>& axes) {
  const double quarter = 0.5 * std::numbers::pi;
  std::vector<double> out = {0.0};
  const double from = arc.angle / quarter, to = (arc.angle + arc.sweep) / quarter;
  const double step = arc.sweep > 0.0 ? 1.0 : -1.0;
  double k = arc.sweep > 0.0 ? std::ceil(from) : std::floor(from);
  for (; step * (to - k) > 0.0; k += step) {
    const bool is_first_axis = std::fmod(std::abs(k), 2.0) < 0.5;
    const double share = (k - from) / (to - from);
    const bool turns = axes[static_cast<std::size_t>(is_first_axis ? arc.a : arc.b)];
    if (turns && share > kShortest && share < 1.0 - kShortest) out.push_back(share);
  }
  out.push_back(1.0);
  return out;
}

}  // namespace

std::vector<OriginalAction> pieces_of(const OriginalAction& action, const Correction& correction) {
  if (action.move.kind != MoveKind::arc || !correction.has_reversals()) return {action};
  const ArcSweep arc = arc_sweep(action.move, action.begin.head<3>());
  const std::vector<double> shares = turning_shares(arc, correction.reverses());
  if (shares.size() == 2) return {action};
  std::vector<OriginalAction> out;
  const AxisWords way = action.move.end_machine - action.begin;
  for (std::size_t i = 1; i < shares.size(); ++i) {
    OriginalAction piece = action;
    piece.begin = out.empty() ? action.begin : out.back().move.end_machine;
    if (shares[i] < 1.0) {
      piece.move.end_machine = action.begin + shares[i] * way;
      piece.move.end_machine.head<3>() = arc.point(shares[i]);
    }
    piece.move.arc.turns = arc.sweep > 0.0 ? 1 : -1;
    out.push_back(piece);
  }
  return out;
}

void turn(Directions& directions, const OriginalAction& piece) {
  AxisWords way = piece.move.end_machine - piece.begin;
  if (piece.move.kind == MoveKind::arc) {
    way.head<3>() = arc_sweep(piece.move, piece.begin.head<3>()).derivative(0.5);
  }
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const double length = way[static_cast<int>(i)];
    if (!piece.was_known[i]) directions[i] = 0;
    if (piece.was_known[i] && std::abs(length) > kStill) directions[i] = length > 0.0 ? 1 : -1;
  }
}

}  // namespace servomill::sim::programs
