/// Collocation of the force against a slide over a sub-step: the formulas that one lane
/// (exact_step.cpp) and eight (drive_kernel.cpp) share. T is the number, P the friction
/// (friction.h).
///
/// Over a sub-step of length h the force is the parabola through its values at 0, h/2, h (Lobatto
/// IIIA). A linear drive answers with v at h/2 and h, v_j = y_j + C_j1 f_1 + C_j2 f_2, and f is the
/// friction of these v; Newton's iteration finds both.
#pragma once

#include "plant/drives/friction.h"
#include "plant/vocabulary/numbers.h"

namespace servomill::plant {

/// Integrals of the parabolas that are 1 at one of 0, 1/2, 1 and 0 at the others: from 0 to 1/4,
/// 1/2, 3/4, 1; and their values at 1/4, 3/4. (Not inline: kernels share no data, either.)
constexpr double kIntegral[4][3] = {{1.0 / 6.0, 5.0 / 48.0, -1.0 / 48.0},
                                    {5.0 / 24.0, 1.0 / 3.0, -1.0 / 24.0},
                                    {3.0 / 16.0, 9.0 / 16.0, 0.0},
                                    {1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0}};
constexpr double kQuarter[2][3] = {{0.375, 0.75, -0.125}, {-0.125, 0.75, 0.375}};

/// Sum of three values by their weights.
template <class T>
T parabola(const double (&weight)[3], const T (&value)[3]) {
  return fma(T(weight[2]), value[2], fma(T(weight[1]), value[1], T(weight[0]) * value[0]));
}

template <class T>
struct Matrix2 {
  T a, b, c, d;  // row after row
};

/// The same where each node has its own.
template <class T>
struct Diagonal2 {
  T a, d;
};

/// The force at h/2 and h, and its derivatives by the speeds there.
template <class T>
struct NodeForces {
  T f[2];           // N
  Diagonal2<T> df;  // N s/m
};

/// With bristles a node feels the other, too; their rates with the same derivatives.
template <class T>
struct BristleForces {
  T f[2];            // N
  Matrix2<T> df;     // N s/m
  T rate[2];         // dz/dt, m/s
  Matrix2<T> drate;  // 1
};

/// Regularised friction at the nodes.
template <class P, class T>
NodeForces<T> regularised_at(const P& p, const T (&v)[2]) {
  const WithSlope<T> half = regularised(p, v[0]), end = regularised(p, v[1]);
  return {{half.value, end.value}, {half.slope, end.slope}};
}

/// LuGre at the nodes: dz/dt = v - a(v) z there, z by its collocation, which is linear in z.
/// @param z, rate  at the start of the sub-step
template <class P, class T>
BristleForces<T> bristles_at(const P& p, const T& z0, const T& rate0, const T& h, const T (&v)[2]) {
  const T one(1.0), zero(0.0);
  const auto weight = [&](int node, int j) { return h * T(kIntegral[node][j]); };
  const Matrix2<T> C = {weight(1, 1), weight(1, 2), weight(3, 1), weight(3, 2)};
  T a[2], slope[2];  // a(v), da/dv
  for (int j = 0; j < 2; ++j) {
    const auto forwards = v[j] >= zero;
    const WithSlope<T> g = sliding(p, forwards, v[j]);
    const T inverse = one / g.value, away = select(forwards, one, -one), speed = away * v[j];
    a[j] = p.sigma0 * speed * inverse;
    slope[j] = p.sigma0 * (away - speed * g.slope * inverse) * inverse;
  }
  const T known[2] = {fma(weight(1, 0), rate0, z0) + C.a * v[0] + C.b * v[1],
                      fma(weight(3, 0), rate0, z0) + C.c * v[0] + C.d * v[1]};
  // (1 + C a) z = known
  const Matrix2<T> M = {one + C.a * a[0], C.b * a[1], C.c * a[0], one + C.d * a[1]};
  const T factor = one / (M.a * M.d - M.b * M.c);
  const Matrix2<T> inverse = {M.d * factor, -M.b * factor, -M.c * factor, M.a * factor};
  const T z[2] = {inverse.a * known[0] + inverse.b * known[1],
                  inverse.c * known[0] + inverse.d * known[1]};
  // d(rate)/dv = direct - a dz/dv,   dz/dv = (1 + C a)^-1 C direct
  const T direct[2] = {one - slope[0] * z[0], one - slope[1] * z[1]};
  const Matrix2<T> dz = {(inverse.a * C.a + inverse.b * C.c) * direct[0],
                         (inverse.a * C.b + inverse.b * C.d) * direct[1],
                         (inverse.c * C.a + inverse.d * C.c) * direct[0],
                         (inverse.c * C.b + inverse.d * C.d) * direct[1]};
  BristleForces<T> out;
  out.drate = {direct[0] - a[0] * dz.a, -a[0] * dz.b, -a[1] * dz.c, direct[1] - a[1] * dz.d};
  out.df = {p.sigma0 * dz.a + p.sigma1 * out.drate.a, p.sigma0 * dz.b + p.sigma1 * out.drate.b,
            p.sigma0 * dz.c + p.sigma1 * out.drate.c, p.sigma0 * dz.d + p.sigma1 * out.drate.d};
  for (int j = 0; j < 2; ++j) {
    out.rate[j] = v[j] - a[j] * z[j];
    out.f[j] = p.sigma0 * z[j] + p.sigma1 * out.rate[j];
  }
  return out;
}

/// 1 - C df.
template <class T>
Matrix2<T> newton_matrix(const Matrix2<T>& C, const Matrix2<T>& df) {
  const T one(1.0);
  return {one - fma(C.a, df.a, C.b * df.c), -fma(C.a, df.b, C.b * df.d),
          -fma(C.c, df.a, C.d * df.c), one - fma(C.c, df.b, C.d * df.d)};
}
template <class T>
Matrix2<T> newton_matrix(const Matrix2<T>& C, const Diagonal2<T>& df) {
  const T one(1.0);
  return {fma(-C.a, df.a, one), -(C.b * df.d), -(C.c * df.a), fma(-C.d, df.d, one)};
}

/// Newton's correction of v: (1 - C df) dv = residual.
template <class T, class Derivative>
void newton(const Matrix2<T>& C, const Derivative& df, const T (&residual)[2], T (&dv)[2]) {
  const Matrix2<T> J = newton_matrix(C, df);
  const T factor = T(1.0) / fma(J.a, J.d, -(J.b * J.c));
  dv[0] = fma(J.d, residual[0], -(J.b * residual[1])) * factor;
  dv[1] = fma(J.a, residual[1], -(J.c * residual[0])) * factor;
}

/// value + derivative dv.
template <class T>
void follow(T (&value)[2], const Matrix2<T>& derivative, const T (&dv)[2]) {
  value[0] += fma(derivative.a, dv[0], derivative.b * dv[1]);
  value[1] += fma(derivative.c, dv[0], derivative.d * dv[1]);
}
template <class T>
void follow(T (&value)[2], const Diagonal2<T>& derivative, const T (&dv)[2]) {
  value[0] = fma(derivative.a, dv[0], value[0]);
  value[1] = fma(derivative.d, dv[1], value[1]);
}

/// How long the servo loop leaves an error of speed standing (s).
inline constexpr double kMemory = 5e-3;

/// Error of a parabola through `nodes` against a and b at h/4 and 3h/4, as its effect over a
/// sub-step. A cubic miss moves the slide only within the sub-step, a quartic one changes its
/// speed. Factors: integrals of s (s - 1/2) (s - 1), times (1 - s), and of s (s - 1/2)^2 (s - 1),
/// over their values at 1/4.
template <class T>
T missed(const T& a, const T& b, const T (&nodes)[3], const T& cubic, const T& quartic) {
  constexpr double kCubic = 0.5 * 8.0 / 45.0, kQuartic = 0.5 * 32.0 / 45.0;
  const T A = a - parabola(kQuarter[0], nodes), B = b - parabola(kQuarter[1], nodes);
  return T(kCubic) * cubic * max(A - B, B - A) + T(kQuartic) * quartic * max(A + B, -(A + B));
}

/// The most that `missed` returns if the parabola misses no more than `most` at h/4 and 3h/4.
template <class T>
T missed_at_most(const T& most, const T& cubic, const T& quartic) {
  constexpr double kCubic = 8.0 / 45.0, kQuartic = 32.0 / 45.0;
  return most * max(T(kCubic) * cubic, T(kQuartic) * quartic);
}

}  // namespace servomill::plant
