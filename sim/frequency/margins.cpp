#include "sim/frequency/margins.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

namespace servomill::sim {
namespace {

using Complex = std::complex<double>;

constexpr int kDeepest = 8;            // halvings between two points
constexpr double kCrossingTol = 1e-9;  // of the frequency

// Adds points between the last one of the curve and (f, response), where the response turns.
void fill(Curve& curve, const ResponseAt& y, double f, Complex response, int depth) {
  const double last = curve.f.back();
  if (depth == 0 || !(std::abs(std::log(response / curve.y.back())) > kLargestTurn)) return;
  const double middle = std::sqrt(last * f);
  const Complex there = y(middle);
  fill(curve, y, middle, there, depth - 1);
  curve.f.push_back(middle);
  curve.y.push_back(there);
  fill(curve, y, f, response, depth - 1);
}

// Between two points of the curve: logarithm of the magnitude and phase are straight lines.
Complex interpolated(const Curve& curve, std::size_t i, double f) {
  const double t = std::log(f / curve.f[i]) / std::log(curve.f[i + 1] / curve.f[i]);
  return curve.y[i] * std::pow(curve.y[i + 1] / curve.y[i], t);
}

// Where `quantity` of the response changes its sign between the points i and i + 1.
template <class Of>
std::pair<double, Complex> crossing(const Curve& curve, std::size_t i, const ResponseAt& at,
                                    const Of& quantity) {
  double low = curve.f[i], high = curve.f[i + 1];
  const bool positive = quantity(curve.y[i]) > 0.0;
  const auto response = [&](double f) { return at ? at(f) : interpolated(curve, i, f); };
  while (high - low > kCrossingTol * high) {
    const double middle = std::sqrt(low * high);
    ((quantity(response(middle)) > 0.0) == positive ? low : high) = middle;
  }
  return {high, response(high)};
}

template <class Of>
bool crosses(const Curve& curve, std::size_t i, const Of& quantity) {
  return (quantity(curve.y[i]) > 0.0) != (quantity(curve.y[i + 1]) > 0.0);
}

// Counts where L meets the negative real axis.
void meets_real_axis(Margins& m, double f, Complex L) {
  if (L.real() >= 0.0) return;
  const double size = std::abs(L);
  if (size < 1.0 && 1.0 / size < m.gain) {
    m.gain = 1.0 / size;
    m.gain_frequency = f;
  } else if (size > 1.0) {
    m.reduction = std::min(m.reduction, size);
  }
}

}  // namespace

std::vector<double> logarithmic(double from, double to, std::size_t points) {
  assert(from > 0.0 && to >= from && points > 0);
  std::vector<double> f(points, from);
  for (std::size_t i = 1; i < points; ++i) {
    f[i] = from * std::pow(to / from, static_cast<double>(i) / static_cast<double>(points - 1));
  }
  if (points > 1) f.back() = to;
  return f;
}

Curve curve_of(const ResponseAt& y, const std::vector<double>& f) {
  Curve curve;
  for (const double one : f) {
    const Complex response = y(one);
    if (!curve.f.empty()) fill(curve, y, one, response, kDeepest);
    curve.f.push_back(one);
    curve.y.push_back(response);
  }
  return curve;
}

Margins margins_of(const Curve& curve, const ResponseAt& at) {
  Margins m;
  const auto imaginary = [](Complex L) { return L.imag(); };
  const auto excess = [](Complex L) { return std::abs(L) - 1.0; };
  for (std::size_t i = 0; i < curve.f.size(); ++i) {
    const double S = 1.0 / std::abs(1.0 + curve.y[i]);
    if (S > m.sensitivity) {
      m.sensitivity = S;
      m.sensitivity_frequency = curve.f[i];
    }
    if (i + 1 == curve.f.size()) break;
    if (crosses(curve, i, imaginary)) {
      const auto [f, L] = crossing(curve, i, at, imaginary);
      meets_real_axis(m, f, L);
    }
    if (crosses(curve, i, excess)) {
      const auto [f, L] = crossing(curve, i, at, excess);
      const double margin = std::remainder(std::arg(L) + std::numbers::pi, 2 * std::numbers::pi);
      m.last_crossover = f;
      if (std::abs(margin) < std::abs(m.phase)) {
        m.phase = margin;
        m.crossover = f;
      }
    }
  }
  // at the Nyquist frequency a sampled loop is real
  const Complex last = curve.y.back();
  if (std::abs(last.imag()) < 1e-6 * std::abs(last)) meets_real_axis(m, curve.f.back(), last);
  return m;
}

ClosedLoop closed_loop_of(const Curve& curve, const ResponseAt& at) {
  ClosedLoop closed;
  const auto excess = [](Complex y) { return std::abs(y) - std::numbers::sqrt2 / 2.0; };
  for (std::size_t i = 0; i < curve.f.size(); ++i) {
    if (std::abs(curve.y[i]) > closed.peak) {
      closed.peak = std::abs(curve.y[i]);
      closed.peak_frequency = curve.f[i];
    }
    const bool more = i + 1 < curve.f.size();
    if (more && closed.bandwidth == Margins::kNone && crosses(curve, i, excess)) {
      closed.bandwidth = crossing(curve, i, at, excess).first;
    }
  }
  return closed;
}

}  // namespace servomill::sim
