#include "controllers/path/smooth_path.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <span>
#include <utility>

#include "controllers/path/exact_curves.h"
#include "controllers/path/fairing.h"
#include "controllers/path/smoothing_windows.h"

namespace servomill::controllers {
namespace {

// A stretch and its pieces.
struct Replaced {
  double from = 0.0, to = 0.0;  // m
  std::span<const CubicPiece> pieces;
};

// In the order of the path; they do not overlap.
std::vector<Replaced> all_replaced(const Fairing& fairing, const ExactCurves& curves) {
  std::vector<Replaced> out;
  const auto add = [&](const auto& one) {
    for (const Stretch& stretch : one.stretches()) {
      out.push_back({stretch.from, stretch.to,
                     std::span(one.pieces()).subspan(stretch.first, stretch.last - stretch.first)});
    }
  };
  add(fairing);
  add(curves);
  std::sort(out.begin(), out.end(),
            [](const Replaced& a, const Replaced& b) { return a.from < b.from; });
  return out;
}

// The stretches, and between them the pieces of the smoothed polyline.
SmoothPath join(const SmoothingWindows& windows, const std::vector<Replaced>& replaced) {
  constexpr double kMinPiece = SmoothingWindows::kMinPiece;
  SmoothPath path;
  path.s = windows.s();
  for (const Replaced& run : replaced) path.pieces.reserve(path.pieces.size() + run.pieces.size());
  std::size_t next = 0;
  windows.for_each_span(0.0, path.s.back(), [&](const SmoothingWindows::Span& span) {
    while (next < replaced.size() && replaced[next].to <= span.from + kMinPiece) ++next;
    double at = span.from;
    for (; next < replaced.size() && replaced[next].from < span.to; ++next) {
      const Replaced& run = replaced[next];
      if (run.from > at + kMinPiece) path.pieces.push_back(windows.piece(span, at));
      if (run.from >= span.from) {
        path.pieces.insert(path.pieces.end(), run.pieces.begin(), run.pieces.end());
      }
      at = run.to;
      if (run.to > span.to - kMinPiece) break;
    }
    if (at < span.to - kMinPiece) path.pieces.push_back(windows.piece(span, at));
  });
  return path;
}

}  // namespace

SmoothPath smooth(Polyline vertices, const Joints& jerk) {
  assert(vertices.size() >= 2);
  SmoothingWindows windows(std::move(vertices));
  windows.choose();
  const Fairing fairing(windows, jerk);
  const ExactCurves curves(windows);
  return join(windows, all_replaced(fairing, curves));
}

}  // namespace servomill::controllers
