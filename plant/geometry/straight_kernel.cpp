#include "plant/geometry/straight_kernel.h"

#include <cstring>

#include "plant/geometry/volumetric_faults.h"

namespace servomill::plant {
namespace {

// Parts that the formulas omit for a machine that does not have them.
struct Parts {
  Way way;
  bool angles, levers, constants;
};
constexpr Parts kEverything = {Way::general, true, true, true};

// For a half rotation b, with t2 = |b|^2: (R - 1) u = a b x (u + b x u).
template <class N>
SERVOMILL_INLINE N small_half_turn_factor(const N& t2) {
  return fnma(t2, all<N>(8.0 / 6.0), all<N>(2.0));
}
constexpr double kSmallHalfTurn2 = 0.25 * kSmallTurn * kSmallTurn;
SERVOMILL_INLINE bool are_small_half_turns(double t2) { return !(t2 >= kSmallHalfTurn2); }
SERVOMILL_INLINE bool are_small_half_turns(const Register& t2) {
  return !xsimd::any(Batch(t2) >= Batch(kSmallHalfTurn2));
}
// Of whole turns that are small or not: where they are small, the bits of the short way.
SERVOMILL_INLINE TurnFactors<double> any_turn_factors(double t2) {
  if (t2 < kSmallTurn * kSmallTurn) return {fnma(t2, 1.0 / 6.0, 1.0), 0.5};
  return turn_factors(t2);
}
[[gnu::noinline]] TurnFactors<Register> any_turn_factors(const Register& t2) {
  return lane_by_lane(t2, [](double lane) { return any_turn_factors(lane); });
}
SERVOMILL_INLINE double larger(double a, double b) { return a > b ? a : b; }
SERVOMILL_INLINE Register larger(const Register& a, const Register& b) {
  return xsimd::max(Batch(a), Batch(b));
}
SERVOMILL_INLINE Pair larger(const Pair& a, const Pair& b) {
  return {larger(a.first, b.first), larger(a.second, b.second)};
}
SERVOMILL_INLINE bool are_small_half_turns(const Pair& t2) {
  return are_small_half_turns(larger(t2.first, t2.second));
}

// What of a and b x m is there last, and so comes last in a b x m: a for the first axis, whose tip
// is known from the beginning, m for those behind it.
constexpr bool is_factor_last(std::size_t axis) { return axis == 0; }

// --- the formulas, of one pose (N: double) or of poses in lanes (N: Register, Pair) -------------

// Powers of q beyond the zeroth. values(power): coefficients along three directions.
template <Parts has, class N, class F>
SERVOMILL_INLINE Vector<N> slope(const StraightProgram& program, const N& q, F values) {
  const std::size_t degree = has.way == Way::cubic ? 3 : program.functions.degree;
  const auto first = values(degree);
  Vector<N> p{all<N>(first[0]), all<N>(first[1]), all<N>(first[2])};
  const auto add = [&](std::size_t power) SERVOMILL_INLINE_LAMBDA {
    const auto c = values(power);
    repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA { p.v[i] = fma(p.v[i], q, all<N>(c[i])); });
  };
  if constexpr (has.way == Way::cubic) {
    add(2);
    add(1);
  } else {
    for (std::size_t power = degree - 1; power > 0; --power) add(power);
  }
  return p;
}

// The deviation D behind an axis. terms(component): of harmonics and tables. t2_max: of all axes so
// far, squares of half their turns.
template <Parts has, std::size_t axis, class N, class Terms>
SERVOMILL_INLINE void pass(const StraightProgram& program, const N& q, const Vector<N>& P,
                           Terms terms, Vector<N>& D, N& t2_max) {
  const StraightPower* const powers = program.powers;
  Vector<N> u = P;
  if constexpr (has.levers) {
    const StraightLever& lever = program.levers[axis];
    repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA {
      u.v[i] = u.v[i] + fms(q, all<N>(lever.slope[i]), all<N>(lever.centre[i]));
    });
  }
  if constexpr (axis > 0) {
    repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA { u.v[i] = u.v[i] + D.v[i]; });
  }
  // q times slope, the constant, and D
  const auto value = [&](const N& slope_i, double constant, std::size_t component,
                         const N* before) SERVOMILL_INLINE_LAMBDA {
    if constexpr (has.way == Way::cubic) {
      if constexpr (!has.constants) {
        return before != nullptr ? fma(slope_i, q, *before) : slope_i * q;
      }
      return fma(slope_i, q, before != nullptr ? *before + constant : all<N>(constant));
    } else {
      const N sum = terms(axis, component) + constant;
      return fma(slope_i, q, before != nullptr ? *before + sum : sum);
    }
  };
  // what is needed first stands first, as a processor looks ahead only so far
  Vector<N> b, m;
  N a;
  if constexpr (has.angles) {
    b = slope<has>(program, q, [&](std::size_t power) SERVOMILL_INLINE_LAMBDA {
      return powers[power].half_turn[axis];
    });
    repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA {
      b.v[i] = value(b.v[i], powers[0].half_turn[axis][i], 3 + i, nullptr);
    });
    const N t2 = fma(b.v[2], b.v[2], fma(b.v[1], b.v[1], b.v[0] * b.v[0]));
    t2_max = larger(t2_max, t2);
    a = small_half_turn_factor(t2);
    if constexpr (has.way == Way::general) {
      const auto exact = any_turn_factors(4.0 * t2);
      a = exact.a / exact.h;  // of the b that follows
      repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA { b.v[i] = b.v[i] * (2.0 * exact.h); });
    }
    m = plus_cross(u, b, u);
  }
  const Vector<N> w = slope<has>(program, q, [&](std::size_t power) SERVOMILL_INLINE_LAMBDA {
    return powers[power].shift[axis];
  });
  repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA {
    D.v[i] = value(w.v[i], powers[0].shift[axis][i], i, axis > 0 ? &D.v[i] : nullptr);
  });
  if constexpr (has.angles) {
    if constexpr (is_factor_last(axis)) {
      const Vector<N> c = cross(b, m);
      repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA { D.v[i] = fma(a, c.v[i], D.v[i]); });
    } else {
      repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA { b.v[i] = a * b.v[i]; });
      D = plus_cross(D, b, m);
    }
  }
}

