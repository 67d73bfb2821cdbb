#include "plant/drives/feed_drive.h"

#include <cmath>

namespace servomill::plant {
namespace {

enum State : int { kCurrent, kSpeed, kWindUp, kVelocity, kPosition };
enum Input : int { kCommand = 5, kForce = 6 };

// Within the gap neither spring nor damper acts: motor and slide are two free masses.
Eigen::Matrix<double, 5, 7> two_mass_equations(const FeedDriveParams& p, bool gap) {
  const double k = gap ? 0.0 : p.k, c = gap ? 0.0 : p.c;
  Eigen::Matrix<double, 5, 7> A = Eigen::Matrix<double, 5, 7>::Zero();
  // J dw/dt = Kt i - r F_s - b_motor w,   F_s = k delta + c d(delta)/dt,   d(delta)/dt = r w - v
  A(kSpeed, kCurrent) = p.Kt / p.J;
  A(kSpeed, kSpeed) = -(p.b_motor + p.r * p.r * c) / p.J;
  A(kSpeed, kWindUp) = -p.r * k / p.J;
  A(kSpeed, kVelocity) = p.r * c / p.J;
  A(kWindUp, kSpeed) = p.r;
  A(kWindUp, kVelocity) = -1.0;
  // M dv/dt = F_s - b_load v - F
  const double M = p.slide_mass();
  A(kVelocity, kSpeed) = p.r * c / M;
  A(kVelocity, kWindUp) = k / M;
  A(kVelocity, kVelocity) = -(c + p.b_load) / M;
  A(kVelocity, kForce) = -1.0 / M;
  return A;
}

// The speed of the motor stays a state, tied to that of the slide, so that all kinds of drives
// share one layout of five states.
Eigen::Matrix<double, 5, 7> rigid_equations(const FeedDriveParams& p) {
  Eigen::Matrix<double, 5, 7> A = Eigen::Matrix<double, 5, 7>::Zero();
  // (M + J / r^2) dv/dt = Kt i / r - (b_load + b_motor / r^2) v - F,   w = v / r
  A(kVelocity, kCurrent) = p.Kt / p.r / p.slide_mass();
  A(kVelocity, kVelocity) = -(p.b_load + p.b_motor / (p.r * p.r)) / p.slide_mass();
  A(kVelocity, kForce) = -1.0 / p.slide_mass();
  A.row(kSpeed) = A.row(kVelocity) / p.r;
  return A;
}

}  // namespace

Eigen::Matrix<double, 5, 7> drive_equations(const FeedDriveParams& p, bool sticking, bool gap) {
  Eigen::Matrix<double, 5, 7> A = p.is_rigid() ? rigid_equations(p) : two_mass_equations(p, gap);
  A(kPosition, kVelocity) = 1.0;
  // Motor and wind-up go on moving against the slide that is held: presliding by the elasticity of
  // the screw.
  if (sticking) {
    A.row(kVelocity).setZero();
    A.row(kPosition).setZero();
    if (p.is_rigid()) A.row(kSpeed).setZero();
  }
  if (p.has_winding()) {
    A(kCurrent, kCurrent) = -p.R / p.L;
    A(kCurrent, kSpeed) = -p.Ke / p.L;
    A(kCurrent, kCommand) = 1.0 / p.L;
  } else if (p.current_is_command()) {
    // T_i = 0: the current has no dynamics; what it acts on the command acts on directly
    A.col(kCommand) = A.col(kCurrent);
    A.col(kCurrent).setZero();
  } else {
    A(kCurrent, kCurrent) = -1.0 / p.T_i;
    A(kCurrent, kCommand) = 1.0 / p.T_i;
  }
  return A;
}

Eigen::Matrix<double, 7, 9> drive_equations_on_bed(const FeedDriveParams& p, bool sticking,
                                                   bool gap) {
  enum Row : int { kBed = 4, kBedSpeed = 5, kWay = 6 };
  const Eigen::Matrix<double, 5, 7> drive = drive_equations(p, sticking, gap);
  const double stiffness = p.bed.w * p.bed.w, damping = 2.0 * p.bed.zeta * p.bed.w;
  Eigen::Matrix<double, 7, 9> A = Eigen::Matrix<double, 7, 9>::Zero();
  A.topLeftCorner<4, 4>() = drive.topLeftCorner<4, 4>();
  A.topRightCorner<4, 2>() = drive.topRightCorner<4, 2>();
  // The position is the last state, behind those of the bed: no other one depends on it.
  A(kWay, kVelocity) = drive(kPosition, kVelocity);
  if (!sticking) {
    A(kVelocity, kBed) = p.travelling_mass() * stiffness / p.slide_mass();
    A(kVelocity, kBedSpeed) = p.travelling_mass() * damping / p.slide_mass();
    if (p.is_rigid()) A.row(kSpeed).segment<2>(kBed) = A.row(kVelocity).segment<2>(kBed) / p.r;
  }
  // b'' = -2 zeta w b' - w^2 b - share x''
  // The slide is accelerated against the bed; the row above already has the reaction of the bed, so
  // that x'' is eliminated here.
  A.row(kBedSpeed) = -p.bed_share() * A.row(kVelocity);
  A(kBedSpeed, kBed) -= stiffness;
  A(kBedSpeed, kBedSpeed) -= damping;
  A(kBed, kBedSpeed) = 1.0;
  return A;
}

double bed_force(const FeedDriveParams& p, const LaneState& s) {
  if (!p.on_bed()) return 0.0;
  return p.travelling_mass() * (2.0 * p.bed.zeta * p.bed.w * s.bed_v + p.bed.w * p.bed.w * s.bed_x);
}

double contact_offset(const FeedDriveParams& p, ContactMode contact) {
  switch (contact) {
    case ContactMode::positive:
      return 0.5 * p.gap;
    case ContactMode::negative:
      return -0.5 * p.gap;
    case ContactMode::gap:
      break;
  }
  return 0.0;
}

double flank_force(const FeedDriveParams& p, const LaneState& s, ContactMode flank) {
  return p.k * (s.delta - contact_offset(p, flank)) + p.c * (p.r * s.w - s.v);
}

double screw_force(const FeedDriveParams& p, const LaneState& s) {
  if (p.is_rigid() || s.contact == ContactMode::gap) return 0.0;
  return flank_force(p, s, s.contact);
}

ContactMode contact_after(const FeedDriveParams& p, const LaneState& s) {
  const auto pushes = [&](ContactMode flank, double away) {
    const double S = away * flank_force(p, s, flank);
    // A force of exactly 0 occurs at the instant of touching (undamped spring): the approach
    // decides then.
    return S > 0.0 || (S == 0.0 && away * (p.r * s.w - s.v) > 0.0);
  };
  switch (s.contact) {
    case ContactMode::positive:
      return pushes(s.contact, 1.0) ? s.contact : ContactMode::gap;
    case ContactMode::negative:
      return pushes(s.contact, -1.0) ? s.contact : ContactMode::gap;
    case ContactMode::gap:
      break;
  }
  if (s.delta >= 0.5 * p.gap && pushes(ContactMode::positive, 1.0)) return ContactMode::positive;
  if (s.delta <= -0.5 * p.gap && pushes(ContactMode::negative, -1.0)) return ContactMode::negative;
  return ContactMode::gap;
}

double driving_force(const FeedDriveParams& p, const LaneState& s, double F) {
  double against = p.F_load + F + cogging_force(p, s.x) + p.b_load * s.v;
  if (p.on_bed()) against -= bed_force(p, s);
  if (p.is_rigid()) return (p.Kt * s.i - p.b_motor * s.w) / p.r - against;
  return screw_force(p, s) - against;
}

double slide_acceleration(const FeedDriveParams& p, const LaneState& state, double command,
                          double F) {
  LaneState s = state;
  if (p.current_is_command()) s.i = command;
  const double force = driving_force(p, s, F);
  const FrictionParams& f = p.friction;
  const auto of_slide = [&](double friction) { return (force - friction) / p.slide_mass(); };
  switch (f.kind) {
    case FrictionKind::none:
      break;
    case FrictionKind::set_valued:
      if (s.slide == SlideMode::sticking) return 0.0;
      return of_slide(s.slide == SlideMode::positive ? sliding_force(f, true, s.v)
                                                     : -sliding_force(f, false, s.v));
    case FrictionKind::regularised:
      return of_slide(regularised_force(f, s.v));
    case FrictionKind::lugre:
      return of_slide(bristle_force(f, s.v, s.z));
  }
  return of_slide(0.0);
}

double cogging_force(const FeedDriveParams& p, double x) {
  if (p.cogging.T == 0.0) return 0.0;
  return p.cogging.T / p.r * std::sin(p.cogging.n * x / p.r + p.cogging.phase);
}

SlideMode slide_from_rest(const FrictionParams& friction, double force) {
  if (force > friction.Fs_positive) return SlideMode::positive;
  if (force < -friction.Fs_negative) return SlideMode::negative;
  return SlideMode::sticking;
}

LaneState at_rest(const FeedDriveParams& p, double x) {
  LaneState s;
  s.x = x;
  // The flank that carries the load is closed; without a load the positive one, as after a move in
  // that direction.
  const double load = p.F_load + cogging_force(p, x);
  s.i = p.r * load / p.Kt;
  if (p.is_rigid()) return s;
  s.contact = load < 0.0 ? ContactMode::negative : ContactMode::positive;
  s.delta = load / p.k + contact_offset(p, s.contact);
  return s;
}

std::vector<std::string> implausible(const FeedDriveParams& p) {
  std::vector<std::string> faults;
  const auto demand = [&](bool holds, const char* rule) {
    if (!holds) faults.emplace_back(rule);
  };
  demand(p.r > 0.0, "r must be > 0");
  demand(p.J > 0.0, "J must be > 0");
  demand(p.M > 0.0, "M must be > 0");
  demand(p.is_rigid() || p.k > 0.0, "k must be > 0");
  demand(p.c >= 0.0, "c must be >= 0");
  demand(p.gap >= 0.0, "gap must be >= 0");
  demand(p.gap == 0.0 || !p.is_rigid(), "gap needs a two-mass drive");
  demand(p.b_motor >= 0.0, "b_motor must be >= 0");
  demand(p.b_load >= 0.0, "b_load must be >= 0");
  demand(p.bed.M >= 0.0, "bed.M must be >= 0");
  demand(p.bed.w >= 0.0, "bed.w must be >= 0");
  demand(p.bed.zeta >= 0.0 && p.bed.zeta < 1.0, "bed.zeta must be >= 0 and < 1");
  demand(p.cogging.T == 0.0 || p.kind == DriveKind::direct, "cogging needs a direct drive");
  const FrictionParams& f = p.friction;
  if (f.kind == FrictionKind::none) return faults;
  demand(f.Fc_positive >= 0.0 && f.Fc_negative >= 0.0, "Fc must be >= 0");
  demand(f.Fs_positive >= 0.0 && f.Fs_negative >= 0.0, "Fs must be >= 0");
  demand(f.b_positive >= 0.0 && f.b_negative >= 0.0, "b of a direction must be >= 0");
  demand(f.vs > 0.0, "vs must be > 0");
  demand(f.kind != FrictionKind::regularised || f.v0 > 0.0, "v0 must be > 0");
  demand(f.kind != FrictionKind::lugre || f.sigma0 > 0.0, "sigma0 must be > 0");
  demand(f.kind != FrictionKind::lugre || f.sigma1 >= 0.0, "sigma1 must be >= 0");
  demand(f.kind != FrictionKind::lugre || least_force(f) > 0.0, "Fc and Fs must be > 0 (LuGre)");
  return faults;
}

}  // namespace servomill::plant
