#include "plant/geometry/volumetric_kernel.h"

#include <cmath>
#include <type_traits>
#include <utility>
#include <xsimd/xsimd.hpp>

#define SERVOMILL_INLINE [[gnu::always_inline]] inline

namespace servomill::plant {
namespace {

using Batch = xsimd::batch<double, SERVOMILL_ARCH>;
constexpr std::size_t kRegister = Batch::size;

// A register as the compiler knows it: with the operators of numbers, also beside numbers.
using Register [[gnu::vector_size(kRegister * sizeof(double))]] = double;

SERVOMILL_INLINE Register load(const double* from) { return Batch::load_unaligned(from); }
SERVOMILL_INLINE Register load(const LaneArray& from, std::size_t first) {
  return Batch::load_aligned(&from[0] + first);
}
SERVOMILL_INLINE void store(const Register& value, double* to) { Batch(value).store_unaligned(to); }
SERVOMILL_INLINE void store(const Register& value, LaneArray& to, std::size_t first) {
  Batch(value).store_aligned(&to[0] + first);
}

// One value for all lanes.
template <class N>
SERVOMILL_INLINE N all(double value) {
  return value - N{};
}

template <class F, std::size_t... i>
SERVOMILL_INLINE void for_each(std::index_sequence<i...>, F f) {
  (f(std::integral_constant<std::size_t, i>()), ...);
}
template <std::size_t count, class F>
SERVOMILL_INLINE void repeat(F f) {
  for_each(std::make_index_sequence<count>(), f);
}

template <class F, std::size_t... lane>
SERVOMILL_INLINE Register lanes_from(F value, std::index_sequence<lane...>) {
  return Register{value(lane)...};
}
template <class F>
SERVOMILL_INLINE Register lanes_from(F value) {
  return lanes_from(value, std::make_index_sequence<kRegister>());
}

// a b + c, c - a b and a b - c, rounded once where the machine can: numbers and registers alike.
#ifdef FP_FAST_FMA
SERVOMILL_INLINE double fma(double a, double b, double c) { return __builtin_fma(a, b, c); }
#else
SERVOMILL_INLINE double fma(double a, double b, double c) { return a * b + c; }
#endif
SERVOMILL_INLINE Register fma(const Register& a, const Register& b, const Register& c) {
#ifdef __AVX512F__  // xsimd 8 rounds twice here
  return _mm512_fmadd_pd(a, b, c);
#else
  return xsimd::fma(Batch(a), Batch(b), Batch(c));
#endif
}
template <class N>
SERVOMILL_INLINE N fnma(const N& a, const N& b, const N& c) {
  return fma(-a, b, c);
}
template <class N>
SERVOMILL_INLINE N fms(const N& a, const N& b, const N& c) {
  return fma(a, b, -c);
}

// The next whole number below 2^51, ties to even, by the rounding of an addition.
template <class N>
SERVOMILL_INLINE N nearest(const N& x) {
  return (x + 0x1.8p52) - 0x1.8p52;
}

// The sine, with an error below one unit in the last place of 1: Taylor's series of x less the
// nearest multiple n of pi, which is subtracted in three parts. The products of the first two are
// exact for n < 2^20; beyond, their rounding is no larger than that of x itself.
template <class N>
SERVOMILL_INLINE N sine(const N& x) {
  const N n = nearest<N>(x * 0x1.45f306dc9c883p-2);
  const N odd = n - 2.0 * nearest<N>(0.5 * n);  // -1, 0, 1
  const N rest = fnma(n, all<N>(0x1.3198a2e037073p-68),
                      fnma(n, all<N>(0x1.0b4611a6p-33), fnma(n, all<N>(0x1.921fb544p1), x)));
  const N r = rest * (1.0 - 2.0 * odd * odd);
  const N z = r * r, zz = z * z;
  const auto series = [&zz](double c0, double c1, double c2, double c3, double c4) {
    N sum = fma(zz, all<N>(c4), all<N>(c3));
    sum = fma(zz, sum, all<N>(c2));
    sum = fma(zz, sum, all<N>(c1));
    return fma(zz, sum, all<N>(c0));
  };
  const N a = series(-1.0 / 6.0, -1.0 / 5040.0, -1.0 / 39916800.0, -1.0 / 1307674368000.0,
                     -1.0 / 121645100408832000.0);
  const N b = series(1.0 / 120.0, 1.0 / 362880.0, 1.0 / 6227020800.0, 1.0 / 355687428096000.0,
                     1.0 / 51090942171709440000.0);
  const N rz = r * z;
  return fma(rz, fma(z, b, a), r);
}

// --- the turn of a vector of angles -------------------------------------------------------------

// Rot(e) v = v + a e x (v + h e x v), with h = tan(t/2)/t, a = sin t/t for t = |e|.
struct TurnFactors {
  Register a, h;
};

SERVOMILL_INLINE TurnFactors small_turn_factors(const Register& t2) {
  return {fnma(t2, all<Register>(1.0 / 6.0), all<Register>(1.0)),
          fma(t2, all<Register>(1.0 / 24.0), all<Register>(0.5))};
}

// a is computed from h: what belongs together turns by some angle, even where h is large.
TurnFactors turn_factors(const Register& t2) {
  TurnFactors f = small_turn_factors(t2);
  for (std::size_t n = 0; n < kRegister; ++n) {
    if (t2[n] < kSmallTurn * kSmallTurn) continue;
    const double t = std::sqrt(t2[n]), quarter = sine(0.25 * t);
    const double cosine = fnma(2.0 * quarter, quarter, 1.0);
    const double tangent = sine(0.5 * t) / (cosine == 0.0 ? 0x1p-54 : cosine);
    f.h[n] = tangent / t;
    f.a[n] = 2.0 * f.h[n] / fma(tangent, tangent, 1.0);
  }
  return f;
}

// --- the errors of an axis ----------------------------------------------------------------------

// w, and the turn as a e and h e.
struct Fault {
  Register w_[3], a_[3], h_[3];

