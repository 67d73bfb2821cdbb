#include "plant/geometry/volumetric_kernel.h"

#include <cmath>
#include <type_traits>
#include <utility>
#include <xsimd/xsimd.hpp>

#define SERVOMILL_INLINE [[gnu::always_inline]] inline

namespace servomill::plant {
namespace {

using Register = xsimd::batch<double, SERVOMILL_ARCH>;
constexpr std::size_t kRegister = Register::size;

SERVOMILL_INLINE Register load(const LaneArray& from, std::size_t first) {
  return Register::load_aligned(&from[0] + first);
}
SERVOMILL_INLINE void store(const Register& value, LaneArray& to, std::size_t first) {
  value.store_aligned(&to[0] + first);
}

template <class F, std::size_t... lane>
SERVOMILL_INLINE Register lanes_from(F value, std::index_sequence<lane...>) {
  return Register{value(lane)...};
}
template <class F>
SERVOMILL_INLINE Register lanes_from(F value) {
  return lanes_from(value, std::make_index_sequence<kRegister>());
}

// The next whole number below 2^51, ties to even, by the rounding of an addition.
template <class N>
SERVOMILL_INLINE N nearest(const N& x) {
  const N rounder(0x1.8p52);
  return (x + rounder) - rounder;
}

// The sine, with an error below one unit in the last place of 1: Taylor's series of x less the
// nearest multiple n of pi, which is subtracted in three parts. The products of the first two are
// exact for n < 2^20; beyond, their rounding is no larger than that of x itself.
template <class N>
SERVOMILL_INLINE N sine(const N& x) {
  const N n = nearest(x * N(0x1.45f306dc9c883p-2));
  const N odd = n - N(2.0) * nearest(N(0.5) * n);  // -1, 0, 1
  const N rest =
      ((x - n * N(0x1.921fb544p1)) - n * N(0x1.0b4611a6p-33)) - n * N(0x1.3198a2e037073p-68);
  const N r = rest * (N(1.0) - N(2.0) * odd * odd);
  const N z = r * r, zz = z * z;
  const N a = N(-1.0 / 6.0) +
              zz * (N(-1.0 / 5040.0) +
                    zz * (N(-1.0 / 39916800.0) +
                          zz * (N(-1.0 / 1307674368000.0) + zz * N(-1.0 / 121645100408832000.0))));
  const N b = N(1.0 / 120.0) +
              zz * (N(1.0 / 362880.0) +
                    zz * (N(1.0 / 6227020800.0) + zz * (N(1.0 / 355687428096000.0) +
                                                        zz * N(1.0 / 51090942171709440000.0))));
  return r + r * z * (a + z * b);
}

// --- the turn of a vector of angles -------------------------------------------------------------

// Rot(e) - 1 = a [e]x + b (e e^T - e^2), with a = sin t/t, b = (1 - cos t)/t^2 for t = |e|.
template <class N>
struct TurnFactors {
  N a, b;
};

void replace_large_turn(double t2, double& a, double& b) {
  if (!(t2 > kSmallTurn * kSmallTurn)) return;
  const double t = std::sqrt(t2), half = sine(0.5 * t);
  a = sine(t) / t;
  b = 2.0 * half * half / t2;
}
[[gnu::noinline]] void replace_large_turns(const Register& t2, TurnFactors<Register>& f) {
  alignas(64) double lanes_t2[kRegister], lanes_a[kRegister], lanes_b[kRegister];
  t2.store_aligned(lanes_t2);
  f.a.store_aligned(lanes_a);
  f.b.store_aligned(lanes_b);
  for (std::size_t n = 0; n < kRegister; ++n) {
    replace_large_turn(lanes_t2[n], lanes_a[n], lanes_b[n]);
  }
  f.a = Register::load_aligned(lanes_a);
  f.b = Register::load_aligned(lanes_b);
}

SERVOMILL_INLINE TurnFactors<Register> turn_factors(const Register& t2) {
  TurnFactors<Register> f{Register(1.0) - t2 * Register(1.0 / 6.0),
                          Register(0.5) - t2 * Register(1.0 / 24.0)};
  if (xsimd::any(t2 > Register(kSmallTurn * kSmallTurn))) [[unlikely]] {
    replace_large_turns(t2, f);
  }
  return f;
}

// --- the errors of an axis ----------------------------------------------------------------------

// w, and D = R - 1 with the opposite diagonal.
template <class N>
struct Fault {
  N w[3];
  N D[3][3];
};

SERVOMILL_INLINE void set_turn(const Register* e, Fault<Register>& fault) {
  using N = Register;
  const N t2 = (e[0] * e[0] + e[1] * e[1]) + e[2] * e[2];
  const auto [a, b] = turn_factors(t2);
  const N bx = b * e[0], by = b * e[1], bz = b * e[2];
  const N xx = bx * e[0], yy = by * e[1], zz = bz * e[2];
  const N xy = bx * e[1], xz = bx * e[2], yz = by * e[2];
  const N ax = a * e[0], ay = a * e[1], az = a * e[2];
  auto& D = fault.D;
  D[0][0] = yy + zz;
  D[1][1] = xx + zz;
  D[2][2] = xx + yy;
  D[0][1] = xy - az;
  D[1][0] = xy + az;
  D[0][2] = xz + ay;
  D[2][0] = xz - ay;
  D[1][2] = yz - ax;
  D[2][1] = yz + ax;
}

// Horner's rule for several components at once; coefficient(power, component).
template <std::size_t kComponents, class F>
SERVOMILL_INLINE void evaluate(const VolumetricProgram& program, const Register& q, F coefficient,
                               Register* e) {
  const auto horner = [&](auto degree) {
    for (std::size_t c = 0; c < kComponents; ++c) e[c] = coefficient(degree - 1, c);
    for (std::size_t i = degree - 1; i-- > 0;) {
      for (std::size_t c = 0; c < kComponents; ++c) e[c] = e[c] * q + coefficient(i, c);
    }
    for (std::size_t c = 0; c < kComponents; ++c) e[c] = e[c] * q;
  };
  if (program.degree == 3) {
    horner(std::integral_constant<std::size_t, 3>());
  } else {
    horner(program.degree);
  }
  if (program.has_constants) {
    for (std::size_t c = 0; c < kComponents; ++c) e[c] = e[c] + coefficient(program.degree, c);
  }
}

template <class F, class G>
SERVOMILL_INLINE void find_fault(const VolumetricProgram& program, bool has_angles,
                                 const Register& q, F coefficient, G terms,
                                 Fault<Register>& fault) {
  Register e[kErrorComponents];
  if (has_angles) {
    evaluate<6>(program, q, coefficient, e);
  } else {
    evaluate<3>(program, q, coefficient, e);
  }
  const std::size_t components = has_angles ? 6 : 3;
  if (program.has_terms) {
    for (std::size_t c = 0; c < components; ++c) e[c] = e[c] + terms(c);
  }
  for (std::size_t i = 0; i < 3; ++i) fault.w[i] = e[i];
  if (has_angles) set_turn(e + 3, fault);
}

// --- the way of the tool ------------------------------------------------------------------------

template <class N>
struct Vector {
  N v[3];
};

template <class N>
SERVOMILL_INLINE Vector<N> turned(int k, const N& cosine, const N& sine, const Vector<N>& p) {
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  Vector<N> u = p;
  u.v[i] = cosine * p.v[i] - sine * p.v[j];
  u.v[j] = sine * p.v[i] + cosine * p.v[j];
  return u;
}
template <class N>
SERVOMILL_INLINE Vector<N> plus(const Vector<N>& p, const double* d) {
  return {p.v[0] + N(d[0]), p.v[1] + N(d[1]), p.v[2] + N(d[2])};
}
template <class N>
SERVOMILL_INLINE Vector<N> minus(const Vector<N>& p, const double* d) {
  return {p.v[0] - N(d[0]), p.v[1] - N(d[1]), p.v[2] - N(d[2])};
}
template <class N>
SERVOMILL_INLINE Vector<N> minus(const Vector<N>& p, const Vector<N>& q) {
  return {p.v[0] - q.v[0], p.v[1] - q.v[1], p.v[2] - q.v[2]};
}
template <class N>
SERVOMILL_INLINE Vector<N> times(const double (&R)[3][3], const Vector<N>& p) {
  Vector<N> u;
  for (int i = 0; i < 3; ++i) {
    u.v[i] = (N(R[i][0]) * p.v[0] + N(R[i][1]) * p.v[1]) + N(R[i][2]) * p.v[2];
  }
  return u;
}
template <class N>
SERVOMILL_INLINE Vector<N> transpose_times(const double (&R)[3][3], const Vector<N>& p) {
  Vector<N> u;
  for (int i = 0; i < 3; ++i) {
    u.v[i] = (N(R[0][i]) * p.v[0] + N(R[1][i]) * p.v[1]) + N(R[2][i]) * p.v[2];
  }
  return u;
}
// (R - 1) p
template <class N>
SERVOMILL_INLINE Vector<N> turn_of(const Fault<N>& f, const Vector<N>& p) {
  const auto& D = f.D;
  return {(D[0][1] * p.v[1] + D[0][2] * p.v[2]) - D[0][0] * p.v[0],
          (D[1][0] * p.v[0] + D[1][2] * p.v[2]) - D[1][1] * p.v[1],
          (D[2][0] * p.v[0] + D[2][1] * p.v[1]) - D[2][2] * p.v[2]};
}
template <class N>
SERVOMILL_INLINE Vector<N> sum(const Vector<N>& p, const N (&w)[3]) {
  return {p.v[0] + w[0], p.v[1] + w[1], p.v[2] + w[2]};
}

// The true tool, and the ideal one where it is asked for; the axis where it is asked for.
template <class N, bool kAxis, bool kIdeal>
struct Tools {
  Vector<N> p, k, p_ideal, k_ideal;

