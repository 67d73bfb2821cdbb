#include "sim/run/residual_errors.h"

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/units.h"

namespace servomill::sim::run {
namespace {

constexpr double kWay = 5.0 * mm, kTurn = 1.0 * deg;  // between two looks, about
constexpr double kMaxOnALine = 360.0;
constexpr std::size_t kMax = 4000;  // in all: they shall take no time beside the run

std::size_t looks_of(const engine::ProgramPath::Piece& piece) {
  if (piece.rapid) return 0;
  const double turn = (piece.end - piece.begin).tail<3>().cwiseAbs().maxCoeff();
  const double looks = std::max((piece.s_end - piece.s_begin) / kWay, turn / kTurn);
  return static_cast<std::size_t>(std::clamp(std::ceil(looks), 1.0, kMaxOnALine));
}

bool is_worse(const strategies::Residual& a, const strategies::Residual& b) {
  const bool by_axis = std::max(a.axis, b.axis) > kUncorrected.axis;
  return by_axis ? a.axis > b.axis : a.tip > b.tip;
}

// Calls visit(piece, Q) at places of the feed motion, as long as it returns true.
template <class Visit>
void look_along(const engine::ProgramPath& path, const JointLayout& layout, Visit visit) {
  std::size_t total = 0;
  for (std::size_t n = 0; n < path.size(); ++n) total += looks_of(path.piece(n));
  const std::size_t stride = total / kMax + 1;
  std::size_t look = 0;
  for (std::size_t n = 0; n < path.size(); ++n) {
    const engine::ProgramPath::Piece piece = path.piece(n);
    const std::size_t looks = looks_of(piece);
    if (looks == 0) continue;
    const bool has_begin = n == 0 || path.is_rapid(n - 1);  // otherwise the end of the last one
    for (std::size_t i = has_begin ? 0 : 1; i <= looks; ++i) {
      if (look++ % stride != 0) continue;
      const double share = static_cast<double>(i) / static_cast<double>(looks);
      const AxisWords near = piece.begin + share * (piece.end - piece.begin);
      const Joints Q = path.joints(n, piece.s_begin + share * (piece.s_end - piece.s_begin), layout,
                                   layout.joints(near));
      if (!visit(piece, Q)) return;
    }
  }
}

}  // namespace

std::optional<ResidualErrors> residual_errors(const engine::ProgramPath& path,
                                              const strategies::Strategy& strategy,
                                              const plant::InverseKinematics& inverse,
                                              const Eigen::Vector3d& p_ST) {
  ResidualErrors worst;
  Joints worst_at = Joints::Zero();
  look_along(path, inverse.chain().layout,
             [&](const engine::ProgramPath::Piece& piece, const Joints& Q) {
               const auto left = strategy.uncorrectable(Q);
               if (!left) return false;
               if (is_worse(*left, worst.left)) {
                 worst = {piece.line, *left, 0.0};
                 worst_at = Q;
               }
               return true;
             });
  if (worst.left.tip <= kUncorrected.tip && worst.left.axis <= kUncorrected.axis) {
    return std::nullopt;
  }
  worst.singular_angle =
      inverse.distance_from_singular(plant::forward(inverse.chain(), worst_at, p_ST).k_W);
  return worst;
}

std::vector<LeftTable> left_tables(const engine::ProgramPath& path,
                                   const strategies::Strategy& strategy,
                                   const JointLayout& layout) {
  std::vector<LeftTable> out;
  look_along(path, layout, [&](const engine::ProgramPath::Piece& piece, const Joints& Q) {
    for (const strategies::BeyondTable& end : strategy.beyond_tables(Q)) {
      const double q = Q[end.joint];
      auto known = std::find_if(out.begin(), out.end(), [&](const LeftTable& one) {
        return one.table.joint == end.joint && one.table.end == end.end;
      });
      if (known == out.end()) known = out.insert(known, {piece.line, end, q});
      if (std::abs(q - end.end) > std::abs(known->farthest - end.end)) known->farthest = q;
    }
    return true;
  });
  return out;
}

}  // namespace servomill::sim::run
