#include "controllers/path/barrier_kernel.h"

#include "plant/vocabulary/pack.h"

namespace servomill::controllers {
namespace {

constexpr double kIdle = 0.1;  // of a limit, below which it does not bend the search
constexpr double kMinLoss = 1e-9;
constexpr double kMinLength = 1e-12;  // m, for which a point stands

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

// Each of eight numbers three times, one after the other: the third of them with that index.
template <std::size_t third, class Arch>
Pack<Arch> spread(const Pack<Arch>& x) {
#ifdef __AVX512F__
  if constexpr (Pack<Arch>::kRegisters == 1) {
    constexpr long long k = 8 * third;
    const __m512i from = _mm512_setr_epi64(k / 3, (k + 1) / 3, (k + 2) / 3, (k + 3) / 3,
                                           (k + 4) / 3, (k + 5) / 3, (k + 6) / 3, (k + 7) / 3);
    Pack<Arch> out;
    out.r[0] = _mm512_permutexvar_pd(from, x.r[0]);
    return out;
  }
#endif
  LaneArray all, out;
  x.store(all);
  for (std::size_t n = 0; n < kLaneWidth; ++n) out[n] = all[(8 * third + n) / 3];
  return Pack<Arch>(out);
}

// Lanes of that third whose point is the begin (0), the middle (1) or the end (2) of its part.
template <std::size_t third, class Arch>
PackMask<Arch> lanes_of(std::size_t place) {
  unsigned bits = 0;
  for (std::size_t n = 0; n < kLaneWidth; ++n) {
    bits |= ((8 * third + n) % 3 == place ? 1U : 0U) << n;
  }
  return PackMask<Arch>::of(bits);
}

// Eight parts, on the way to their points: what their three points have in common.
template <class Arch>
struct FormedParts {
  using P = Pack<Arch>;
  P at, from, middle, to, half, whole, sixth, two_thirds, swell, b_top;
  P p00, p01, p10, p11, p20, p21, p22;  // coefficients -> b, b', b'' at the begin of the interval
  P j0[kBarrierJoints], j1[kBarrierJoints], j2[kBarrierJoints], j1_third[kBarrierJoints];

  FormedParts(const BarrierParts& parts, const BarrierJoints& joints)
      : at(parts.at), from(parts.from), to(parts.to), b_top(parts.b_top) {
    const P D = P(parts.next) - P(parts.before), E = P(parts.after) - at, h = P(parts.next) - at;
    const P per_D = P(2.0) / D, per_Dh = P(2.0) / (D * h), per_Eh = P(2.0) / (E * h);
    p00 = h / D, p01 = (at - P(parts.before)) / D;
    p10 = -per_D, p11 = per_D;
    p20 = per_Dh, p21 = -per_Dh - per_Eh, p22 = per_Eh;
    whole = to - from, half = P(0.5) * whole, middle = P(0.5) * (from + to);
    const P least(kMinLength);
    sixth = max(whole / P(6.0), least), two_thirds = max(whole * P(2.0 / 3.0), least);
    swell = P(4.5) * whole * whole / P(8.0);
    const P x(parts.x);
    for (std::size_t k = 0; k < joints.count; ++k) {
      const P c1(parts.c1[k]), c2(parts.c2[k]), c3(parts.c3[k]), per_jerk(joints.per_jerk[k]);
      j0[k] = c3 * per_jerk;
      j1[k] = P(1.5) * ((c2 + x * c3) * per_jerk);
      j2[k] = P(0.5) * ((c1 + x * (c2 + P(0.5) * x * c3)) * per_jerk);
      j1_third[k] = j1[k] / P(3.0);
    }
  }

  template <std::size_t third>
  void write(const BarrierParts& parts, const BarrierJoints& joints, const double* c,
             BarrierPoints& out) const {
    const auto is_middle = lanes_of<third, Arch>(1), is_end = lanes_of<third, Arch>(2);
    const P zero(0.0);
    const P s = select(is_middle, spread<third>(middle),
                       select(is_end, spread<third>(to), spread<third>(from)));
    const P x = select(is_middle, spread<third>(half), select(is_end, spread<third>(whole), zero));
    const P bulge = select(is_middle, spread<third>(swell), zero);
    const P length = select(is_middle, spread<third>(two_thirds), spread<third>(sixth));
    put(out.length, length);
    put(out.b_top, spread<third>(b_top));
    put(out.swell, bulge);
    write_rows<third>(s - spread<third>(at), out);
    for (std::size_t k = 0; k < joints.count; ++k) {
      const P i0 = spread<third>(j0[k]), i1 = spread<third>(j1[k]);
      const P i2 = spread<third>(j2[k]), i1_third = spread<third>(j1_third[k]);
      put(out.j0[k], i0);
      put(out.j1[k], i1 + P(1.5) * x * i0);
      put(out.j2[k], i2 + x * (i1_third + P(0.25) * x * i0) - bulge * i0);
    }
    for (std::size_t n = 0; n < kLaneWidth; ++n) {
      out.interval[n] = parts.interval[(8 * third + n) / 3];
    }
    put(out.time, length / sqrt(max(applied<Arch>(out, c).v[0], P(1e-300))));
  }

 private:
  // y metres behind the begin of the interval.
  template <std::size_t third>
  void write_rows(const P& y, BarrierPoints& out) const {
    const P zero(0.0);
    const P first[3] = {spread<third>(p00), spread<third>(p01), zero};
    const P second[3] = {spread<third>(p10), spread<third>(p11), zero};
    const P last[3] = {spread<third>(p20), spread<third>(p21), spread<third>(p22)};
    const P half_y = P(0.5) * y;
    for (std::size_t j = 0; j < 3; ++j) {
      put(out.S[0][j], first[j] + y * (second[j] + half_y * last[j]));
      put(out.S[1][j], second[j] + y * last[j]);
      put(out.S[2][j], last[j]);
    }
  }
};

template <class Arch>
void form(const BarrierParts* parts, std::size_t count, const BarrierJoints& joints,
          const double* c, BarrierPoints* out) {
  for (std::size_t n = 0; n < count; ++n) {
    const FormedParts<Arch> formed(parts[n], joints);
    formed.template write<0>(parts[n], joints, c, out[3 * n]);
    formed.template write<1>(parts[n], joints, c, out[3 * n + 1]);
    formed.template write<2>(parts[n], joints, c, out[3 * n + 2]);
  }
}

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
  P loss(kMinLoss);
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
  return {&form<SERVOMILL_ARCH>, &use<SERVOMILL_ARCH>, &derive<SERVOMILL_ARCH>,
          &largest_loss<SERVOMILL_ARCH>};
}

}  // namespace servomill::controllers
