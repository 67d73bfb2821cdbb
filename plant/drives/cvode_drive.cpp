#include "plant/drives/cvode_drive.h"

#include <cvode/cvode.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <array>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

namespace servomill::plant {
namespace {

// Unknowns that CVODE integrates; the travel counts from the start of a piece.
// The bed has unknowns only where there is one: CVODE's error norm depends on their number.
enum Unknown : int { kCurrent, kSpeed, kWindUp, kVelocity, kWay, kBristle, kBed, kBedSpeed };
int unknowns_of(const FeedDriveParams& p) { return p.on_bed() ? kBedSpeed + 1 : kBristle + 1; }

// Events that may end a piece: each function is positive until its event.
enum Event : int {
  kStops,
  kBreaksPositive,
  kBreaksNegative,
  kParts,
  kMeetsPositive,
  kMeetsNegative,
  kCaughtPositive,
  kCaughtNegative,
  kEvents
};
using Events = std::array<int, kEvents>;
// Distance of an event that cannot occur in the present mode: any number that keeps its sign.
constexpr double kNotNow = 1.0;

template <auto kFree>
struct Freed {
  template <typename T>
  void operator()(T* handle) const {
    kFree(handle);
  }
};
struct FreedContext {
  void operator()(SUNContext context) const { SUNContext_Free(&context); }
};
struct FreedCvode {
  void operator()(void* memory) const { CVodeFree(&memory); }
};
using Context = std::unique_ptr<std::remove_pointer_t<SUNContext>, FreedContext>;
using Vector = std::unique_ptr<std::remove_pointer_t<N_Vector>, Freed<N_VDestroy>>;
using Matrix = std::unique_ptr<std::remove_pointer_t<SUNMatrix>, Freed<SUNMatDestroy>>;
using Solver = std::unique_ptr<std::remove_pointer_t<SUNLinearSolver>, Freed<SUNLinSolFree>>;
using Cvode = std::unique_ptr<void, FreedCvode>;

Context make_context() {
  SUNContext context = nullptr;
  if (SUNContext_Create(nullptr, &context) != 0) {
    throw std::runtime_error("SUNDIALS cannot create a context");
  }
  return Context(context);
}

std::string flag_name(int flag) {
  char* name = CVodeGetReturnFlagName(flag);
  std::string text = name == nullptr ? std::to_string(flag) : name;
  std::free(name);  // NOLINT: SUNDIALS takes it from malloc
  return text;
}

}  // namespace

struct CvodeDrive::Impl {
  Impl(const FeedDriveParams& params, const CvodeTolerances& tolerances);

  void settle(LaneState& s) const;
  double integrate(LaneState& s, double duration, Events& events);
  void take(const Events& events, LaneState& s) const;

  void begin(const LaneState& s);
  LaneState state_at(const double* y) const;
  double friction_force(double v, double z) const;
  void rates(const double* y, double* dy) const;
  void distances(const double* y, double* g) const;

  static int rates(double, N_Vector y, N_Vector dy, void* self) {
    static_cast<const Impl*>(self)->rates(N_VGetArrayPointer(y), N_VGetArrayPointer(dy));
    return 0;
  }
  static int distances(double, N_Vector y, double* g, void* self) {
    static_cast<const Impl*>(self)->distances(N_VGetArrayPointer(y), g);
    return 0;
  }
  static void keep_message(int, const char*, const char*, char* message, void* self) {
    static_cast<Impl*>(self)->message = message;
  }
  int checked(int flag, const char* call) const;

  FeedDriveParams p;

  // Held during one call of advance().
  double command = 0.0, F = 0.0;
  // Held during one piece.
  LaneState start;
  bool positive = true;  // the direction whose friction counts
  Eigen::Matrix<double, 5, 7> A;
  Eigen::Matrix<double, 7, 9> on_bed;