  SERVOMILL_INLINE void ideal_shift(int along, const N& q) {
    if constexpr (kIdeal) p_ideal.v[along] = p_ideal.v[along] + q;
  }
  SERVOMILL_INLINE void ideal_turn(int about, const N& c, const N& s, const double* centre) {
    if constexpr (kIdeal) {
      p_ideal = plus(turned(about, c, s, minus(p_ideal, centre)), centre);
      if constexpr (kAxis) k_ideal = turned(about, c, s, k_ideal);
    }
  }
  SERVOMILL_INLINE void turn(int about, const N& c, const N& s, const double* centre) {
    p = plus(turned(about, c, s, minus(p, centre)), centre);
    if constexpr (kAxis) k = turned(about, c, s, k);
  }
  SERVOMILL_INLINE void tilted_turn(int about, const N& c, const N& s, const VolumetricStep& step) {
    const Vector<N> u = minus(transpose_times(step.R, minus(p, step.centre)), step.t);
    p = plus(times(step.R, plus(turned(about, c, s, u), step.t)), step.centre);
    if constexpr (kAxis) k = times(step.R, turned(about, c, s, transpose_times(step.R, k)));
  }
  SERVOMILL_INLINE void fault(const Fault<N>& f, const VolumetricStep& step, const N& q) {
    const Vector<N> moved = sum(p, f.w);
    if (!step.has_angles) {
      p = moved;
      return;
    }
    Vector<N> arm = p;
    if (step.has_lever) {
      for (int i = 0; i < 3; ++i) {
        arm.v[i] = p.v[i] + (q * N(step.lever_slope[i]) - N(step.centre[i]));
      }
    }
    p = sum(moved, turn_of(f, arm).v);
    if constexpr (kAxis) k = sum(k, turn_of(f, k).v);
  }
};

// Source: q(joint), cosine(joint), sine(joint), fault(joint).
template <int direction, class N, class Source, class T>
SERVOMILL_INLINE void take(const VolumetricStep& step, Source& at, T& tools) {
  switch (step.move) {
    case VolumetricMove::shift: {
      const N q = at.q(step.joint);
      tools.p.v[direction] = tools.p.v[direction] + q;
      tools.ideal_shift(direction, q);
      return;
    }
    case VolumetricMove::faulty_shift: {
      const N q = at.q(step.joint);
      Fault<N> f;
      at.fault(step, q, f);
      f.w[direction] = f.w[direction] + q;
      tools.fault(f, step, q);
      tools.ideal_shift(direction, q);
      return;
    }
    case VolumetricMove::fault: {
      const N q = at.q(step.joint);
      Fault<N> f;
      at.fault(step, q, f);
      tools.fault(f, step, q);
      return;
    }
    case VolumetricMove::turn: {
      const N c = at.cosine(step.joint), s = at.sine(step.joint);
      tools.turn(direction, c, s, step.centre);
      tools.ideal_turn(direction, c, s, step.centre);
      return;
    }
    case VolumetricMove::tilted_turn: {
      const N c = at.cosine(step.joint), s = at.sine(step.joint);
      tools.tilted_turn(direction, c, s, step);
      tools.ideal_turn(direction, c, s, step.centre);
      return;
    }
  }
}

template <class N, class Source, class T>
SERVOMILL_INLINE void go(const VolumetricProgram& program, std::size_t steps, Source& at,
                         T& tools) {
  for (std::size_t n = 0; n < steps; ++n) {
    const VolumetricStep& step = program.steps[n];
    switch (step.direction) {
      case 0:
        take<0, N>(step, at, tools);
        break;
      case 1:
        take<1, N>(step, at, tools);
        break;
      default:
        take<2, N>(step, at, tools);
    }
  }
}

template <class N>
SERVOMILL_INLINE Vector<N> at_tip(const double* p_ST) {
  return {N(p_ST[0]), N(p_ST[1]), N(p_ST[2])};
}

enum class Wanted { tool, error, offset };

// The first `size(wanted)` numbers of the result.
template <Wanted wanted, class N, class Source>
SERVOMILL_INLINE void solve(const VolumetricProgram& program, Source& at, const double* p_ST,
                            N* out) {
  constexpr bool kAxis = wanted != Wanted::offset, kIdeal = wanted != Wanted::tool;
  Tools<N, kAxis, kIdeal> tools;
  tools.p = tools.p_ideal = at_tip<N>(p_ST);
  tools.k = tools.k_ideal = {N(0.0), N(0.0), N(1.0)};
  const std::size_t steps =
      wanted == Wanted::offset ? program.offset_steps : program.number_of_steps;
  go<N>(program, steps, at, tools);
  Vector<N> p = tools.p, k = tools.k;
  if constexpr (kIdeal) p = minus(p, tools.p_ideal);
  if constexpr (wanted == Wanted::error) k = minus(k, tools.k_ideal);
  if constexpr (wanted == Wanted::offset) {
    // the difference is turned back into the frame of the linear axes
    for (std::size_t n = steps; n-- > program.linear_end;) {
      const VolumetricStep& step = program.steps[n];
      if (step.move == VolumetricMove::fault) continue;
      const N c = at.cosine(step.joint), s = -at.sine(step.joint);
      if (step.direction == 0) p = turned(0, c, s, p);
      if (step.direction == 1) p = turned(1, c, s, p);
      if (step.direction == 2) p = turned(2, c, s, p);
    }
  }
  for (int i = 0; i < 3; ++i) out[i] = p.v[i];
  if constexpr (kAxis) {
    for (int i = 0; i < 3; ++i) out[3 + i] = k.v[i];
  }
}

// --- one pose: axes in lanes --------------------------------------------------------------------

class OnePose {
 public:
  SERVOMILL_INLINE OnePose(const VolumetricProgram& program, const OnePoseData* data,
                           const double* Q)
      : data_(data), Q_(Q) {
    if (program.has_terms) add_terms(program);
    for (std::size_t first = 0; first < program.joints; first += kRegister) {
      const Register q = lanes_from(
          [&](std::size_t lane) { return first + lane < kMachineJoints ? Q[first + lane] : 0.0; });
      const auto coefficient = [&](std::size_t power, std::size_t component) {
        return load(program.polynomial[power].e[component], first);
      };
      const auto terms = [&](std::size_t component) { return load(terms_.e[component], first); };
      Fault<Register> fault;
      find_fault(program, program.has_angles, q, coefficient, terms, fault);
      for (std::size_t i = 0; i < 3; ++i) store(fault.w[i], w_[i], first);
      if (!program.has_angles) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) store(fault.D[i][j], D_[i][j], first);
      }
    }
  }

