/// One feed drive: current, motor with screw, transmission, slide. Its equations, for the exact
/// propagator (drive_bank.h) and for SUNDIALS (cvode_drive.h) alike.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "plant/drives/drive_state.h"
#include "plant/drives/friction.h"

namespace servomill::plant {

enum class DriveKind : std::uint8_t {
  two_mass,  // motor and slide with a spring and damper between them
  rigid,     // one inertia
  direct,    // one inertia, torque or linear motor: r = 1, may cog
};

/// Torque ripple of a motor: T sin(n phi + phase), against +phi.
struct Cogging {
  double T = 0.0;      // N m
  double n = 0.0;      // periods per radian of the motor angle
  double phase = 0.0;  // rad
  bool operator==(const Cogging&) const = default;
};

/// Bed of the machine on its mounts, which the reaction of a drive pushes back along the axis.
struct MachineBed {
  double M = 0.0;  // kg, what moves with the bed along the axis, the slide left out; 0: held still
  double w = 0.0;  // rad/s, undamped natural frequency while the slide is held on the bed
  double zeta = 0.0;  // damping ratio, the same
  bool operator==(const MachineBed&) const = default;
};

/// m, rad; of the reference problem to 0.0004 nm after 10 s.
inline constexpr double kSolverTolerance = 2e-12;

/// Constant description of one feed drive. For a rotary axis read rad for m, N m for N, kg m^2 for
/// kg; a direct drive has r = 1.
///
///            i_cmd          tau = Kt i           r phi - x
///     o---[1/(T_i s + 1)]---(J, b_motor)---r---[k, c, gap]---(M, b_load)--- x
///                              phi                                 ^ F_load, friction
///
/// With a winding (L > 0) the input is the voltage u instead: L di/dt = u - R i - Ke w.
///
/// On a bed x counts from the bed, as the scale reads it, and the slide moves by x + b in space:
///
///     M (x'' + b'') = F_x,   (M + M_bed)(b'' + 2 zeta w b' + w^2 b) = -M x''
///
/// (rigid: (M + J/r^2) x'' + M b'' = F_x, of a linear motor with M + J for M).
/// F_x is the sum of the forces between slide and bed; that of the cut is one of them, since it
/// acts between two bodies of the machine. b counts from where weights leave the bed. From F_x to x
/// there is a zero at w and a pole above it; with mu = M M_bed / (M + M_bed)
///
///     (s^2 + 2 zeta w s + w^2) / (mu s^2 (s^2 + (M + M_bed)/M_bed (2 zeta w s + w^2)))
struct FeedDriveParams {
  DriveKind kind = DriveKind::two_mass;
  double r = 1.0;        // m/rad, slide travel per motor angle: lead / (2 pi)
  double J = 0.0;        // kg m^2, motor and screw
  double M = 0.0;        // kg, slide with everything it carries
  double k = 0.0;        // N/m, between screw and slide (two_mass)
  double c = 0.0;        // N s/m, the same (two_mass)
  double gap = 0.0;      // m, backlash between screw and slide (two_mass)
  double b_motor = 0.0;  // N m s/rad, viscous friction of the motor
  double b_load = 0.0;   // N s/m, viscous friction of the slide
  double Kt = 1.0;       // N m/A, torque constant
  double i_max = 0.0;    // A, limit of the current command
  double T_i = 0.0;      // s, closed current loop as first-order lag; 0: none
  double L = 0.0;        // H, winding; 0: there is none, T_i counts
  double R = 0.0;        // ohm
  double Ke = 0.0;       // V s/rad
  double F_load = 0.0;   // N, constant force on the slide, counted against +x: weight less
                         // counterbalance
  FrictionParams friction;
  Cogging cogging;  // of a direct drive
  MachineBed bed;   // of a linear axis
  // m: what a sub-step of a drive that is not linear may add to the error of the position
  double solver_tolerance = kSolverTolerance;

