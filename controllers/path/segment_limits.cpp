#include "controllers/path/segment_limits.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace servomill::controllers {
namespace {

constexpr double kSimilar = 1.1;        // speeds on curves that are not worth a change
constexpr double kSimilarFeed = 1.001;  // the same for programmed speeds
constexpr double kCrossShareJ = 0.7;    // of the jerk left, for 3 q'' v a
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Largest |q'| on a piece: q' is a parabola within the hull of three control points.
struct Slopes {
  Joints joint;
  double linear = 0.0, rotary = 0.0;  // norms over X Y Z and over the rotary joints
};

Slopes largest_slopes(const CubicPiece& piece, double h) {
  const Joints &t0 = piece.c1, t1 = piece.c1 + piece.c2 * (0.5 * h);
  const Joints t2 = piece.c1 + piece.c2 * h + piece.c3 * (0.5 * h * h);
  const auto largest = [&](auto part) { return std::max({part(t0), part(t1), part(t2)}); };
  return {t0.cwiseAbs().cwiseMax(t1.cwiseAbs()).cwiseMax(t2.cwiseAbs()),
          largest([](const Joints& t) { return t.head<kLinearJoints>().norm(); }),
          largest([](const Joints& t) { return t.tail<kJoints - kLinearJoints>().norm(); })};
}

double programmed_speed(const Slopes& slopes, const FeedLimit& feed) {
  double v = feed.path;
  if (slopes.linear > 0.0) v = std::min(v, feed.linear / slopes.linear);
  if (slopes.rotary > 0.0) v = std::min(v, feed.rotary / slopes.rotary);
  return v;
}

double straight_speed(const Slopes& slopes, const Joints& limit, double programmed) {
  double v = programmed;
  for (int k = 0; k < kJoints; ++k) {
    if (slopes.joint[k] > 0.0) v = std::min(v, limit[k] / slopes.joint[k]);
  }
  return v;
}

}  // namespace

SegmentLimits segment_limits(const CubicPiece& piece, double h, const JointLimits& limits,
                             const FeedLimit& feed, double curve_share) {
  const Slopes slopes = largest_slopes(piece, h);
  const Joints& d1 = slopes.joint;
  // q'' is a line, q''' constant
  const Joints d2 = piece.c2.cwiseAbs().cwiseMax((piece.c2 + piece.c3 * h).cwiseAbs());
  const Joints d3 = piece.c3.cwiseAbs();

  SegmentLimits out;
  out.end = piece.s + h;
  const double programmed = programmed_speed(slopes, feed);
  const double straight = straight_speed(slopes, limits.v, programmed);
  double curve_a = kInfinity, curve_j = kInfinity;  // m/s, by curvature alone
  for (int k = 0; k < kJoints; ++k) {
    if (d2[k] > 0.0) curve_a = std::min(curve_a, std::sqrt(limits.a[k] / d2[k]));
    if (d3[k] > 0.0) curve_j = std::min(curve_j, std::cbrt(limits.j[k] / d3[k]));
  }
  const double v =
      std::min({straight, std::sqrt(curve_share) * curve_a, std::cbrt(curve_share) * curve_j});
  double a = kInfinity;
  for (int k = 0; k < kJoints; ++k) {
    if (d1[k] > 0.0) a = std::min(a, (limits.a[k] - d2[k] * v * v) / d1[k]);
    const double left = limits.j[k] - d3[k] * v * v * v;
    if (d2[k] > 0.0) a = std::min(a, kCrossShareJ * left / (3.0 * d2[k] * v));
  }
  double j = kInfinity;
  for (int k = 0; k < kJoints; ++k) {
    if (d1[k] <= 0.0) continue;
    j = std::min(j, (limits.j[k] - d3[k] * v * v * v - 3.0 * d2[k] * v * a) / d1[k]);
  }
  assert(v > 0.0 && a > 0.0 && j > 0.0 && v < kInfinity && a < kInfinity && j < kInfinity);
  out.v = v;
  out.programmed = v >= programmed;
  out.a = a;
  out.j = j;
  return out;
}

double straight_speed(const CubicPiece& piece, double h, const JointLimits& limits,
                      const FeedLimit& feed) {
  const Slopes slopes = largest_slopes(piece, h);
  return straight_speed(slopes, limits.v, programmed_speed(slopes, feed));
}

std::vector<SegmentLimits> merge_similar(std::span<const SegmentLimits> pieces) {
  const auto alike = [](double x, double y) { return std::max(x, y) <= 2.0 * std::min(x, y); };
  std::vector<SegmentLimits> out;
  double fastest = 0.0;  // of the stretch being merged
  for (const SegmentLimits& next : pieces) {
    const double high = std::max(fastest, next.v);
    const double similar = next.programmed ? kSimilarFeed : kSimilar;
    if (!out.empty() && out.back().programmed == next.programmed &&
        high <= similar * std::min(out.back().v, next.v) && alike(out.back().a, next.a) &&
        alike(out.back().j, next.j)) {
      SegmentLimits& last = out.back();
      last = {next.end, std::min(last.v, next.v), std::min(last.a, next.a),
              std::min(last.j, next.j), next.programmed};
      fastest = high;
    } else {
      out.push_back(next);
      fastest = next.v;
    }
  }
  return out;
}

}  // namespace servomill::controllers