  SERVOMILL_INLINE const Register& w(std::size_t i) const { return w_[i]; }
  SERVOMILL_INLINE const Register& a(std::size_t i) const { return a_[i]; }
  SERVOMILL_INLINE const Register& h(std::size_t i) const { return h_[i]; }
};

// Two ways through the same formulas. The usual one takes only cubic polynomials and small turns
// and thus calls nothing; it is given up, to be gone again in general, where t2_max turns out too
// large.
enum class Way { usual, general };

template <Way way>
SERVOMILL_INLINE void set_turn(const Register (&e)[kErrorComponents], Fault& fault,
                               Register& t2_max) {
  const Register t2 = fma(e[5], e[5], fma(e[4], e[4], e[3] * e[3]));
  const auto [a, h] = way == Way::usual ? small_turn_factors(t2) : turn_factors(t2);
  t2_max = xsimd::max(Batch(t2_max), Batch(t2));
  for (std::size_t i = 0; i < 3; ++i) {
    fault.a_[i] = a * e[3 + i];
    fault.h_[i] = h * e[3 + i];
  }
}

// Several components at once; coefficient(power, component). Even and odd pairs of powers,
// (c0 + c1 q) + (c2 + c3 q) q^2 + ..., which wait for each other half as long as Horner's rule.
template <Way way, std::size_t kComponents, class F, class G>
SERVOMILL_INLINE void evaluate(const VolumetricProgram& program, const Register& q, F coefficient,
                               G terms, Register (&e)[kErrorComponents]) {
  const Register q2 = q * q;
  const auto pair = [&](std::size_t i, auto c) {
    return fma(coefficient(2 * i + 1, c), q, coefficient(2 * i, c));
  };
  const std::size_t last = way == Way::usual ? 1 : program.pairs - 1;
  repeat<kComponents>([&](auto c) { e[c] = pair(last, c); });
  for (std::size_t i = last; i-- > 0;) {
    repeat<kComponents>([&](auto c) { e[c] = fma(e[c], q2, pair(i, c)); });
  }
  if constexpr (way == Way::general) {
    if (program.has_terms) repeat<kComponents>([&](auto c) { e[c] = e[c] + terms(c); });
  }
}

template <Way way, class F, class G>
SERVOMILL_INLINE void find_fault(const VolumetricProgram& program, bool has_angles,
                                 const Register& q, F coefficient, G terms, Fault& fault,
                                 Register& t2_max) {
  Register e[kErrorComponents];
  if (has_angles) {
    evaluate<way, 6>(program, q, coefficient, terms, e);
    set_turn<way>(e, fault, t2_max);
  } else {
    evaluate<way, 3>(program, q, coefficient, terms, e);
  }
  for (std::size_t i = 0; i < 3; ++i) fault.w_[i] = e[i];
}

SERVOMILL_INLINE bool are_small_turns(const Register& t2_max) {
  return !xsimd::any(Batch(t2_max) >= Batch(kSmallTurn * kSmallTurn));
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
  return {p.v[0] + d[0], p.v[1] + d[1], p.v[2] + d[2]};
}
template <class N>
SERVOMILL_INLINE Vector<N> minus(const Vector<N>& p, const double* d) {
  return {p.v[0] - d[0], p.v[1] - d[1], p.v[2] - d[2]};
}
template <class N>
SERVOMILL_INLINE Vector<N> minus(const Vector<N>& p, const Vector<N>& q) {
  return {p.v[0] - q.v[0], p.v[1] - q.v[1], p.v[2] - q.v[2]};
}
template <class N>
SERVOMILL_INLINE Vector<N> times(const double (&R)[3][3], const Vector<N>& p) {
  Vector<N> u;
  for (int i = 0; i < 3; ++i) {
    u.v[i] = (R[i][0] * p.v[0] + R[i][1] * p.v[1]) + R[i][2] * p.v[2];
  }
  return u;
}
template <class N>
SERVOMILL_INLINE Vector<N> transpose_times(const double (&R)[3][3], const Vector<N>& p) {
  Vector<N> u;
  for (int i = 0; i < 3; ++i) {
    u.v[i] = (R[0][i] * p.v[0] + R[1][i] * p.v[1]) + R[2][i] * p.v[2];
  }
  return u;
}
// v + e x u, in an order of additions that is the same wherever it is computed
template <class N>
SERVOMILL_INLINE Vector<N> plus_cross(const Vector<N>& v, const Vector<N>& e, const Vector<N>& u) {
  return {fma(e.v[1], u.v[2], fnma(e.v[2], u.v[1], v.v[0])),
          fma(e.v[2], u.v[0], fnma(e.v[0], u.v[2], v.v[1])),
          fma(e.v[0], u.v[1], fnma(e.v[1], u.v[0], v.v[2]))};
}
// v + (R - 1) p
template <class N, class F>
SERVOMILL_INLINE Vector<N> turned_by(const F& f, const Vector<N>& p, const Vector<N>& v) {
  const Vector<N> a{f.a(0), f.a(1), f.a(2)}, h{f.h(0), f.h(1), f.h(2)};
  return plus_cross(v, a, plus_cross(p, h, p));
}

template <class N>
SERVOMILL_INLINE void add(int direction, const N& q, N (&v)[3]) {
  if (direction == 0) {
    v[0] = v[0] + q;
  } else if (direction == 1) {
    v[1] = v[1] + q;
  } else {
    v[2] = v[2] + q;
  }
}

// The true tool, and the ideal one where it is asked for; the axis where it is asked for.
template <class N, bool kAxis, bool kIdeal>
struct Tools {
  static constexpr bool kHasIdeal = kIdeal;
  Vector<N> p, k, p_ideal, k_ideal;

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
  template <class F>
  SERVOMILL_INLINE void fault(const F& f, const VolumetricStep& step, const N& q) {
    Vector<N> w{f.w(0), f.w(1), f.w(2)};
    if (step.move == VolumetricMove::faulty_shift) {
      add(step.direction, q, w.v);
      if constexpr (kIdeal) add(step.direction, q, p_ideal.v);
    }
    repeat<3>([&](auto i) { w.v[i] = p.v[i] + w.v[i]; });
    if (!step.has_angles) {
      p = w;
      return;
    }
    if (step.has_lever) {
      repeat<3>([&](auto i) {
        p.v[i] = p.v[i] + fms(q, all<N>(step.lever_slope[i]), all<N>(step.centre[i]));
      });
    }
    p = turned_by(f, p, w);
    if constexpr (kAxis) k = turned_by(f, k, k);
  }
};

// Calls f with the direction as a constant.
template <class F>
SERVOMILL_INLINE void about(int direction, F f) {
  if (direction == 0) {
    f(std::integral_constant<int, 0>());
  } else if (direction == 1) {
    f(std::integral_constant<int, 1>());
  } else {
    f(std::integral_constant<int, 2>());
  }
}

// Source: q(joint), cosine(joint), sine(joint), fault(step, q, fault).
template <class N, class Source, class T>
SERVOMILL_INLINE void go(const VolumetricProgram& program, std::size_t steps, Source& at,
                         T& tools) {
  const VolumetricStep* const end = program.steps + steps;
  for (const VolumetricStep* step = program.steps; step != end; ++step) {
    const std::size_t joint = step->joint;
    if (step->move == VolumetricMove::faulty_shift || step->move == VolumetricMove::fault) {
      const N q = at.q(joint);
      tools.fault(at.fault(*step, q), *step, q);
    } else if (step->move == VolumetricMove::shift) {
      const N q = at.q(joint);
      add(step->direction, q, tools.p.v);
      if constexpr (T::kHasIdeal) add(step->direction, q, tools.p_ideal.v);
    } else {
      const N c = at.cosine(joint), s = at.sine(joint);
      about(step->direction, [&](auto axis) {
        if (step->move == VolumetricMove::turn) {
          tools.turn(axis, c, s, step->centre);
        } else {
          tools.tilted_turn(axis, c, s, *step);
        }
        tools.ideal_turn(axis, c, s, step->centre);
      });
    }
  }
}

template <class N>
SERVOMILL_INLINE Vector<N> at_tip(const double* p_ST) {
  return {all<N>(p_ST[0]), all<N>(p_ST[1]), all<N>(p_ST[2])};
}

enum class Wanted { tool, error, offset };

// The first `size(wanted)` numbers of the result.
template <Wanted wanted, class N, class Source>
SERVOMILL_INLINE void solve(const VolumetricProgram& program, Source& at, const double* p_ST,
                            N* out) {
  constexpr bool kAxis = wanted != Wanted::offset, kIdeal = wanted != Wanted::tool;
  Tools<N, kAxis, kIdeal> tools;
  tools.p = tools.p_ideal = at_tip<N>(p_ST);
  tools.k = tools.k_ideal = {all<N>(0.0), all<N>(0.0), all<N>(1.0)};
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
      about(step.direction, [&](auto axis) { p = turned(axis, c, s, p); });
    }
  }
  for (int i = 0; i < 3; ++i) out[i] = p.v[i];
  if constexpr (kAxis) {
    for (int i = 0; i < 3; ++i) out[3 + i] = k.v[i];
  }
}

