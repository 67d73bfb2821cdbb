#include "sim/uncorrected.h"

#include <algorithm>
#include <cmath>

#include "plant/kinematics/inverse.h"
#include "plant/vocabulary/units.h"
#include "strategies/pose_compensation.h"

namespace servomill::sim {
namespace {

constexpr double kStep = 1.0 * deg;   // of the rotary axis that turns most
constexpr double kMostLooks = 360.0;  // of a line

int looks_of(const ProgramPath::Piece& piece) {
  const double turn = (piece.end - piece.begin).tail<3>().cwiseAbs().maxCoeff();
  return static_cast<int>(std::clamp(std::ceil(turn / kStep), 1.0, kMostLooks));
}

bool is_worse(const Uncorrected& a, const Uncorrected& b) {
  const bool by_axis = std::max(a.axis, b.axis) > kUncorrectedAxis;
  return by_axis ? a.axis > b.axis : a.tip > b.tip;
}

}  // namespace

std::optional<Uncorrected> uncorrected(const ProgramPath& path, const strategies::Belief& belief,
                                       strategies::Iterations iterations, double sigma_0) {
  const strategies::PoseCompensation compensation(belief, iterations, sigma_0);
  const plant::InverseKinematics inverse(belief.model.chain());
  Uncorrected worst;
  for (std::size_t n = 0; n < path.size(); ++n) {
    const ProgramPath::Piece& piece = path.piece(n);
    if (piece.rapid) continue;

    const int looks = looks_of(piece);
    for (int i = 1; i <= looks; ++i) {
      const double share = static_cast<double>(i) / looks;
      const AxisWords near = piece.begin + share * (piece.end - piece.begin);
      const Joints Q = path.joints(n, piece.s_begin + share * (piece.s_end - piece.s_begin),
                                   belief.layout, belief.layout.joints(near));
      const auto left =
          compensation.leftover(Q, compensation.of_set_point(strategies::Sign::correct, Q));
      const Uncorrected here = {
          piece.line, left.tip, left.axis,
          inverse.distance_from_singular(plant::forward(inverse.chain(), Q, belief.p_ST).k_W)};
      if (is_worse(here, worst)) worst = here;
    }
  }
  if (worst.tip <= kUncorrectedTip && worst.axis <= kUncorrectedAxis) return std::nullopt;
  return worst;
}

}  // namespace servomill::sim