struct NoTerms {};

// False where this way does not lead to the end. P: the tip before it passes the first axis.
template <Parts has, class N, class Terms>
SERVOMILL_INLINE bool try_offset(const StraightProgram& program, const Vector<N>& q, Vector<N> P,
                                 Terms terms, Vector<N>& D) {
  N t2_max{};
  pass<has, 0>(program, q.v[0], P, terms, D, t2_max);
  P.v[0] = P.v[0] + q.v[0];
  pass<has, 1>(program, q.v[1], P, terms, D, t2_max);
  P.v[1] = P.v[1] + q.v[1];
  pass<has, 2>(program, q.v[2], P, terms, D, t2_max);
  return has.way == Way::general || !has.angles || are_small_half_turns(t2_max);
}

// --- one pose -----------------------------------------------------------------------------------

// Numbers along X, Y, Z in the order of the axes.
SERVOMILL_INLINE Vector<double> in_order(const StraightProgram& program, const double* xyz) {
  return {xyz[program.joint[0]], xyz[program.joint[1]], xyz[program.joint[2]]};
}

template <Parts has>
SERVOMILL_INLINE bool try_one(const StraightProgram& program, const VolumetricPower* tables,
                              const double* tip, const double* Q, double* out) {
  const Vector<double> q = in_order(program, Q), P = in_order(program, tip);
  Vector<double> D;
  bool is_done;
  if constexpr (has.way == Way::cubic) {
    is_done = try_offset<has>(program, q, P, NoTerms(), D);
  } else {
    VolumetricPower sums;
    find_terms(program.functions, tables, q.v, sums);
    const auto terms = [&](std::size_t axis, std::size_t component)
                           SERVOMILL_INLINE_LAMBDA { return sums.e[component][axis]; };
    is_done = try_offset<has>(program, q, P, terms, D);
  }
  repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA { out[program.joint[i]] = D.v[i]; });
  return is_done;
}

[[gnu::noinline]] void one_in_general(const StraightProgram& program, const VolumetricPower* tables,
                                      const double* tip, const double* Q, double* out) {
  try_one<kEverything>(program, tables, tip, Q, out);
}