// --- one pose: axes in lanes --------------------------------------------------------------------

template <std::size_t first>
SERVOMILL_INLINE Register joints_in_lanes(const double* Q) {
  if constexpr (first + kRegister <= kMachineJoints) {
    return load(Q + first);
  } else {
    return lanes_from(
        [&](std::size_t lane) { return first + lane < kMachineJoints ? Q[first + lane] : 0.0; });
  }
}

// Harmonics and tables; lanes: joints.
void find_terms(const VolumetricProgram& program, const OnePoseData* data, const double* Q,
                VolumetricPower& terms) {
  if (data != nullptr) {
    terms = data->tables;
  } else {
    terms = {};
  }
  const VolumetricHarmonic* h = program.harmonics;
  const VolumetricHarmonic* const end = h + program.number_of_harmonics;
  for (std::size_t block = 0; block < program.wave_blocks; ++block) {
    const VolumetricWaves& waves = program.waves[block];
    LaneArray sines;
    for (std::size_t first = 0; first < kLaneWidth; first += kRegister) {
      const Register q = lanes_from([&](std::size_t lane) { return Q[waves.joint[first + lane]]; });
      store(sine<Register>(load(waves.omega, first) * q + load(waves.phase, first)), sines, first);
    }
    for (; h != end && h->wave / kLaneWidth == block; ++h) {
      double& sum = terms.e[h->component][h->joint];
      sum = fma(h->amplitude, sines[h->wave % kLaneWidth], sum);
    }
  }
}

