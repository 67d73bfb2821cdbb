#include "controllers/path/exact_curves.h"

#include <Eigen/LU>
#include <algorithm>
#include <cstddef>

#include "plant/vocabulary/interrupt.h"

namespace servomill::controllers {
namespace {

constexpr std::size_t kMinIntervals = 6;  // of an interpolation that pays
constexpr std::size_t kSlopePoints = 5;   // for a slope to the fourth order
constexpr double kCorrection = 0.1;       // of the tolerance, at most
constexpr double kClear = 2.0;            // windows: reach of what fades at a joint

PathState behind(const PathState& at, const Joints& jerk, double x) {
  return {at.q + x * (at.d1 + (0.5 * x) * (at.d2 + (x / 3.0) * jerk)),
          at.d1 + x * (at.d2 + (0.5 * x) * jerk), at.d2 + x * jerk};
}

// Third derivatives on three parts of length l that lead from one state to another.
std::array<Joints, 3> three_jerks(const PathState& from, const PathState& to, double l) {
  Eigen::Matrix3d effect;  // of each on q, q' and q'' at the end
  for (int k = 0; k < 3; ++k) {
    const double rest = (2 - k) * l;
    effect(0, k) = l * l * l / 6.0 + l * l / 2.0 * rest + l * rest * rest / 2.0;
    effect(1, k) = l * l / 2.0 + l * rest;
    effect(2, k) = l;
  }
  const PathState free = behind(from, Joints::Zero(), 3.0 * l);
  Eigen::Matrix<double, 3, kJoints> missing;
  missing << (to.q - free.q).transpose(), (to.d1 - free.d1).transpose(),
      (to.d2 - free.d2).transpose();
  const Eigen::Matrix<double, 3, kJoints> jerks = effect.inverse() * missing;
  return {jerks.row(0).transpose(), jerks.row(1).transpose(), jerks.row(2).transpose()};
}

PathState difference(const PathState& a, const PathState& b) {
  return {a.q - b.q, a.d1 - b.d1, a.d2 - b.d2};
}

}  // namespace

ExactCurves::ExactCurves(const SmoothingWindows& path)
    : path_(path), v_(path.vertices()), s_(path.s()), w_(path.width()) {
  const std::size_t n = path_.chords();
  for (std::size_t i = 1; v_.has_arcs() && i < n; ++i) {
    if (!is_inside(i)) continue;
    std::size_t last = i;
    while (last + 1 < n && is_inside(last + 1) && v_.traits(last + 1).arc == v_.traits(i).arc) {
      ++last;
    }
    throw_if_interrupted();
    add_run(i - 1, last + 1);
    i = last;
  }
}

bool ExactCurves::is_inside(std::size_t i) const {
  return v_.traits(i).arc >= 0 && v_.traits(i).is_exact;
}

// First vertex, going from one towards another, on which nothing before that one acts.
std::size_t ExactCurves::behind_windows(std::size_t from, std::size_t to) const {
  const bool rises = to > from;
  std::size_t i = from;
  while (i != to) {
    rises ? ++i : --i;
    const double way = std::abs(s_[i] - s_[from]);
    if (way >= kClear * w_[i] && way >= w_[from]) break;
  }
  return i;
}

// @param first, last  where the spline begins and ends
void ExactCurves::add_run(std::size_t first, std::size_t last) {
  const bool begins = first == 0, ends = last == path_.chords();
  const std::size_t from = begins ? first : behind_windows(first, last);
  const std::size_t to = ends ? last : behind_windows(last, first);
  if (to < from + kMinIntervals) return;
  const std::vector<CubicPiece> body = interpolation(from, to, first, last);
  const CubicPiece &front = body.front(), &back = body.back();
  const PathState at_end = behind({back.c0, back.c1, back.c2}, back.c3, s_[to] - back.s);
  const PathState none;
  const std::size_t count = pieces_.size();
  allowed_ = kCorrection * v_.traits(first + 1).tolerance_linear;
  bool is_good =
      begins || lead(s_[first], s_[from], none,
                     difference({front.c0, front.c1, front.c2}, path_.state_at(s_[from], from)));
  pieces_.insert(pieces_.end(), body.begin(), body.end());
  is_good = is_good &&
            (ends || lead(s_[to], s_[last], difference(at_end, path_.state_at(s_[to], to)), none));
  if (is_good) {
    stretches_.push_back({s_[first], s_[last], count, pieces_.size()});
  } else {
    pieces_.resize(count);
  }
}

// Derivative of the programmed points by s at one of them, from a polynomial through five.
Joints ExactCurves::slope(std::size_t i, std::size_t first, std::size_t last) const {
  const std::size_t low = std::clamp(i < 2 ? 0 : i - 2, first, last + 1 - kSlopePoints);
  Joints out = Joints::Zero();
  double own = 0.0;
  for (std::size_t j = low; j < low + kSlopePoints; ++j) {
    if (j == i) continue;
    double weight = 1.0 / (s_[j] - s_[i]);
    own -= weight;
    for (std::size_t k = low; k < low + kSlopePoints; ++k) {
      if (k != i && k != j) weight *= (s_[i] - s_[k]) / (s_[j] - s_[k]);
    }
    out += weight * path_.programmed(j);
  }
  return out + own * path_.programmed(i);
}

// The clamped cubic spline through the points: second derivatives from a system of three diagonals.
std::vector<CubicPiece> ExactCurves::interpolation(std::size_t from, std::size_t to,
                                                   std::size_t first, std::size_t last) const {
  const std::size_t n = to - from;
  const auto h = [&](std::size_t k) { return s_[from + k + 1] - s_[from + k]; };
  const auto chord = [&](std::size_t k) -> Joints {
    return (path_.programmed(from + k + 1) - path_.programmed(from + k)) / h(k);
  };
  std::vector<double> upper(n + 1);
  std::vector<Joints> bend(n + 1);  // second derivatives at the points
  for (std::size_t k = 0; k <= n; ++k) {
    const double before = k > 0 ? h(k - 1) : 0.0, after = k < n ? h(k) : 0.0;
    Joints right = k < n ? chord(k) : slope(to, first, last);
    right -= k > 0 ? chord(k - 1) : slope(from, first, last);
    const double pivot = 2.0 * (before + after) - (k > 0 ? before * upper[k - 1] : 0.0);
    upper[k] = after / pivot;
    bend[k] = (6.0 * right - (k > 0 ? Joints(before * bend[k - 1]) : Joints::Zero())) / pivot;
  }
  for (std::size_t k = n; k-- > 0;) bend[k] -= upper[k] * bend[k + 1];
  std::vector<CubicPiece> out;
  for (std::size_t k = 0; k < n; ++k) {
    out.push_back({s_[from + k], path_.programmed(from + k),
                   chord(k) - h(k) / 6.0 * (2.0 * bend[k] + bend[k + 1]), bend[k],
                   (bend[k + 1] - bend[k]) / h(k), from + k});
  }
  return out;
}

// The smoothed polyline with the correction (1), unless that takes much of the tolerance.
bool ExactCurves::lead(double from, double to, const PathState& at_from, const PathState& at_to) {
  const double third = (to - from) / 3.0;
  const std::array<Joints, 3> jerks = three_jerks(at_from, at_to, third);
  PathState r = at_from;
  for (std::size_t k = 0; k < jerks.size(); ++k) {
    const double begin = from + third * static_cast<double>(k);
    const double end = k + 1 < jerks.size() ? begin + third : to;
    for (const double share : {0.0, 0.5, 1.0}) {
      const Joints q = behind(r, jerks[k], share * third).q;
      if (q.norm() > allowed_) return false;
    }
    path_.for_each_span(begin, end, [&](const SmoothingWindows::Span& span) {
      CubicPiece piece = path_.piece(span, span.from);
      const PathState here = behind(r, jerks[k], span.from - begin);
      piece.c0 += here.q;
      piece.c1 += here.d1;
      piece.c2 += here.d2;
      piece.c3 += jerks[k];
      pieces_.push_back(piece);
    });
    r = behind(r, jerks[k], end - begin);
  }
  return true;
}

}  // namespace servomill::controllers