  Context context;
  Vector y;
  Matrix jacobian;
  Solver solver;
  Cvode cvode;
  std::string message;
};

CvodeDrive::Impl::Impl(const FeedDriveParams& params, const CvodeTolerances& tolerances)
    : p(params),
      context(make_context()),
      y(N_VNew_Serial(unknowns_of(p), context.get())),
      jacobian(SUNDenseMatrix(unknowns_of(p), unknowns_of(p), context.get())),
      solver(SUNLinSol_Dense(y.get(), jacobian.get(), context.get())),
      cvode(CVodeCreate(CV_ADAMS, context.get())) {
  if (!y || !jacobian || !solver || !cvode) throw std::runtime_error("SUNDIALS is out of memory");
  const Vector absolute(N_VNew_Serial(unknowns_of(p), context.get()));
  double* atol = N_VGetArrayPointer(absolute.get());
  atol[kCurrent] = tolerances.i;
  atol[kSpeed] = tolerances.w;
  atol[kWindUp] = tolerances.delta;
  atol[kVelocity] = tolerances.v;
  atol[kWay] = tolerances.x;
  atol[kBristle] = tolerances.z;
  if (p.on_bed()) {
    atol[kBed] = tolerances.x;
    atol[kBedSpeed] = tolerances.v;
  }
  N_VConst(0.0, y.get());

  void* const memory = cvode.get();
  Events falling;
  falling.fill(-1);
  constexpr long kMaxSteps = 10'000'000;
  checked(CVodeSetErrHandlerFn(memory, keep_message, this), "CVodeSetErrHandlerFn");
  checked(CVodeInit(memory, rates, 0.0, y.get()), "CVodeInit");
  checked(CVodeSetUserData(memory, this), "CVodeSetUserData");
  checked(CVodeSVtolerances(memory, tolerances.relative, absolute.get()), "CVodeSVtolerances");
  checked(CVodeSetLinearSolver(memory, solver.get(), jacobian.get()), "CVodeSetLinearSolver");
  checked(CVodeSetMaxNumSteps(memory, kMaxSteps), "CVodeSetMaxNumSteps");
  checked(CVodeRootInit(memory, kEvents, distances), "CVodeRootInit");
  checked(CVodeSetRootDirection(memory, falling.data()), "CVodeSetRootDirection");
  checked(CVodeSetNoInactiveRootWarn(memory), "CVodeSetNoInactiveRootWarn");
}

int CvodeDrive::Impl::checked(int flag, const char* call) const {
  if (flag >= 0) return flag;
  throw std::runtime_error(fmt::format(
      "{} fails with {}: {} (command {}, F {} N, from i {} A, w {} rad/s, delta {} m, v {} m/s, x "
      "{} m, z {} m)",
      call, flag_name(flag), message, command, F, start.i, start.w, start.delta, start.v, start.x,
      start.z));
}

// Makes the modes fit the state at the beginning of a piece.
void CvodeDrive::Impl::settle(LaneState& s) const {
  if (!p.has_winding() && p.T_i == 0.0) s.i = command;
  if (p.gap > 0.0) {
    const double push = flank_force(p, s, ContactMode::positive);
    const double pull = flank_force(p, s, ContactMode::negative);
    if (s.contact == ContactMode::positive && push < -kForceGuard) s.contact = ContactMode::gap;
    if (s.contact == ContactMode::negative && pull > kForceGuard) s.contact = ContactMode::gap;
    if (s.contact == ContactMode::gap && s.delta > 0.5 * p.gap && push > kForceGuard) {
      s.contact = ContactMode::positive;
    }
    if (s.contact == ContactMode::gap && s.delta < -0.5 * p.gap && pull < -kForceGuard) {
      s.contact = ContactMode::negative;
    }
  }
  if (p.friction.kind != FrictionKind::set_valued) return;
  if (s.v > kSpeedGuard) {
    s.slide = SlideMode::positive;
  } else if (s.v < -kSpeedGuard) {
    s.slide = SlideMode::negative;
  } else if (s.slide == SlideMode::sticking) {
    s.v = 0.0;
    if (p.is_rigid()) s.w = 0.0;
    s.slide = slide_from_rest(p.friction, driving_force(p, s, F));
  }
}

void CvodeDrive::Impl::begin(const LaneState& s) {
  start = s;
  const bool set_valued = p.friction.kind == FrictionKind::set_valued;
  positive = set_valued ? s.slide == SlideMode::positive : s.v >= 0.0;
  const bool sticking = set_valued && s.slide == SlideMode::sticking;
  const bool gap = p.gap > 0.0 && s.contact == ContactMode::gap;
  if (p.on_bed()) {
    on_bed = drive_equations_on_bed(p, sticking, gap);
  } else {
    A = drive_equations(p, sticking, gap);
  }
  double* values = N_VGetArrayPointer(y.get());
  values[kCurrent] = s.i;
  values[kSpeed] = s.w;
  values[kWindUp] = s.delta;
  values[kVelocity] = s.v;
  values[kWay] = 0.0;
  values[kBristle] = s.z;
  if (!p.on_bed()) return;
  values[kBed] = s.bed_x;
  values[kBedSpeed] = s.bed_v;
}

LaneState CvodeDrive::Impl::state_at(const double* at) const {
  LaneState s = start;
  s.i = at[kCurrent];
  s.w = at[kSpeed];
  s.delta = at[kWindUp];
  s.z = at[kBristle];
  if (p.on_bed()) {
    s.bed_x = at[kBed];
    s.bed_v = at[kBedSpeed];
  }
  if (p.friction.kind == FrictionKind::set_valued && s.slide == SlideMode::sticking) return s;
  s.v = at[kVelocity];
  s.x += at[kWay];
  return s;
}

// Integrates until the first event or for the whole duration. Returns how long it went.
double CvodeDrive::Impl::integrate(LaneState& s, double duration, Events& events) {
  begin(s);
  void* const memory = cvode.get();
  checked(CVodeReInit(memory, 0.0, y.get()), "CVodeReInit");
  checked(CVodeSetStopTime(memory, duration), "CVodeSetStopTime");
  double reached = 0.0;
  const int flag = checked(CVode(memory, duration, y.get(), &reached, CV_NORMAL), "CVode");
  s = state_at(N_VGetArrayPointer(y.get()));
  if (flag != CV_ROOT_RETURN) return duration;
  checked(CVodeGetRootInfo(memory, events.data()), "CVodeGetRootInfo");
  return reached;
}

void CvodeDrive::Impl::take(const Events& events, LaneState& s) const {
  if (events[kParts]) s.contact = ContactMode::gap;
  if (events[kMeetsPositive] || events[kCaughtPositive]) s.contact = ContactMode::positive;
  if (events[kMeetsNegative] || events[kCaughtNegative]) s.contact = ContactMode::negative;
  if (events[kBreaksPositive]) s.slide = SlideMode::positive;
  if (events[kBreaksNegative]) s.slide = SlideMode::negative;
  if (events[kStops] && p.friction.kind == FrictionKind::set_valued) {
    s.slide = SlideMode::sticking;  // settle() decides what follows
    s.v = 0.0;
  }
}

double CvodeDrive::Impl::friction_force(double v, double z) const {
  const FrictionParams& f = p.friction;
  switch (f.kind) {
    case FrictionKind::none:
      break;
    case FrictionKind::set_valued:
      return positive ? sliding_force(f, true, v) : -sliding_force(f, false, v);
    case FrictionKind::regularised:
      return regularised_force(f, positive, v);
    case FrictionKind::lugre:
      return f.sigma0 * z + f.sigma1 * bristle_rate(f, positive, v, z);
  }
  return 0.0;
}

void CvodeDrive::Impl::rates(const double* at, double* dy) const {
  const double v = at[kVelocity], z = at[kBristle];
  const double against = p.F_load + F + cogging_force(p, start.x + at[kWay]) + friction_force(v, z);
  const double offset = p.gap > 0.0 ? contact_offset(p, start.contact) : 0.0;
  dy[kBristle] =
      p.friction.kind == FrictionKind::lugre ? bristle_rate(p.friction, positive, v, z) : 0.0;
  if (p.on_bed()) {
    Eigen::Matrix<double, 9, 1> values;
    values << at[kCurrent], at[kSpeed], at[kWindUp] - offset, v, at[kBed], at[kBedSpeed], 0.0,
        command, against;
    const Eigen::Matrix<double, 7, 1> rate = on_bed * values;
    for (const int n : {kCurrent, kSpeed, kWindUp, kVelocity}) dy[n] = rate[n];
    dy[kBed] = rate[4];
    dy[kBedSpeed] = rate[5];
    dy[kWay] = rate[6];
    return;
  }
  Eigen::Matrix<double, 7, 1> values;
  values << at[kCurrent], at[kSpeed], at[kWindUp] - offset, v, 0.0, command, against;
  Eigen::Map<Eigen::Matrix<double, 5, 1>> rate(dy);
  rate.noalias() = A.lazyProduct(values);
}

void CvodeDrive::Impl::distances(const double* at, double* g) const {
  std::fill(g, g + kEvents, kNotNow);
  const FrictionParams& f = p.friction;
  const LaneState s = state_at(at);
  if (f.kind == FrictionKind::set_valued && start.slide == SlideMode::sticking) {
    const double force = driving_force(p, s, F);
    g[kBreaksPositive] = f.Fs_positive - force + kForceGuard;
    g[kBreaksNegative] = f.Fs_negative + force + kForceGuard;
  } else if (f.kind != FrictionKind::none) {
    g[kStops] = (positive ? s.v : -s.v) + kSpeedGuard;
  }
  if (p.gap == 0.0) return;
  const double push = flank_force(p, s, ContactMode::positive);
  const double pull = flank_force(p, s, ContactMode::negative);
  const double half = 0.5 * p.gap;
  switch (start.contact) {
    case ContactMode::positive:
      g[kParts] = push + kForceGuard;
      break;
    case ContactMode::negative:
      g[kParts] = -pull + kForceGuard;
      break;
    case ContactMode::gap:
      g[kMeetsPositive] = half - s.delta;
      g[kMeetsNegative] = half + s.delta;
      if (s.delta > half) g[kCaughtPositive] = kForceGuard - push;
      if (s.delta < -half) g[kCaughtNegative] = kForceGuard + pull;
      break;
  }
}

CvodeTolerances CvodeTolerances::times(double factor) const {
  return {factor * relative, factor * i, factor * w, factor * delta,
          factor * v,        factor * x, factor * z};
}

CvodeDrive::CvodeDrive(const FeedDriveParams& params, const CvodeTolerances& tolerances)
    : impl_(std::make_unique<Impl>(params, tolerances)) {
  assert(implausible(params).empty());
}
CvodeDrive::~CvodeDrive() = default;
CvodeDrive::CvodeDrive(CvodeDrive&&) noexcept = default;
CvodeDrive& CvodeDrive::operator=(CvodeDrive&&) noexcept = default;

void CvodeDrive::advance(LaneState& s, double command, double F, double duration) {
  impl_->command = command;
  impl_->F = F;
  double left = duration;
  for (int n = 0; left > 0.0; ++n) {
    if (n == kMaxEvents) {
      throw std::runtime_error(fmt::format(
          "more than {} events of friction and contact within {} s, at x {} m", n, duration, s.x));
    }
    Events events{};
    impl_->settle(s);
    left -= impl_->integrate(s, left, events);
    impl_->take(events, s);
  }
}

}  // namespace servomill::plant