// Faults of all joints, one of which is read where it lies.
struct OnePoseFaults {
  LaneArray w_[3], a_[3], h_[3];
};
struct FaultInMemory {
  const OnePoseFaults& all;
  std::size_t joint;

  SERVOMILL_INLINE const double& w(std::size_t i) const { return all.w_[i][joint]; }
  SERVOMILL_INLINE const double& a(std::size_t i) const { return all.a_[i][joint]; }
  SERVOMILL_INLINE const double& h(std::size_t i) const { return all.h_[i][joint]; }
};

struct OnePose {
  const OnePoseData* data;
  const double* Q;
  const OnePoseFaults& faults;

  SERVOMILL_INLINE double q(std::size_t joint) const { return Q[joint]; }
  SERVOMILL_INLINE double cosine(std::size_t joint) const { return data->cosine[joint]; }
  SERVOMILL_INLINE double sine(std::size_t joint) const { return data->sine[joint]; }
  SERVOMILL_INLINE FaultInMemory fault(const VolumetricStep& step, double) const {
    return {faults, step.joint};
  }
};

// False where the usual way does not lead to the end.
template <Way way, Wanted wanted>
SERVOMILL_INLINE bool try_one(const VolumetricProgram& program, const OnePoseData* data,
                              const double* Q, const double* p_ST, double* out) {
  VolumetricPower sums;
  if constexpr (way == Way::general) {
    if (program.has_terms) find_terms(program, data, Q, sums);
  }
  OnePoseFaults faults;
  Register t2_max{};
  repeat<(kMachineJoints + kRegister - 1) / kRegister>([&](auto block) {
    constexpr std::size_t first = block() * kRegister;
    if (first >= program.joints) return;
    const auto coefficient = [&](std::size_t power, std::size_t component) {
      return load(program.polynomial[power].e[component], first);
    };
    const auto terms = [&](std::size_t component) { return load(sums.e[component], first); };
    Fault f;
    find_fault<way>(program, program.has_angles, joints_in_lanes<first>(Q), coefficient, terms, f,
                    t2_max);
    repeat<3>([&](auto i) { store(f.w_[i], faults.w_[i], first); });
    if (!program.has_angles) return;
    repeat<3>([&](auto i) { store(f.a_[i], faults.a_[i], first); });
    repeat<3>([&](auto i) { store(f.h_[i], faults.h_[i], first); });
  });
  if (way == Way::usual && !are_small_turns(t2_max)) return false;
  OnePose at{data, Q, faults};
  solve<wanted>(program, at, p_ST, out);
  return true;
}