#ifdef __FMA__
// The same with directions in lanes. The fourth lane is not used.
using Four [[gnu::vector_size(4 * sizeof(double))]] = double;

SERVOMILL_INLINE Four fma4(const Four& a, const Four& b, const Four& c) {
  return _mm256_fmadd_pd(a, b, c);
}
SERVOMILL_INLINE Four fnma4(const Four& a, const Four& b, const Four& c) {
  return _mm256_fnmadd_pd(a, b, c);
}
SERVOMILL_INLINE Four load4(const double* from) { return _mm256_loadu_pd(from); }
SERVOMILL_INLINE Four all4(double value) { return _mm256_set1_pd(value); }

SERVOMILL_INLINE Four from_next(const Four& v) {  // y z x
  return __builtin_shufflevector(v, v, 1, 2, 0, 3);
}
SERVOMILL_INLINE Four from_last(const Four& v) {  // z x y
  return __builtin_shufflevector(v, v, 2, 0, 1, 3);
}
template <std::size_t lane>
SERVOMILL_INLINE Four everywhere(const Four& v) {
  return __builtin_shufflevector(v, v, lane, lane, lane, lane);
}

// Axes in lanes.
SERVOMILL_INLINE Four squares(const Four& b0, const Four& b1, const Four& b2) {
  const Four xz = __builtin_shufflevector(b0, b1, 0, 4, 2, 6);
  const Four y01 = __builtin_shufflevector(b0, b1, 1, 5, 3, 7);
  const Four x = __builtin_shufflevector(xz, b2, 0, 1, 4, 5);
  const Four y =
      __builtin_shufflevector(y01, __builtin_shufflevector(b2, b2, 1, 0, 3, 2), 0, 1, 4, 5);
  const Four z = __builtin_shufflevector(xz, b2, 2, 3, 6, 7);
  return fma4(z, z, fma4(y, y, x * x));
}

struct Cross {
  Four from_next_, from_last_;
  SERVOMILL_INLINE Cross(const Four& next, const Four& last) : from_next_(next), from_last_(last) {}
  SERVOMILL_INLINE explicit Cross(const Four& b) : Cross(from_next(b), from_last(b)) {}
  SERVOMILL_INLINE Cross times(const Four& a) const { return {a * from_next_, a * from_last_}; }
  SERVOMILL_INLINE Four plus(const Four& v, const Four& u) const {
    return fma4(from_next_, from_last(u), fnma4(from_last_, from_next(u), v));
  }
  SERVOMILL_INLINE Four of(const Four& u) const {
    return fnma4(from_last_, from_next(u), from_next_ * from_last(u));
  }
};

template <Parts has>
SERVOMILL_INLINE Four cubic_value(const double* c3, const double* c2, const double* c1,
                                  const double* c0, const Four& q, const Four* before) {
  const Four slope = fma4(fma4(load4(c3), q, load4(c2)), q, load4(c1));
  if constexpr (!has.constants) return before != nullptr ? fma4(slope, q, *before) : slope * q;
  return fma4(slope, q, before != nullptr ? *before + load4(c0) : load4(c0));
}

