#include "controllers/path/barrier_kernel.h"

#include "plant/vocabulary/pack.h"

namespace servomill::controllers {
namespace {

constexpr double kIdle = 0.1;  // of a limit, below which it does not bend the search
constexpr double kLeastLoss = 1e-9;

template <class Arch>
struct Triple {
  Pack<Arch> v[3];
};

// S times the three coefficients of each point.
template <class Arch>
Triple<Arch> applied(const BarrierPoints& p, const double* c) {
  LaneArray c0, c1, c2;
  for (std::size_t n = 0; n < kLaneWidth; ++n) {
    const double* from = c + p.interval[n];
    c0[n] = from[0], c1[n] = from[1], c2[n] = from[2];
  }
  using P = Pack<Arch>;
  const P C0(c0), C1(c1), C2(c2);
  Triple<Arch> x;
  for (std::size_t i = 0; i < 3; ++i) {
    x.v[i] = P(p.S[i][0]) * C0 + P(p.S[i][1]) * C1 + P(p.S[i][2]) * C2;
  }
  return x;
}

template <class Arch>
double largest(const Pack<Arch>& x) {
  LaneArray all;
  x.store(all);
  double most = all[0];
  for (std::size_t n = 1; n < kLaneWidth; ++n) most = all[n] > most ? all[n] : most;
  return most;
}

// Coefficients of L and M of one joint at eight points.
template <class Arch>
struct JointTerms {
  using P = Pack<Arch>;
  P l0, l1, l2, m0, m1;

  JointTerms(const BarrierPoints& p, const BarrierJoints& joints, std::size_t k)
      : l0(p.j0[k]), l1(p.j1[k]), l2(p.j2[k]) {
    const P ratio(joints.ratio[k]);
    m0 = ratio * (P(2.0 / 3.0) * l1);
    m1 = ratio * (l2 + P(p.swell) * l0);
  }
  P L(const Triple<Arch>& x) const { return l0 * x.v[0] + l1 * x.v[1] + l2 * x.v[2]; }
  P M(const Triple<Arch>& x) const { return m0 * x.v[0] + m1 * x.v[1]; }
};

template <class Arch>
BarrierUse use(BarrierPoints* points, std::size_t count, const BarrierJoints& joints,
               const double* c) {
  using P = Pack<Arch>;
  P least(1e300), jerk(0.0), acceleration(0.0), speed(0.0);
  for (std::size_t n = 0; n < count; ++n) {
    BarrierPoints& p = points[n];
    const Triple<Arch> x = applied<Arch>(p, c);
    const P root = sqrt(max(x.v[0], P(1e-300)));
    least = min(least, x.v[0]);
    speed = max(speed, x.v[0] / P(p.b_top));
    put(p.time, P(p.length) / root);
    for (std::size_t k = 0; k < joints.count; ++k) {
      const JointTerms<Arch> q(p, joints, k);
      jerk = max(jerk, abs(q.L(x)) * root);
      acceleration = max(acceleration, abs(q.M(x)));
    }
  }
  return {-largest(-least), largest(jerk), largest(acceleration), largest(speed)};
}

// Derivatives by b, b' and b''.
template <class Arch>
struct Derivatives {
  using P = Pack<Arch>;
  P g0 = P(0.0), g1 = P(0.0), g2 = P(0.0);
  P h00 = P(0.0), h01 = P(0.0), h02 = P(0.0), h11 = P(0.0), h12 = P(0.0), h22 = P(0.0);