template <Wanted wanted>
[[gnu::noinline]] void one_in_general(const VolumetricProgram& program, const OnePoseData* data,
                                      const double* Q, const double* p_ST, double* out) {
  try_one<Way::general, wanted>(program, data, Q, p_ST, out);
}

template <Wanted wanted>
void one(const VolumetricProgram& program, const OnePoseData* data, const double* Q,
         const double* p_ST, double* out) {
  if (program.is_cubic && try_one<Way::usual, wanted>(program, data, Q, p_ST, out)) return;
  one_in_general<wanted>(program, data, Q, p_ST, out);
}

// --- many poses: poses in lanes -----------------------------------------------------------------

using ManyTerms = Register[kMachineJoints][kErrorComponents];

SERVOMILL_INLINE Register poses_in_lanes(const double* Q, std::size_t joint) {
  return lanes_from([&](std::size_t lane) { return Q[kMachineJoints * lane + joint]; });
}

void find_terms(const VolumetricProgram& program, const EightPosesData* data, std::size_t first,
                const double* Q, ManyTerms& terms) {
  for (std::size_t joint = 0; joint < program.joints; ++joint) {
    for (std::size_t c = 0; c < kErrorComponents; ++c) {
      terms[joint][c] = data != nullptr ? load(data->tables[joint].e[c], first) : Register{};
    }
  }
  const VolumetricHarmonic* h = program.harmonics;
  const VolumetricHarmonic* const end = h + program.number_of_harmonics;
  while (h != end) {
    const std::size_t wave = h->wave, lane = wave % kLaneWidth;
    const VolumetricWaves& waves = program.waves[wave / kLaneWidth];
    const Register q = poses_in_lanes(Q, h->joint);
    const Register value = sine<Register>(waves.omega[lane] * q + waves.phase[lane]);
    for (; h != end && h->wave == wave; ++h) {
      Register& sum = terms[h->joint][h->component];
      sum = fma(all<Register>(h->amplitude), value, sum);
    }
  }
}