template <Parts has>
SERVOMILL_INLINE bool try_cubic(const StraightProgram& program, const double* tip, const double* Q,
                                double* out) {
  const StraightPower* const p = program.powers;
  const std::size_t j0 = program.joint[0], j1 = program.joint[1], j2 = program.joint[2];
  const Four q0 = all4(Q[j0]), q1 = all4(Q[j1]), q2 = all4(Q[j2]);
  const auto half_turn = [&](auto axis, const Four& q) SERVOMILL_INLINE_LAMBDA {
    return cubic_value<has>(p[3].half_turn[axis], p[2].half_turn[axis], p[1].half_turn[axis],
                            p[0].half_turn[axis], q, nullptr);
  };
  const auto shift = [&](auto axis, const Four& q, const Four* D) SERVOMILL_INLINE_LAMBDA {
    return cubic_value<has>(p[3].shift[axis], p[2].shift[axis], p[1].shift[axis], p[0].shift[axis],
                            q, D);
  };
  const auto lever = [&](auto axis, const Four& q, const Four& P) SERVOMILL_INLINE_LAMBDA -> Four {
    if constexpr (!has.levers) return P;
    return P + _mm256_fmsub_pd(q, load4(program.levers[axis].slope),
                               load4(program.levers[axis].centre));
  };
  constexpr std::integral_constant<std::size_t, 0> first;
  constexpr std::integral_constant<std::size_t, 1> second;
  constexpr std::integral_constant<std::size_t, 2> third;
  const Four b0 = half_turn(first, q0), b1 = half_turn(second, q1), b2 = half_turn(third, q2);
  const Four t2 = squares(b0, b1, b2);
  const Four a = fnma4(t2, all4(8.0 / 6.0), all4(2.0));
  const Cross c0(b0), c1(b1), c2(b2);

  const Four P0 = {tip[j0], tip[j1], tip[j2], 0.0};
  const Four u0 = lever(first, q0, P0);
  const Four D0 = fma4(everywhere<0>(a), c0.of(c0.plus(u0, u0)), shift(first, q0, nullptr));

  const Four P1 = P0 + __builtin_shufflevector(Four{}, q0, 4, 1, 2, 3);
  const Four u1 = lever(second, q1, P1) + D0;
  const Four D1 = c1.times(everywhere<1>(a)).plus(shift(second, q1, &D0), c1.plus(u1, u1));

  const Four P2 = P1 + __builtin_shufflevector(Four{}, q1, 0, 5, 2, 3);
  const Four u2 = lever(third, q2, P2) + D1;
  const Four D = c2.times(everywhere<2>(a)).plus(shift(third, q2, &D1), c2.plus(u2, u2));
  out[j0] = D[0];
  out[j1] = D[1];
  out[j2] = D[2];
  return _mm256_testz_pd(_mm256_cmp_pd(t2, all4(0.25 * kSmallTurn * kSmallTurn), _CMP_GE_OQ),
                         all4(-1.0)) != 0;
}
#endif

template <Parts has>
void one(const StraightProgram& program, const VolumetricPower* tables, const double* tip,
         const double* Q, double* out) {
  bool is_done;
#ifdef __FMA__
  if constexpr (has.way == Way::cubic && has.angles) {
    is_done = try_cubic<has>(program, tip, Q, out);
  } else
#endif
  {
    is_done = try_one<has>(program, tables, tip, Q, out);
  }
  if (!is_done) one_in_general(program, tables, tip, Q, out);
}

// --- many poses in lanes ------------------------------------------------------------------------

// Numbers of poses, a row for each axis in the order of the axes.
struct Rows {
  const double* q[kStraightAxes];
  double* D[kStraightAxes];  // along their directions
};

template <class N>
SERVOMILL_INLINE Vector<N> load_rows(const double* const (&rows)[kStraightAxes], std::size_t n) {
  return {load_number<N>(rows[0] + n), load_number<N>(rows[1] + n), load_number<N>(rows[2] + n)};
}

// The tips of poses from n on.
template <class N>
SERVOMILL_INLINE Vector<N> tips(const StraightProgram& program, const StraightData* data,
                                const double* tip, std::size_t n) {
  const std::size_t j0 = program.joint[0], j1 = program.joint[1], j2 = program.joint[2];
  if (data == nullptr) return {all<N>(tip[j0]), all<N>(tip[j1]), all<N>(tip[j2])};
  return load_rows<N>({&data->tip[j0][0], &data->tip[j1][0], &data->tip[j2][0]}, n);
}

// Poses from n on, as many as N has lanes. Writes what it finds in any case: without that the
// compiler would put off half of the work until it knows the answer.
template <class N, Parts has>
SERVOMILL_INLINE bool try_rows(const StraightProgram& program, const StraightData* data,
                               const double* tip, std::size_t n, const Rows& rows) {
  const Vector<N> q = load_rows<N>(rows.q, n), P = tips<N>(program, data, tip, n);
  Vector<N> D;
  bool is_done;
  if constexpr (has.way == Way::cubic) {
    is_done = try_offset<has>(program, q, P, NoTerms(), D);
  } else {
    Register sums[kStraightAxes][kErrorComponents];
    find_terms(program.functions, data != nullptr ? data->tables : nullptr, n, q.v, sums);
    const auto terms =
        [&](std::size_t axis, std::size_t component)
            SERVOMILL_INLINE_LAMBDA -> const Register& { return sums[axis][component]; };
    is_done = try_offset<has>(program, q, P, terms, D);
  }
  repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA { store(D.v[i], rows.D[i] + n); });
  return is_done;
}