  SERVOMILL_INLINE double q(std::size_t joint) const { return Q_[joint]; }
  SERVOMILL_INLINE double cosine(std::size_t joint) const { return data_->cosine[joint]; }
  SERVOMILL_INLINE double sine(std::size_t joint) const { return data_->sine[joint]; }
  SERVOMILL_INLINE void fault(const VolumetricStep& step, double, Fault<double>& f) const {
    for (std::size_t i = 0; i < 3; ++i) f.w[i] = w_[i][step.joint];
    if (!step.has_angles) return;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) f.D[i][j] = D_[i][j][step.joint];
    }
  }

 private:
  [[gnu::noinline]] void add_terms(const VolumetricProgram& program) {
    for (std::size_t c = 0; c < kErrorComponents; ++c) {
      if (data_ != nullptr) {
        terms_.e[c] = data_->tables.e[c];
      } else {
        terms_.e[c] = {};
      }
    }
    const VolumetricHarmonic* h = program.harmonics;
    const VolumetricHarmonic* const end = h + program.number_of_harmonics;
    for (std::size_t block = 0; block < program.wave_blocks; ++block) {
      const VolumetricWaves& waves = program.waves[block];
      LaneArray sines;
      for (std::size_t first = 0; first < kLaneWidth; first += kRegister) {
        const Register q =
            lanes_from([&](std::size_t lane) { return Q_[waves.joint[first + lane]]; });
        const Register x = load(waves.omega, first) * q + load(waves.phase, first);
        store(plant::sine(x), sines, first);
      }
      for (; h != end && h->wave / kLaneWidth == block; ++h) {
        terms_.e[h->component][h->joint] += h->amplitude * sines[h->wave % kLaneWidth];
      }
    }
  }

  const OnePoseData* data_;
  const double* Q_;
  LaneArray w_[3], D_[3][3];
  VolumetricPower terms_;
};