template <Way way>
struct PosesInLanes {
  const VolumetricProgram& program;
  const EightPosesData* data;
  std::size_t first;  // of the eight
  const double* Q;    // of the first
  const ManyTerms* sums;
  Register t2_max;

  SERVOMILL_INLINE Register q(std::size_t joint) const { return poses_in_lanes(Q, joint); }
  SERVOMILL_INLINE Register cosine(std::size_t joint) const {
    return load(data->cosine[joint], first);
  }
  SERVOMILL_INLINE Register sine(std::size_t joint) const { return load(data->sine[joint], first); }
  SERVOMILL_INLINE Fault fault(const VolumetricStep& step, const Register& q) {
    const std::size_t joint = step.joint;
    const auto coefficient = [&](std::size_t power, std::size_t component) {
      return all<Register>(program.polynomial[power].e[component][joint]);
    };
    const auto terms = [&](std::size_t component) { return (*sums)[joint][component]; };
    Fault f;
    find_fault<way>(program, step.has_angles, q, coefficient, terms, f, t2_max);
    return f;
  }
};

template <Wanted wanted>
constexpr std::size_t kNumbers = wanted == Wanted::offset ? 3 : 6;

// False where the usual way does not lead to the end.
template <Way way, Wanted wanted>
SERVOMILL_INLINE bool try_many(const VolumetricProgram& program, const EightPosesData* data,
                               std::size_t first, const double* Q, const double* p_ST,
                               double* out) {
  ManyTerms sums;
  if constexpr (way == Way::general) {
    if (program.has_terms) find_terms(program, data, first, Q, sums);
  }
  PosesInLanes<way> at{program, data, first, Q, &sums, Register{}};
  Register result[kNumbers<wanted>];
  solve<wanted>(program, at, p_ST, result);
  if (way == Way::usual && !are_small_turns(at.t2_max)) return false;
  alignas(64) double lanes[kNumbers<wanted>][kRegister];
  for (std::size_t i = 0; i < kNumbers<wanted>; ++i) store(result[i], lanes[i]);
  for (std::size_t n = 0; n < kRegister; ++n) {
    for (std::size_t i = 0; i < kNumbers<wanted>; ++i) *out++ = lanes[i][n];
  }
  return true;
}

template <Wanted wanted>
[[gnu::noinline]] void many_in_general(const VolumetricProgram& program, const EightPosesData* data,
                                       std::size_t first, const double* Q, const double* p_ST,
                                       double* out) {
  try_many<Way::general, wanted>(program, data, first, Q, p_ST, out);
}

template <Wanted wanted>
void many(const VolumetricProgram& program, const EightPosesData* data, const double* Q,
          std::size_t blocks, const double* p_ST, double* out) {
  const std::size_t poses = blocks * kLaneWidth;
  for (std::size_t n = 0; n < poses; n += kRegister) {
    const EightPosesData* const block = data != nullptr ? data + n / kLaneWidth : nullptr;
    const std::size_t first = n % kLaneWidth;
    if (!(program.is_cubic && try_many<Way::usual, wanted>(program, block, first, Q, p_ST, out))) {
      many_in_general<wanted>(program, block, first, Q, p_ST, out);
    }
    Q += kMachineJoints * kRegister;
    out += kNumbers<wanted> * kRegister;
  }
}

}  // namespace

template <>
VolumetricKernel make_volumetric_kernel<SERVOMILL_LEVEL>() {
  return {&one<Wanted::tool>,  &one<Wanted::error>,  &one<Wanted::offset>,
          &many<Wanted::tool>, &many<Wanted::error>, &many<Wanted::offset>};
}

}  // namespace servomill::plant