[[gnu::noinline]] void rows_in_general(const StraightProgram& program, const StraightData* data,
                                       const double* tip, std::size_t n, const Rows& rows) {
  try_rows<Register, kEverything>(program, data, tip, n, rows);
}

// All `poses`, a multiple of eight; eight where there are data.
template <Parts has>
SERVOMILL_INLINE void solve_rows(const StraightProgram& program, const StraightData* data,
                                 const double* tip, std::size_t poses, const Rows& rows) {
  std::size_t n = 0;
  if constexpr (has.way == Way::cubic) {
    for (; data == nullptr && n + 2 * kRegister <= poses; n += 2 * kRegister) {
      if (try_rows<Pair, has>(program, nullptr, tip, n, rows)) continue;
      rows_in_general(program, nullptr, tip, n, rows);
      rows_in_general(program, nullptr, tip, n + kRegister, rows);
    }
  }
  for (; n < poses; n += kRegister) {
    if (!try_rows<Register, has>(program, data, tip, n, rows)) {
      rows_in_general(program, data, tip, n, rows);
    }
  }
}

template <Parts has>
void lanes(const StraightProgram& program, const StraightData* data, const double* tip,
           const LaneArray* Q, LaneArray* out) {
  const std::size_t j0 = program.joint[0], j1 = program.joint[1], j2 = program.joint[2];
  solve_rows<has>(program, data, tip, kLaneWidth,
                  {{&Q[j0][0], &Q[j1][0], &Q[j2][0]}, {&out[j0][0], &out[j1][0], &out[j2][0]}});
}

// --- poses one behind the other -----------------------------------------------------------------

// X, Y, Z of one pose and the number behind them.
using Pose [[gnu::vector_size(4 * sizeof(double))]] = double;

#if defined(__AVX__)
// Four, or two times four, transposed: pairs of poses first, then pairs of pairs.
SERVOMILL_INLINE Pose pose_at(const double* Q) {
  Pose P;
  std::memcpy(&P, Q, sizeof P);
  return P;
}
#if defined(__AVX512F__)
SERVOMILL_INLINE void take_poses(const double* Q, Register (&xyz)[3]) {
  // X Y Z - - X Y Z: two poses, without what lies behind the last
  const auto two = [Q](std::size_t n) { return load(Q + kMachineJoints * n); };
  const Register p01 = two(0), p23 = two(2), p45 = two(4), p67 = two(6);
  const Register xy_low = __builtin_shufflevector(p01, p23, 0, 5, 8, 13, 1, 6, 9, 14);
  const Register xy_high = __builtin_shufflevector(p45, p67, 0, 5, 8, 13, 1, 6, 9, 14);
  const Register z_low = __builtin_shufflevector(p01, p23, 2, 7, 10, 15, 2, 7, 10, 15);
  const Register z_high = __builtin_shufflevector(p45, p67, 2, 7, 10, 15, 2, 7, 10, 15);
  xyz[0] = __builtin_shufflevector(xy_low, xy_high, 0, 1, 2, 3, 8, 9, 10, 11);
  xyz[1] = __builtin_shufflevector(xy_low, xy_high, 4, 5, 6, 7, 12, 13, 14, 15);
  xyz[2] = __builtin_shufflevector(z_low, z_high, 0, 1, 2, 3, 12, 13, 14, 15);
}
#else
SERVOMILL_INLINE void take_poses(const double* Q, Register (&xyz)[3]) {
  const auto at = [Q](std::size_t n) { return pose_at(Q + kMachineJoints * n); };
  const Register p0 = at(0), p1 = at(1), p2 = at(2), p3 = at(3);
  const Register xz_low = __builtin_shufflevector(p0, p1, 0, 4, 2, 6);
  const Register xz_high = __builtin_shufflevector(p2, p3, 0, 4, 2, 6);
  const Register y_low = __builtin_shufflevector(p0, p1, 1, 5, 3, 7);
  const Register y_high = __builtin_shufflevector(p2, p3, 1, 5, 3, 7);
  xyz[0] = __builtin_shufflevector(xz_low, xz_high, 0, 1, 4, 5);
  xyz[1] = __builtin_shufflevector(y_low, y_high, 0, 1, 4, 5);
  xyz[2] = __builtin_shufflevector(xz_low, xz_high, 2, 3, 6, 7);
}
#endif
#else
SERVOMILL_INLINE void take_poses(const double* Q, Register (&xyz)[3]) {
  repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA {
    xyz[i] = lanes_from([&](std::size_t lane) { return Q[kMachineJoints * lane + i]; });
  });
}
#endif