  bool operator==(const FeedDriveParams&) const = default;
  bool has_winding() const { return L > 0.0; }
  /// True if the current is the command itself, without lag or winding.
  bool current_is_command() const { return !has_winding() && T_i <= 0.0; }
  bool is_rigid() const { return kind != DriveKind::two_mass; }
  /// Inertia that the motor sees (kg m^2): J + M r^2.
  double J_total() const { return J + M * r * r; }
  bool on_bed() const { return bed.M > 0.0; }
  /// Mass that moves along the axis (kg): M, and the primary part of a linear motor.
  double travelling_mass() const { return kind == DriveKind::direct ? M + J : M; }
  /// Share of the travelling mass in all that moves once the bed does.
  double bed_share() const { return travelling_mass() / (travelling_mass() + bed.M); }
  /// Mass that a force on the slide accelerates at once (kg), against the bed.
  double slide_mass() const {
    const double all = is_rigid() ? M + J / (r * r) : M;
    return on_bed() ? all - bed_share() * travelling_mass() : all;
  }
  /// True if the equations are linear: no friction but viscous, no gap, no cogging.
  bool is_linear() const {
    return friction.kind == FrictionKind::none && gap == 0.0 && cogging.T == 0.0;
  }
};

/// dx/dt = A x + B (command, F) of one drive, states (i, w, delta, v, x); columns 5 and 6 hold B.
/// The linear part: F holds all forces against the slide (load, friction, cogging).
/// @param sticking  the slide is held: dv/dt = 0
/// @param gap       screw and slide do not touch: no force between them. In contact, delta counts
///                  from where they touch: contact_offset() less than that of the state.
Eigen::Matrix<double, 5, 7> drive_equations(const FeedDriveParams& params, bool sticking = false,
                                            bool gap = false);

/// The same on a bed, states (i, w, delta, v, b, db/dt, x); columns 7 and 8 hold B.
Eigen::Matrix<double, 7, 9> drive_equations_on_bed(const FeedDriveParams& params,
                                                   bool sticking = false, bool gap = false);

/// Force of a bed that is off its rest on the slide (N): what M x'' is but for forces on the slide.
double bed_force(const FeedDriveParams& params, const LaneState& state);

/// delta at which the flanks touch (m): gap/2, -gap/2, and 0 within the gap.
double contact_offset(const FeedDriveParams& params, ContactMode contact);

/// Force of the screw on the slide (N): k (delta - offset) + c d(delta)/dt in contact, else 0. The
/// flanks push and never pull: contact ends where this changes sign.
double screw_force(const FeedDriveParams& params, const LaneState& state);

/// Force with which one flank would push the slide if screw and slide touched there (N), positive
/// towards +x: contact holds while it points away from the flank.
double flank_force(const FeedDriveParams& params, const LaneState& state, ContactMode flank);

/// Contact in which this state goes on. A flank that would have to pull lets go. From the gap a
/// flank takes hold where its spring is compressed (delta beyond gap/2) and it would push. A spring
/// that was still compressed when its damper made the flank let go relaxes by itself: delta may lie
/// outside the gap for a while.
ContactMode contact_after(const FeedDriveParams& params, const LaneState& state);

/// Sum of the forces on the slide but for set-valued, regularised or LuGre friction (N): what a
/// sticking slide must bear. Viscous friction and bed_force() included; of a rigid drive the
/// motor's force, too, for which state.i must be the command where current_is_command().
/// @param F  N, external force against the slide, in addition to F_load
double driving_force(const FeedDriveParams& params, const LaneState& state, double F);

/// Acceleration of the slide (m/s^2) by all forces on it.
/// @param command  A; counts where current_is_command()
/// @param F        N, external force against the slide, in addition to F_load
double slide_acceleration(const FeedDriveParams& params, const LaneState& state, double command,
                          double F);

/// Cogging as a force against the slide at x (N): T/r sin(n x / r + phase).
double cogging_force(const FeedDriveParams& params, double x);

/// Way in which a slide at v = 0 goes on under this driving force: sticking within the breakaway
/// forces, else in the direction of the force.
SlideMode slide_from_rest(const FrictionParams& friction, double driving_force);

/// At rest at x, holding the constant load: current and wind-up in equilibrium, friction unloaded.
LaneState at_rest(const FeedDriveParams& params, double x);

/// Rules of physics that the values break, each as "KEY RULE" in SI ("Fs must be >= Fc").
/// Empty for a possible drive.
std::vector<std::string> implausible(const FeedDriveParams& params);

}  // namespace servomill::plant
