#include "plant/structure/mode_step.h"

#include <cassert>
#include <cmath>

namespace servomill::plant {
namespace {

// Impulse response g of the mode, g'' + 2 zeta w g' + w^2 g = 0 with g(0) = 0, g'(0) = 1, at h.
struct Impulse {
  double g = 0.0, dg = 1.0;
};

Impulse impulse_of(const Mode& m, double h) {
  const double decay = m.zeta * m.w, w_d = m.w * std::sqrt(1.0 - m.zeta * m.zeta);
  const double e = std::exp(-decay * h), c = std::cos(w_d * h), s = std::sin(w_d * h) / w_d;
  return {e * s, e * (c - decay * s)};
}

// Columns of the excitation. With a(t) = alpha + beta t,
//   alpha = 6 dx/h^2 - 2 dv/h,   beta = 6 dv/h^2 - 12 dx/h^3,
//   eta = -w^2 (alpha G1 + beta G2),   eta' = -w^2 (alpha g + beta G1),
// where G1 and G2 are the first and the second integral of g from 0 to h.
void excite_by_integrals(const Mode& m, double h, const Impulse& at, ModeStep& step) {
  const double ww = m.w * m.w, damping = 2.0 * m.zeta * m.w;
  const double G1 = (1.0 - at.dg - damping * at.g) / ww;  // equation of g, integrated
  const double G2 = (h - at.g - damping * G1) / ww;       // integrated twice
  step.eta_dv = -ww * (6.0 * G2 / h - 2.0 * G1) / h;
  step.eta_dx = -ww * (6.0 * G1 - 12.0 * G2 / h) / (h * h);
  step.deta_dv = -ww * (6.0 * G1 / h - 2.0 * at.g) / h;
  step.deta_dx = -ww * (6.0 * at.g - 12.0 * G1 / h) / (h * h);
}

// The same columns by the power series g = sum c_n h^n / n!. In a short step the integrals cancel
// up to rounding in some columns; in the series the cancelling terms are removed.
void excite_by_series(const Mode& m, double h, ModeStep& step) {
  constexpr int kTerms = 20;  // 1 / 20! is below the last bit
  const double ww = m.w * m.w, damping = 2.0 * m.zeta * m.w;
  double before = 0.0, c = 1.0;  // c_(n-1), c_n
  double power = 1.0 / 2.0;      // h^(n-1) / (n + 1)!
  step.eta_dv = step.eta_dx = step.deta_dv = step.deta_dx = 0.0;
  for (int n = 1; n <= kTerms; ++n) {
    const double term = -ww * c * power;
    step.eta_dv += term * h * (2.0 - 2.0 * n) / (n + 2.0);
    step.eta_dx += term * 6.0 * n / (n + 2.0);
    step.deta_dv += term * (4.0 - 2.0 * n);
    step.deta_dx += term * (6.0 * n - 6.0) / h;
    const double next = -damping * c - ww * before;
    before = c;
    c = next;
    power *= h / (n + 2.0);
  }
}

}  // namespace

ModeStep mode_step(const Mode& m, double h) {
  assert(m.w > 0.0 && m.zeta > 0.0 && m.zeta < 1.0 && h > 0.0);
  constexpr double kLongestOfSeries = 1.0;  // rad
  const Impulse at = impulse_of(m, h);
  ModeStep step;
  step.eta_deta = at.g;
  step.eta_eta = at.dg + 2.0 * m.zeta * m.w * at.g;
  step.deta_eta = -m.w * m.w * at.g;
  step.deta_deta = at.dg;
  if (m.w * h > kLongestOfSeries) {
    excite_by_integrals(m, h, at, step);
  } else {
    excite_by_series(m, h, step);
  }
  return step;
}

}  // namespace servomill::plant