// Number `flat` of the poses one behind the other: among the lanes of X and Y, or of those and Z.
constexpr int place_in_xy(std::size_t flat) {
  const std::size_t direction = flat % 3;
  return static_cast<int>(direction == 2 ? 0 : direction * kRegister + flat / 3);
}
constexpr int place_in_xyz(std::size_t flat, std::size_t lane) {
  return static_cast<int>(flat % 3 == 2 ? kRegister + flat / 3 : lane);
}

template <std::size_t... lane>
SERVOMILL_INLINE void put_poses(const Register (&xyz)[3], double* out,
                                std::index_sequence<lane...>) {
  repeat<3>([&](auto part) SERVOMILL_INLINE_LAMBDA {
    constexpr std::size_t first = part() * kRegister;
    const Register xy = __builtin_shufflevector(xyz[0], xyz[1], place_in_xy(first + lane)...);
    store(__builtin_shufflevector(xy, xyz[2], place_in_xyz(first + lane, lane)...), out + first);
  });
}

// Many at a time: each of the three loops keeps the processor busy by itself.
template <Parts has>
void many(const StraightProgram& program, const StraightData* data, const double* tip,
          const double* Q, std::size_t blocks, double* out) {
  constexpr std::size_t kAtATime = 4 * kLaneWidth;
  const std::size_t j0 = program.joint[0], j1 = program.joint[1], j2 = program.joint[2];
  alignas(64) double q[3][kAtATime], D[3][kAtATime];  // X, Y, Z
  const Rows rows{{q[j0], q[j1], q[j2]}, {D[j0], D[j1], D[j2]}};
  for (std::size_t left = blocks * kLaneWidth; left > 0;) {
    const std::size_t poses = left < kAtATime ? left : kAtATime;
    Register xyz[3];
    for (std::size_t n = 0; n < poses; n += kRegister) {
      take_poses(Q + kMachineJoints * n, xyz);
      repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA { store(xyz[i], q[i] + n); });
    }
    solve_rows<has>(program, data, tip, poses, rows);
    for (std::size_t n = 0; n < poses; n += kRegister) {
      repeat<3>([&](auto i) SERVOMILL_INLINE_LAMBDA { xyz[i] = load(D[i] + n); });
      put_poses(xyz, out + 3 * n, std::make_index_sequence<kRegister>());
    }
    Q += kMachineJoints * poses;
    out += 3 * poses;
    left -= poses;
  }
}

template <Parts has>
StraightKernel kernel() {
  return {&one<has>, &many<has>, &lanes<has>};
}

}  // namespace

template <>
StraightKernel make_straight_kernel<SERVOMILL_LEVEL>(const StraightProgram& of) {
  if (!of.functions.is_cubic) {
    return of.functions.has_angles ? kernel<Parts{Way::small, true, true, true}>()
                                   : kernel<Parts{Way::small, false, false, true}>();
  }
  if (!of.functions.has_angles) return kernel<Parts{Way::cubic, false, false, true}>();
  if (of.has_levers) {
    return of.has_constants ? kernel<Parts{Way::cubic, true, true, true}>()
                            : kernel<Parts{Way::cubic, true, true, false}>();
  }
  return of.has_constants ? kernel<Parts{Way::cubic, true, false, true}>()
                          : kernel<Parts{Way::cubic, true, false, false}>();
}

}  // namespace servomill::plant
