#include "strategies/turning_points.h"

#include <algorithm>
#include <cmath>

namespace servomill::strategies {
namespace {

using Coordinate = std::function<double(double)>;

// Sign of the rate about t; 0: x does not change by more than rounding does.
int rate_sign(const Coordinate& x, double t, double h) {
  constexpr double kRounding = 1e-14;  // m, rad
  const double way = x(t + 0.5 * h) - x(t - 0.5 * h);
  if (std::abs(way) < kRounding) return 0;
  return way > 0.0 ? 1 : -1;
}

// Bisection. @pre the rate has another sign at a than at b
double reversal_between(const Coordinate& x, double a, double b, double h) {
  const int sign = rate_sign(x, a, h);
  while (b - a > 1e-4 * h) {
    const double middle = 0.5 * (a + b);
    (rate_sign(x, middle, h) == sign ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

// Leaves the reversals that are farther than rounding from the end and from the one before.
void erase_shallow(const Coordinate& x, double from, double to, std::vector<double>& turns) {
  constexpr double kDepth = 1e-10;  // m, rad
  double before = x(from);
  const double end = x(to);
  std::erase_if(turns, [&](double t) {
    const double here = x(t);
    if (std::min(std::abs(here - before), std::abs(end - here)) < kDepth) return true;
    before = here;
    return false;
  });
}

}  // namespace

std::vector<double> turning_points(const Coordinate& x, double from, double to, int steps) {
  constexpr double kRate = 1e-3;  // of a step
  const double dt = (to - from) / steps, h = kRate * dt;
  std::vector<double> out;
  int sign = 0;
  double before = from;
  for (int i = 0; i <= steps; ++i) {
    const double t = std::clamp(from + i * dt, from + 0.5 * h, to - 0.5 * h);
    const int now = rate_sign(x, t, h);
    if (now == 0) continue;
    if (now == -sign) out.push_back(reversal_between(x, before, t, h));
    sign = now;
    before = t;
  }
  erase_shallow(x, from, to, out);
  return out;
}

}  // namespace servomill::strategies
