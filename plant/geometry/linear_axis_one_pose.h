/// The linear-axis kernel for one pose: with directions in lanes where the processor has FMA. Only
/// that kernel includes this.
#pragma once

#include <cstddef>
#include <type_traits>

#include "plant/geometry/linear_axis_formulas.h"

namespace servomill::plant {
namespace {  // one copy for each instruction set

// Numbers along X, Y, Z in the order of the axes.
SERVOMILL_INLINE Vector<double> in_order(const LinearAxisProgram& program, const double* xyz) {
  return {xyz[program.joint[0]], xyz[program.joint[1]], xyz[program.joint[2]]};
}

template <Parts has>
SERVOMILL_INLINE bool try_one(const LinearAxisProgram& program, const VolumetricPower* tables,
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

[[gnu::noinline]] void one_in_general(const LinearAxisProgram& program,
                                      const VolumetricPower* tables, const double* tip,
                                      const double* Q, double* out) {
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
SERVOMILL_INLINE bool try_cubic(const LinearAxisProgram& program, const double* tip,
                                const double* Q, double* out) {
  const LinearAxisPower* const p = program.powers;
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
void one(const LinearAxisProgram& program, const VolumetricPower* tables, const double* tip,
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

}  // namespace
}  // namespace servomill::plant
