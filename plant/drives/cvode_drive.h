/// One feed drive integrated by SUNDIALS CVODE: the reference that the exact propagator is held to,
/// and the integrator of a scenario that asks for it.
#pragma once

#include <memory>

#include "plant/drives/feed_drive.h"

namespace servomill::plant {

/// How closely CVODE solves: the local error of each state stays below rtol |y| + atol.
struct CvodeTolerances {
  double relative = 1e-12;
  double i = 1e-14;      // A
  double w = 1e-14;      // rad/s
  double delta = 1e-19;  // m
  double v = 1e-16;      // m/s
  double x = 1e-18;      // m, of the way within one call of advance()
  double z = 1e-19;      // m

  /// All of them, `factor` times.
  CvodeTolerances times(double factor) const;
};

/// Integrates the equations of feed_drive.h and friction.h as they stand, in pieces within which
/// they are smooth. The pieces meet where one of these falls through zero, which CVODE finds:
///
///     set-valued friction  sliding   +-v                     slide := slide_from_rest, v := 0
///                          sticking  Fs_+ - F_d, Fs_- + F_d  the slide breaks away
///     other friction       +-v                               |v| and g(v) have their kink there
///     backlash             contact   +-F_s                   the flanks part: they do not pull
///                          gap       gap/2 -+ delta          the flanks meet
///                          beyond    -+(k d + c dd/dt)       a flank still spread is caught up
///
/// F_d is driving_force(), F_s screw_force(), d = delta -+ gap/2. While a slide sticks, v and x are
/// not integrated but kept. Adams formulas up to order 12, Newton iteration with a dense solver.
///
/// Every crossing is looked for a little beyond zero, by kSpeedGuard or kForceGuard, so that a
/// state that stands on zero neither loses its crossing nor finds it twice.
class CvodeDrive {
 public:
  static constexpr double kSpeedGuard = 1e-15;  // m/s or rad/s
  static constexpr double kForceGuard = 1e-9;   // N or N m; times 1/k: a wind-up of 1e-17 m
  static constexpr int kMaxEvents = 10000;      // in one call of advance()

  /// @pre implausible(params) is empty
  /// @throws std::runtime_error if SUNDIALS cannot be set up
  explicit CvodeDrive(const FeedDriveParams& params, const CvodeTolerances& tolerances = {});
  ~CvodeDrive();
  CvodeDrive(CvodeDrive&&) noexcept;
  CvodeDrive& operator=(CvodeDrive&&) noexcept;

  /// Moves the state by `duration` (s) under inputs that are held. A mode that does not fit the
  /// state (a slide that moves and is said to stick, flanks that would pull) is put right first.
  /// A drive without lag and winding takes the command for its current.
  /// @param command  A; V for a drive with a winding
  /// @param F        N, force against the slide beside the constant F_load
  /// @throws std::runtime_error if CVODE fails (with its own words), or after kMaxEvents
  void advance(LaneState& state, double command, double F, double duration);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace servomill::plant
