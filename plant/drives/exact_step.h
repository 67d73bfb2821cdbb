/// One feed drive with friction, backlash or cogging, moved exactly but for a scalar force.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "plant/drives/collocation.h"
#include "plant/drives/feed_drive.h"
#include "plant/drives/gliding.h"
#include "plant/drives/propagator.h"
#include "plant/vocabulary/ticks.h"

namespace servomill::plant {

/// How finely the force against a slide is resolved.
struct Resolution {
  /// m: what one sub-step may add to the error of the position. Infinite: no error control.
  double tolerance = kSolverTolerance;
  /// s: no sub-step is longer
  double longest = std::numeric_limits<double>::infinity();
};

/// Propagator of one drive that is not linear or stands on a bed.
///
/// Between two events a drive is linear but for the force f against its slide (load, friction,
/// cogging). Over a sub-step of length h the force is a parabola through its values at 0, h/2, h,
///   y(t) = e^{At} y(0) + int_0^t e^{A(t-s)} (b u + b_F f(s)) ds,
/// exact for that f, and f = F(v, x, z) is demanded at the three nodes (collocation, Lobatto IIIA,
/// order 4, A-stable: no stiffness of friction makes it unstable). The matrices are prepared for a
/// ladder of lengths base_period 2^n. A sub-step is halved until
///   1. the defect of the parabola at h/4 and 3h/4 moves the slide by less than the tolerance,
///   2. nothing happens in it: the slide does not stop or break away (set-valued friction) or
///      reverse (LuGre: |v|), no flank takes hold or lets go (backlash).
/// A linear drive on a bed takes steps as long as the ladder has them: its force is constant.
/// In the finest sub-step the event is located by a secant and the drive goes on in its new mode.
/// Every event consumes at least that length, so that bouncing without end ends.
class ExactStep {
 public:
  /// @param base_period   s
  /// @param longest_step  ticks, the longest that `advance` will be asked for
  /// @pre unrepresentable(params, base_period) is empty
  ExactStep(const FeedDriveParams& params, double base_period, Tick longest_step,
            const Resolution& resolution = {});

  /// Moves the state by `step` ticks under a constant command (A, V) and force F against the slide
  /// (N, beside F_load). A sub-step that misses its tolerance at the finest length is counted in
  /// state.control.unresolved.
  void advance(LaneState& state, double command, double F, Tick step) const;

  const Gliding& gliding() const { return gliding_; }
  const Resolution& resolution() const { return resolution_; }
  /// Binary logarithm of its longest sub-step in base periods.
  int coarsest_log2() const {
    return static_cast<int>(linear_.front().ladder.size()) - 1 - sub_ticks_;
  }
  /// Largest last correction of Newton's iteration (m/s).
  double speed_tolerance() const { return speed_tolerance_; }
  /// True if friction is continuous at v = 0 and its slope is not.
  bool has_kink() const { return has_kink_; }

 private:
  static constexpr std::size_t kNodes = Propagator::kNodes, kNone = kNodes;
  // A linear mode with its propagators for the lengths finest_ 2^n.
  struct Linear {
    DriveEquations<5> A;
    std::vector<Propagator> ladder;
    // of a drive on a bed
    DriveEquations<7> on_bed;
    std::vector<BedPropagator> bed;
  };
  // The motion over a sub-step under a constant force.
  struct Held {
    // from i, w, delta, v, command, force, b, db/dt: to v, i, w, delta, x (an increment), b, db/dt
    static constexpr std::size_t kColumns = 8, kRows = 8;  // the last row fills up a register
    std::array<std::array<double, kRows>, kColumns> columns{};
  };
  struct Trial {
    std::array<LaneState, kNodes> at;  // h/4, h/2, 3h/4, h
    double error = 0.0;                // m; infinite if the collocation was not solved
    double f[3] = {}, dz[3] = {};      // force and dz/dt at 0, h/2, h
    std::size_t event = kNone;         // first node that belongs to another mode
    std::size_t kink = kNone;          // first node beyond a zero of v where friction has a kink
  };
  struct Rows;

  static double direction(SlideMode slide) { return slide == SlideMode::negative ? -1.0 : 1.0; }
  void prepare(bool sticking, bool gap, int coarsest);
  void prepare_held();
  void advance_held(LaneState& s, double command, double force, std::int64_t steps) const;
  bool sticks(const LaneState& s) const;
  const Linear& linear_of(const LaneState& s) const;
  void find_slide_mode(LaneState& s, double F) const;
  int lengthened(int wanted, int coarsest, double error) const;
  double friction_force(const LaneState& s) const;
  double force(const LaneState& s, double F) const;
  BristleForces<double> friction_at(const LaneState& s, double h, const double (&v)[2]) const;
  bool happens(const LaneState& s, double F) const;
  void from_rest(LaneState& s, double F) const;
  Trial attempt(const LaneState& s, double command, double F, std::size_t level) const;
  bool collocate(const LaneState& s, double F, double h, const Propagator& P, Rows& y,
                 Trial& trial) const;
  bool looks_within(const LaneState& s) const;
  static void move_bed(const BedPropagator& P, const double (&start)[5], const LaneState& s,
                       Trial& trial);
  double error_of(double F, double h, const Trial& trial) const;
  LaneState coast(const LaneState& s, double command, double F, double dt) const;
  double slide_event(const LaneState& s, const LaneState& end, double F) const;
  double contact_event(const LaneState& s, const LaneState& end) const;
  void cross(LaneState& s, double command, double F) const;

  Gliding gliding_;
  FeedDriveParams params_;
  Resolution resolution_;
  double finest_ = 0.0;                // s
  int sub_ticks_ = 0;                  // the finest sub-step is 2^-sub_ticks_ base periods
  double speed_tolerance_ = 0.0;       // m/s, of the last correction of Newton's iteration
  bool has_kink_ = false;              // friction is continuous at v = 0, its slope is not
  std::array<int, 4> linear_index_{};  // by 2 gap + sticking
  std::vector<Linear> linear_;
  std::vector<Held> held_;  // of a linear drive on a bed, for each length of the ladder
};

}  // namespace servomill::plant
