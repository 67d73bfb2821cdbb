/// Memory of the directions in which an axis travelled: the state of hysteresis.
///
/// The memory follows the axis with play, as the far side of a gap would:
///
///     z <- min(max(z, q - d/2), q + d/2)         d: distance that a reversal takes
///     u = (q - z) / (d/2), in [-1, 1]            1: travels up, -1: travels down
///     direction(u) = u (3 - u^2) / 2
///
/// After d of travel one way the direction is 1 or -1 exactly; a reversal takes d of travel and has
/// no jump, and its slope over the travel is 0 at both ends. The state depends on the turning
/// points only, not on speed, nor on how often it is asked between them; smaller motions than d to
/// and fro move it within. An axis that has not moved yet stands in the middle, on the mean.
/// Source of the play: Krasnosel'skii, Pokrovskii, Systems with Hysteresis, Springer 1989, part 1.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "plant/vocabulary/axes.h"

namespace servomill::plant {

/// Reversals that change together: of one axis, over one distance.
struct Play {
  int joint = 0;          // place in Joints
  double distance = 1.0;  // m or rad, > 0
  bool operator==(const Play&) const = default;
};

/// direction(u). @pre u in [-1, 1]
constexpr double direction_of(double u) { return 0.5 * u * (3.0 - u * u); }

class ReversalMemory {
 public:
  ReversalMemory() = default;
  /// The axes have stood at Q for ever. @param plays  of VolumetricModel::plays(); copied
  ReversalMemory(std::span<const Play> plays, const Joints& Q);

  bool empty() const { return plays_.empty(); }
  std::size_t size() const { return plays_.size(); }

  /// The axes have gone straight to Q.
  void travel(const Joints& Q);

  /// Directions (-1 to 1) once the axes have gone straight to Q, without remembering it.
  /// @param out  one for each play
  void directions(const Joints& Q, std::span<double> out) const;

 private:
  double middle_at(std::size_t n, double q) const;

  std::vector<Play> plays_;
  std::vector<double> middle_;  // z
};

}  // namespace servomill::plant
