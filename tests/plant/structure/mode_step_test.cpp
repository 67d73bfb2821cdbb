/// Modes of the structure against closed forms.
#include "plant/structure/mode_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

namespace servomill::plant::mode_step_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr Mode kMode{2.0 * kPi * 60.0, 0.05};
constexpr double kTick = 100e-6;  // s

// Motion of a slide: position and velocity.
struct Slide {
  std::function<double(double)> x, v;
};

ModeState run(const Mode& mode, const Slide& slide, double duration, double h, ModeState s = {}) {
  const ModeStep step = mode_step(mode, h);
  const auto steps = static_cast<int>(std::lround(duration / h));
  for (int n = 0; n < steps; ++n) {
    const double from = n * h, to = (n + 1) * h;
    s = step.from(s,
                  {slide.v(to) - slide.v(from), slide.x(to) - slide.x(from) - h * slide.v(from)});
  }
  return s;
}

Slide standing() {
  return {[](double) { return 0.0; }, [](double) { return 0.0; }};
}

// a = A sin(W t) from rest.
Slide swinging(double A, double W) {
  return {[=](double t) { return A / W * (t - std::sin(W * t) / W); },
          [=](double t) { return A / W * (1.0 - std::cos(W * t)); }};
}

// Free motion that starts with eta0 at rest.
double free_motion(const Mode& m, double eta0, double t) {
  const double decay = m.zeta * m.w, w_d = m.w * std::sqrt(1.0 - m.zeta * m.zeta);
  return eta0 * std::exp(-decay * t) * (std::cos(w_d * t) + decay / w_d * std::sin(w_d * t));
}

// Steady answer to a = A sin(W t): -A Im(G e^{iWt}), G = 1 / (1 - r^2 + 2 i zeta r), r = W/w.
double steady_sine(const Mode& m, double A, double W, double t) {
  const double r = W / m.w;
  const std::complex<double> G = 1.0 / std::complex<double>(1.0 - r * r, 2.0 * m.zeta * r);
  return -A * std::imag(G * std::polar(1.0, W * t));
}

TEST(ModeStep, decays_at_a_stop_as_the_closed_form) {
  const ModeState s = run(kMode, standing(), 0.05, kTick, {1.0, 0.0});
  EXPECT_NEAR(s.eta, free_motion(kMode, 1.0, 0.05), 1e-12);
}

// A ramp a = c t from rest: eta = -c t + 2 zeta c/w in steady state, and what begins with it
// decays.
TEST(ModeStep, follows_a_ramp_of_acceleration_exactly) {
  constexpr double c = 100.0;  // m/s^3
  const Slide ramp{[](double t) { return c * t * t * t / 6.0; },
                   [](double t) { return 0.5 * c * t * t; }};
  const double w_d = kMode.w * std::sqrt(1.0 - kMode.zeta * kMode.zeta);
  const double decay = kMode.zeta * kMode.w;
  for (const double h : {10e-6, 100e-6, 1e-3}) {
    for (const double t : {0.01, 0.03, 0.5}) {
      const double eta0 = -2.0 * kMode.zeta * c / kMode.w, deta0 = c;  // cancels the steady part
      const double begin =
          std::exp(-decay * t) *
          (eta0 * std::cos(w_d * t) + (deta0 + decay * eta0) / w_d * std::sin(w_d * t));
      const double expected = -c * t + 2.0 * kMode.zeta * c / kMode.w + begin;
      EXPECT_NEAR(run(kMode, ramp, t, h).eta, expected, 1e-9) << h << " " << t;
    }
  }
}

TEST(ModeStep, answers_a_sine_as_the_closed_form) {
  constexpr double A = 1.0;
  for (const double f : {3.0, 30.0, 60.0, 90.0}) {
    const double W = 2.0 * kPi * f, t = 2.0;  // 2 s: the beginning has decayed by 1e-16
    EXPECT_NEAR(run(kMode, swinging(A, W), t, kTick).eta, steady_sine(kMode, A, W, t), 1e-6) << f;
  }
}

