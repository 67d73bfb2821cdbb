#include "sim/frequency/margins.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "plant/vocabulary/interrupt.h"
#include "sim/frequency/axis_signals.h"

namespace servomill::sim::frequency {
namespace {

using Complex = std::complex<double>;

constexpr int kDeepest = 16;           // halvings between two points
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

// Frequency at which `quantity` has its minimum near point i, whose neighbours are both larger.
template <class Of>
std::pair<double, Complex> least(const Curve& curve, std::size_t i, const ResponseAt& y,
                                 const Of& quantity) {
  constexpr int kBits = 24;  // more would be below what the square of a double resolves
  const auto at_logarithm = [&](double x) { return quantity(y(std::exp(x))); };
  const auto found = boost::math::tools::brent_find_minima(at_logarithm, std::log(curve.f[i - 1]),
                                                           std::log(curve.f[i + 1]), kBits);
  const double f = std::exp(found.first);
  return {f, y(f)};
}

// Adds the points between given ones at which the magnitude is largest or least.
void add_extrema(Curve& curve, const ResponseAt& y) {
  Curve more;
  for (std::size_t i = 1; i + 1 < curve.f.size(); ++i) {
    const double before = std::abs(curve.y[i - 1]), here = std::abs(curve.y[i]);
    const double after = std::abs(curve.y[i + 1]);
    if ((here > before) != (here > after)) continue;
    const double sign = here > before ? -1.0 : 1.0;
    const auto [f, there] = least(curve, i, y, [&](Complex L) { return sign * std::abs(L); });
    more.f.push_back(f);
    more.y.push_back(there);
  }
  for (std::size_t i = 0; i < more.f.size(); ++i) {
    const auto place = std::lower_bound(curve.f.begin(), curve.f.end(), more.f[i]);
    if (*place == more.f[i]) continue;
    curve.y.insert(curve.y.begin() + (place - curve.f.begin()), more.y[i]);
    curve.f.insert(place, more.f[i]);
  }
}

// Between two points of the curve: logarithm of the magnitude and phase are straight lines.
Complex interpolated(const Curve& curve, std::size_t i, double f) {
  const double t = std::log(f / curve.f[i]) / std::log(curve.f[i + 1] / curve.f[i]);
  return curve.y[i] * std::pow(curve.y[i + 1] / curve.y[i], t);
}

// Frequency at which `quantity` changes its sign between the points i and i + 1.
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

std::vector<double> logarithmic(double from, double to, std::size_t points,
                                const std::vector<double>& more) {
  std::vector<double> f = logarithmic(from, to, points);
  std::copy_if(more.begin(), more.end(), std::back_inserter(f),
               [&](double one) { return one > from && one < to; });
  std::sort(f.begin(), f.end());
  f.erase(std::unique(f.begin(), f.end()), f.end());
  return f;
}

Curve curve_of(const ResponseAt& y, const std::vector<double>& f) {
  Curve curve;
  for (const double one : f) {
    throw_if_interrupted();
    const Complex response = y(one);
    if (!curve.f.empty()) fill(curve, y, one, response, kDeepest);
    curve.f.push_back(one);
    curve.y.push_back(response);
  }
  add_extrema(curve, y);
  return curve;
}

Margins margins_of(const Curve& curve, const ResponseAt& at) {
  Margins m;
  const auto imaginary = [](Complex L) { return L.imag(); };
  const auto excess = [](Complex L) { return std::abs(L) - 1.0; };
  const auto distance = [](Complex L) { return std::abs(1.0 + L); };
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < curve.f.size(); ++i) {
    if (distance(curve.y[i]) < distance(curve.y[nearest])) nearest = i;
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
  m.sensitivity = 1.0 / distance(curve.y[nearest]);
  m.sensitivity_frequency = curve.f[nearest];
  if (at && nearest > 0 && nearest + 1 < curve.f.size()) {
    const auto [f, L] = least(curve, nearest, at, distance);
    m.sensitivity = 1.0 / distance(L);
    m.sensitivity_frequency = f;
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

}  // namespace servomill::sim::frequency
