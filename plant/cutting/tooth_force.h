/// Force on the single teeth of a milling cutter as it turns: chips of teeth that run out, mean
/// over a small rotation. Frame, angles and forces are those of cutting_force.h.
///
/// Chip of tooth j behind a cutter that feeds evenly: it removes what the teeth before it have left
/// at its angle. Tooth j + m passed there m tooth passages earlier, from a centre m c farther back:
///
///     h_j = max(0, min over m = 1 .. N of  m c (f . n) + (R_j - R_{j+m}) sin(kappa))           (1)
///
/// A tooth that cuts nothing leaves its chip to the next one; over all teeth the mean chip at an
/// angle is c (f . n) whatever the run-out. Source: W. A. Kline, R. E. DeVor, The effect of runout
/// on cutting geometry and forces in end milling, Int. J. Mach. Tool Des. Res. 23 (1983).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "plant/cutting/cutting_force.h"

namespace servomill::plant {

/// A piece of each edge and the range of phi in which it cuts.
struct EdgeSlice {
  double from = 0.0, to = 0.0;  // rad, within contact_range()
  double width = 0.0;           // m, db
  // rad, by which its lower end is behind the tip of its tooth and its upper end behind the lower:
  // helix
  double lag = 0.0, lag_span = 0.0;
  double sine = 1.0, cosine = 0.0;   // of kappa
  double across = 1.0, along = 0.0;  // h = c (across sin(phi) - along), without run-out
};

/// Slices of the engaged arcs of a cutter: a straight flank with its helix, as far as it is engaged
/// at the same angles; other arcs each at the angle of its middle. The sum of their widths is that
/// of the arcs.
std::vector<EdgeSlice> edge_slices(const Cutter& cutter, const FeedDirection& feed,
                                   std::span<const EngagedArc> arcs);

/// Chips of the teeth of one cutter, (1) as a function of the nominal chip x = c (f . n): on each
/// tooth concave, growing and linear from piece to piece.
class ToothChips {
 public:
  explicit ToothChips(const Cutter& cutter);

  int teeth() const { return static_cast<int>(teeth_.size()); }

  /// Chip thickness (m) of a tooth.
  /// @param x  m, nominal chip over sin(kappa)
  double at(int tooth, double x) const;

  /// Line that (1) follows from x on: slope x + offset.
  struct Piece {
    double x = 0.0, slope = 1.0, offset = 0.0;  // m, 1, m
  };
  /// Pieces of a tooth, x rising; below the first it cuts nothing.
  const std::vector<Piece>& pieces(int tooth) const {
    return teeth_[static_cast<std::size_t>(tooth)];
  }

 private:
  std::vector<std::vector<Piece>> teeth_;
};

/// Mean of the force on all teeth while the cutter turns from theta by dtheta: the integral over
/// angle and helix in closed form, so that intervals that make up a turn have the mean force of the
/// turn, exactly. Neither allocates nor throws.
/// @param theta   rad, phi of the tip of tooth 0; any
/// @param dtheta  rad, 0 < dtheta <= 2 pi
/// @param c       m, feed per tooth
/// @return N, along e1, e2, k
Eigen::Vector3d mean_tooth_force(const CuttingCoefficients& K, const ToothChips& chips,
                                 std::span<const EdgeSlice> slices, double theta, double dtheta,
                                 double c, double wear = 1.0);

}  // namespace servomill::plant