// The spline of the position is of order 4.
TEST(ModeStep, halving_the_step_divides_the_error_by_sixteen) {
  constexpr double A = 1.0, W = 2.0 * kPi * 45.0, t = 2.0;
  const auto error = [&](double h) {
    return std::abs(run(kMode, swinging(A, W), t, h).eta - steady_sine(kMode, A, W, t));
  };
  EXPECT_NEAR(error(1e-3) / error(0.5e-3), 16.0, 2.0);
  EXPECT_NEAR(error(0.5e-3) / error(0.25e-3), 16.0, 2.0);
}

TEST(ModeStep, of_two_halves_is_the_whole_under_a_constant_acceleration) {
  const Slide thrown{[](double t) { return 2.0 * t * t; }, [](double t) { return 4.0 * t; }};
  for (const double h : {1e-6, 1e-4, 3e-3, 20e-3}) {  // by the series and by the integrals
    const ModeState whole = run(kMode, thrown, h, h, {0.3, -20.0});
    const ModeState halves = run(kMode, thrown, h, 0.5 * h, {0.3, -20.0});
    EXPECT_NEAR(whole.eta, halves.eta, 1e-12) << h;
    EXPECT_NEAR(whole.deta, halves.deta, 1e-12 * kMode.w) << h;
  }
}

TEST(ModeStep, is_the_same_by_series_and_by_integrals) {
  const Mode mode{1.0, 0.05};  // rad/s: w h is h
  const ModeStep below = mode_step(mode, 1.0), above = mode_step(mode, std::nextafter(1.0, 2.0));
  constexpr double kRounding = 1e-14;
  EXPECT_NEAR(below.eta_dv, above.eta_dv, kRounding);
  EXPECT_NEAR(below.eta_dx, above.eta_dx, kRounding);
  EXPECT_NEAR(below.deta_dv, above.deta_dv, kRounding);
  EXPECT_NEAR(below.deta_dx, above.deta_dx, kRounding);
}

// Per modal mass, with u = eta / w^2 the displacement of a mode of full participation:
// d/dt (u'^2 / 2 + w^2 u^2 / 2) = -2 zeta w u'^2 - a u'. Simpson's rule over steps of 10 us.
TEST(ModeStep, balances_energy) {
  constexpr double A = 2.0, W = 2.0 * kPi * 40.0, h = 10e-6, t_end = 0.1;
  const Slide slide = swinging(A, W);
  const double ww = kMode.w * kMode.w;
  const ModeStep step = mode_step(kMode, 0.5 * h);
  ModeState s;
  double work = 0.0, heat = 0.0;
  const auto power = [&](double t) { return -A * std::sin(W * t) * s.deta / ww; };
  const auto loss = [&] { return 2.0 * kMode.zeta * kMode.w * std::pow(s.deta / ww, 2); };
  for (double t = 0.0; t < t_end - 0.5 * h; t += h) {
    for (const double weight : {1.0, 4.0}) {
      const double from = weight == 1.0 ? t : t + 0.5 * h, to = from + 0.5 * h;
      work += weight * h / 6.0 * power(from);
      heat += weight * h / 6.0 * loss();
      s = step.from(
          s, {slide.v(to) - slide.v(from), slide.x(to) - slide.x(from) - 0.5 * h * slide.v(from)});
    }
    work += h / 6.0 * power(t + h);
    heat += h / 6.0 * loss();
  }
  const double kinetic = 0.5 * std::pow(s.deta / ww, 2),
               elastic = 0.5 * ww * std::pow(s.eta / ww, 2);
  EXPECT_GT(work, 1e-6);
  EXPECT_GT(heat, 0.1 * work);
  EXPECT_NEAR(kinetic + elastic + heat, work, 1e-7 * work);
}

}  // namespace
}  // namespace servomill::plant::mode_step_test
