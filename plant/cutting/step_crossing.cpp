#include "plant/cutting/step_crossing.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

namespace servomill::plant {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The turn of the axis is that of where the ray leaves: by iteration from the first of some guesses
// at which the step is met at all.
double leave_step(const SweptCutter& step, const Ray& ray, std::initializer_list<double> guesses) {
  // The turn changes little along the ray, so that each iteration gains digits; 20 bound it where
  // it would alternate.
  constexpr int kIterations = 20;
  constexpr double kSame = 1e-13;  // m
  if (!step.turns()) return step.leave(ray, 0.0);
  double s = -kInfinity;
  for (const double guess : guesses) {
    double next = step.leave(ray, guess);
    for (int i = 0; i < kIterations && std::isfinite(next); ++i) {
      const double change = next - s;
      s = next;
      if (std::abs(change) < kSame) break;
      next = step.leave(ray, s);
    }
    if (std::isfinite(s)) break;
  }
  return s;
}

}  // namespace

double leave_step(const SweptCutter& step, const Ray& ray) {
  return leave_step(step, ray, {ray.length, 0.5 * ray.length, 0.0});
}

double enter_step(const SweptCutter& step, const Ray& ray, double s) {
  const Ray back = {ray.at(s), -ray.direction, ray.length};
  return s - std::max(leave_step(step, back, {0.0}), 0.0);
}

}  // namespace servomill::plant
