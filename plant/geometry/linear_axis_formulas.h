/// The deviation of the tool behind three linear axes: formulas of the linear-axis kernel, for one
/// pose and for poses in lanes. Only that kernel includes this.
#pragma once

#include <cstddef>

#include "plant/geometry/geometric_errors_kernel.h"
#include "plant/geometry/linear_axis_kernel.h"

namespace servomill::plant {
namespace {  // one copy for each instruction set

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
// Factors of whole turns, small or not: where they are small, the bits of the short way.
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

// The factor of a b x m that is known last comes last: a for the first axis, whose tip is known
// from the beginning, m for the axes after it.
constexpr bool is_factor_last(std::size_t axis) { return axis == 0; }

// The formulas, of one pose (N: double) or of poses in lanes (N: Register, Pair).

// Powers of q beyond the zeroth. values(power): coefficients along three directions.
template <Parts has, class N, class F>
SERVOMILL_INLINE Vector<N> slope(const LinearAxisProgram& program, const N& q, F values) {
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
SERVOMILL_INLINE void pass(const LinearAxisProgram& program, const N& q, const Vector<N>& P,
                           Terms terms, Vector<N>& D, N& t2_max) {
  const LinearAxisPower* const powers = program.powers;
  Vector<N> u = P;
  if constexpr (has.levers) {
    const LinearAxisLever& lever = program.levers[axis];
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
SERVOMILL_INLINE bool try_offset(const LinearAxisProgram& program, const Vector<N>& q, Vector<N> P,
                                 Terms terms, Vector<N>& D) {
  N t2_max{};
  pass<has, 0>(program, q.v[0], P, terms, D, t2_max);
  P.v[0] = P.v[0] + q.v[0];
  pass<has, 1>(program, q.v[1], P, terms, D, t2_max);
  P.v[1] = P.v[1] + q.v[1];
  pass<has, 2>(program, q.v[2], P, terms, D, t2_max);
  return has.way == Way::general || !has.angles || are_small_half_turns(t2_max);
}

}  // namespace
}  // namespace servomill::plant