  // -weight log(1/sqrt(b) -+ L)
  void add_jerk(const JointTerms<Arch>& q, const P& L, const P& r, const P& r_b, const P& weight) {
    const P i = P(1.0) / ((r - L) * (r + L)), sum = P(2.0) * r * i;
    const P difference = P(-2.0) * L * i * weight;
    const P square = weight * (sum * sum - P(2.0) * i), cross = difference * sum * r_b;
    g0 -= weight * r_b * sum + difference * q.l0;
    g1 -= difference * q.l1;
    g2 -= difference * q.l2;
    const P s0 = square * q.l0 + cross, s1 = square * q.l1;
    h00 += square * r_b * r_b + (s0 + cross) * q.l0;
    h01 += s0 * q.l1;
    h02 += s0 * q.l2;
    h11 += s1 * q.l1;
    h12 += s1 * q.l2;
    h22 += square * q.l2 * q.l2;
  }
  // -weight log(1 -+ M)
  void add_acceleration(const JointTerms<Arch>& q, const P& M, const P& weight) {
    const P i = P(1.0) / ((P(1.0) - M) * (P(1.0) + M));
    const P d = P(-2.0) * M * i * weight, square = weight * i * (P(4.0) * i - P(2.0));
    g0 -= d * q.m0;
    g1 -= d * q.m1;
    const P s0 = square * q.m0;
    h00 += s0 * q.m0;
    h01 += s0 * q.m1;
    h11 += square * q.m1 * q.m1;
  }
  // To the coefficients: x = S c.
  void write(const BarrierPoints& p, BarrierTerms& out) const {
    P S[3][3], u[3][3];
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t i = 0; i < 3; ++i) S[i][j] = P(p.S[i][j]);
      put(out.g[j], g0 * S[0][j] + g1 * S[1][j] + g2 * S[2][j]);
      u[0][j] = h00 * S[0][j] + h01 * S[1][j] + h02 * S[2][j];
      u[1][j] = h01 * S[0][j] + h11 * S[1][j] + h12 * S[2][j];
      u[2][j] = h02 * S[0][j] + h12 * S[1][j] + h22 * S[2][j];
    }
    std::size_t n = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = i; j < 3; ++j) {
        put(out.h[n++], u[0][i] * S[0][j] + u[1][i] * S[1][j] + u[2][i] * S[2][j]);
      }
    }
  }
};

template <class Arch>
void derive(const BarrierPoints* points, std::size_t count, const BarrierJoints& joints,
            const double* c, double mu, BarrierTerms* out) {
  using P = Pack<Arch>;
  for (std::size_t n = 0; n < count; ++n) {
    const BarrierPoints& p = points[n];
    const Triple<Arch> x = applied<Arch>(p, c);
    for (std::size_t i = 0; i < 3; ++i) put(out[n].x[i], x.v[i]);
    const P b = x.v[0], r = P(1.0) / sqrt(b), r_b = P(-0.5) * r / b;
    const P weight = P(mu) * P(p.time), length(p.length);
    Derivatives<Arch> sum;
    const P top = P(1.0) / (P(p.b_top) - b);
    sum.g0 = length * r_b + weight * top;
    sum.h00 = P(-1.5) * length * r_b / b + weight * top * top;
    for (std::size_t k = 0; k < joints.count; ++k) {
      const JointTerms<Arch> q(p, joints, k);
      const P L = q.L(x), M = q.M(x);
      const auto jerks = abs(L) >= P(kIdle) * r, accelerates = abs(M) >= P(kIdle);
      if (jerks.any()) sum.add_jerk(q, L, r, r_b, select(jerks, weight, P(0.0)));
      if (accelerates.any()) sum.add_acceleration(q, M, select(accelerates, weight, P(0.0)));
    }
    sum.write(p, out[n]);
  }
}

template <class Arch>
double largest_loss(const BarrierPoints* points, std::size_t count, const BarrierJoints& joints,
                    const double* step, const BarrierTerms* terms) {
  using P = Pack<Arch>;
  P loss(kLeastLoss);
  for (std::size_t n = 0; n < count; ++n) {
    const BarrierPoints& p = points[n];
    const Triple<Arch> x = {{P(terms[n].x[0]), P(terms[n].x[1]), P(terms[n].x[2])}};
    const Triple<Arch> d = applied<Arch>(p, step);
    const P b = x.v[0], db = d.v[0], r = P(1.0) / sqrt(b), dr = P(-0.5) * r / b * db;
    loss = max(loss, max(-db / b, db / (P(p.b_top) - b)));
    for (std::size_t k = 0; k < joints.count; ++k) {
      const JointTerms<Arch> q(p, joints, k);
      const P L = q.L(x), dL = q.L(d), M = q.M(x), dM = q.M(d);
      if ((abs(dL) - dr > loss * (r - abs(L))).any()) {
        loss = max(loss, max((dL - dr) / (r - L), (-dL - dr) / (r + L)));
      }
      if ((abs(dM) > loss * (P(1.0) - abs(M))).any()) {
        loss = max(loss, max(dM / (P(1.0) - M), -dM / (P(1.0) + M)));
      }
    }
  }
  return largest(loss);
}

}  // namespace

template <>
BarrierKernel make_barrier_kernel<SERVOMILL_LEVEL>() {
  return {&use<SERVOMILL_ARCH>, &derive<SERVOMILL_ARCH>, &largest_loss<SERVOMILL_ARCH>};
}

}  // namespace servomill::controllers
