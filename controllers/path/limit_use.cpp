#include "controllers/path/limit_use.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "controllers/path/limit_form.h"
#include "plant/vocabulary/interrupt.h"

namespace servomill::controllers {
namespace {

using State = SpeedSpline::State;
constexpr int kHalvings = 3;                    // of an interval, to bound the jerk between points
constexpr std::size_t kPartsAtOnce = 1U << 12;  // between two looks for an interruption

// Bounds by the control points of a quadratic.
double largest(const Joints& from, const Joints& middle, const Joints& to) {
  const Joints control = 2.0 * middle - 0.5 * (from + to);
  return from.cwiseAbs().cwiseMax(control.cwiseAbs()).cwiseMax(to.cwiseAbs()).maxCoeff();
}

// The largest value of a quadratic itself: its vertex if that lies between.
double largest(double from, double middle, double to) {
  const double control = 2.0 * middle - 0.5 * (from + to), end = std::max(from, to);
  if (control <= end) return end;
  return (control * control - from * to) / (2.0 * control - from - to);
}

// Bounds of |acceleration| / (margin A) and of b over h metres from where `form` and `x` are.
std::pair<double, double> largest_acceleration(const LimitForm& form, const State& x, double h,
                                               const Joints& ratio) {
  const State xm = SpeedSpline::shifted(x, 0.5 * h), x1 = SpeedSpline::shifted(x, h);
  return {largest(form.acceleration(x, ratio), form.shifted(0.5 * h).acceleration(xm, ratio),
                  form.shifted(h).acceleration(x1, ratio)),
          largest(x[0], xm[0], x1[0])};
}

// Bound of |jerk| / (margin J) between f and g metres from there.
double largest_jerk(const LimitForm& form, const State& x, double f, double g, double margin,
                    int depth) {
  const double m = 0.5 * (f + g);
  const State x0 = SpeedSpline::shifted(x, f), xm = SpeedSpline::shifted(x, m);
  const State x1 = SpeedSpline::shifted(x, g);
  const double top = std::sqrt(largest(x0[0], xm[0], x1[0]));
  const double L =
      largest(form.shifted(f).jerk(x0), form.shifted(m).jerk(xm), form.shifted(g).jerk(x1));
  if (L * top * margin <= 1.0 || depth == kHalvings) return L * top;
  return std::max(largest_jerk(form, x, f, m, margin, depth + 1),
                  largest_jerk(form, x, m, g, margin, depth + 1));
}

}  // namespace

LimitUse largest_use(const SmoothPath& path, const SpeedSpline& speed, const PathParts& parts,
                     std::span<const double> v_top, const Joints& per_jerk, const Joints& ratio,
                     double margin) {
  LimitUse use{1e-9, 1e-9, 1e-9};
  for (std::size_t n = 0; n < parts.size(); ++n) {
    if (n % kPartsAtOnce == 0) throw_if_interrupted();
    const PathPart part = parts[n];
    const CubicPiece& piece = path.pieces[part.piece];
    const LimitForm form = LimitForm::on(piece, part.from - piece.s, per_jerk);
    const State x =
        SpeedSpline::shifted(speed.begin_of(part.interval), part.from - speed.t[part.interval]);
    const double h = part.to - part.from;
    use.jerk = std::max(use.jerk, largest_jerk(form, x, 0.0, h, margin, 0));
    const auto [a, b] = largest_acceleration(form, x, h, ratio);
    use.acceleration = std::max(use.acceleration, a);
    use.speed = std::max(use.speed, b / (v_top[part.piece] * v_top[part.piece]));
  }
  return use;
}

}  // namespace servomill::controllers