template <Wanted wanted>
void one(const VolumetricProgram& program, const OnePoseData* data, const double* Q,
         const double* p_ST, double* out) {
  OnePose at(program, data, Q);
  solve<wanted>(program, at, p_ST, out);
}

// --- many poses: poses in lanes -----------------------------------------------------------------

class PosesInLanes {
 public:
  SERVOMILL_INLINE PosesInLanes(const VolumetricProgram& program, const EightPosesData* data,
                                const double* Q, std::size_t first)
      : program_(program), data_(data), Q_(Q), first_(first) {
    if (program.has_terms) add_terms();
  }

  SERVOMILL_INLINE Register q(std::size_t joint) const {
    return lanes_from(
        [&](std::size_t lane) { return Q_[kMachineJoints * (first_ + lane) + joint]; });
  }
  SERVOMILL_INLINE Register cosine(std::size_t joint) const {
    return load(data_->cosine[joint], first_);
  }
  SERVOMILL_INLINE Register sine(std::size_t joint) const {
    return load(data_->sine[joint], first_);
  }
  SERVOMILL_INLINE void fault(const VolumetricStep& step, const Register& q,
                              Fault<Register>& f) const {
    const auto coefficient = [&](std::size_t power, std::size_t component) {
      return Register(program_.polynomial[power].e[component][step.joint]);
    };
    const auto terms = [&](std::size_t component) { return terms_[step.joint][component]; };
    find_fault(program_, step.has_angles, q, coefficient, terms, f);
  }

 private:
  [[gnu::noinline]] void add_terms() {
    for (std::size_t joint = 0; joint < program_.joints; ++joint) {
      for (std::size_t c = 0; c < kErrorComponents; ++c) {
        terms_[joint][c] =
            data_ != nullptr ? load(data_->tables[joint].e[c], first_) : Register(0.0);
      }
    }
    const VolumetricHarmonic* h = program_.harmonics;
    const VolumetricHarmonic* const end = h + program_.number_of_harmonics;
    while (h != end) {
      const std::size_t wave = h->wave, lane = wave % kLaneWidth;
      const VolumetricWaves& waves = program_.waves[wave / kLaneWidth];
      const Register x = Register(waves.omega[lane]) * q(h->joint) + Register(waves.phase[lane]);
      const Register value = plant::sine(x);
      for (; h != end && h->wave == wave; ++h) {
        Register& sum = terms_[h->joint][h->component];
        sum = sum + Register(h->amplitude) * value;
      }
    }
  }

  const VolumetricProgram& program_;
  const EightPosesData* data_;
  const double* Q_;
  std::size_t first_;
  Register terms_[kMachineJoints][kErrorComponents];
};

template <Wanted wanted>
void many(const VolumetricProgram& program, const EightPosesData* data, const double* Q,
          std::size_t blocks, const double* p_ST, double* out) {
  constexpr std::size_t kSize = wanted == Wanted::offset ? 3 : 6;
  for (std::size_t block = 0; block < blocks; ++block) {
    for (std::size_t first = 0; first < kLaneWidth; first += kRegister) {
      PosesInLanes at(program, data, Q, first);
      Register result[kSize];
      solve<wanted>(program, at, p_ST, result);
      alignas(64) double lanes[kSize][kRegister];
      for (std::size_t i = 0; i < kSize; ++i) result[i].store_aligned(lanes[i]);
      for (std::size_t n = 0; n < kRegister; ++n) {
        for (std::size_t i = 0; i < kSize; ++i) *out++ = lanes[i][n];
      }
    }
    Q += kMachineJoints * kLaneWidth;
    if (data != nullptr) ++data;
  }
}

}  // namespace

template <>
VolumetricKernel make_volumetric_kernel<SERVOMILL_LEVEL>() {
  return {&one<Wanted::tool>,  &one<Wanted::error>,  &one<Wanted::offset>,
          &many<Wanted::tool>, &many<Wanted::error>, &many<Wanted::offset>};
}

}  // namespace servomill::plant
