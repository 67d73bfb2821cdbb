#include "controllers/path/smooth_path.h"

#include <cassert>
#include <cstddef>
#include <utility>

#include "controllers/path/fairing.h"
#include "controllers/path/smoothing_windows.h"

namespace servomill::controllers {
namespace {

// Pieces of the splines, and between them those of the smoothed polyline.
SmoothPath join(const SmoothingWindows& windows, const Fairing& fairing) {
  constexpr double kMinPiece = SmoothingWindows::kMinPiece;
  const std::vector<Fairing::Stretch>& faired = fairing.stretches();
  const std::vector<CubicPiece>& splines = fairing.pieces();
  const Polyline& v = windows.vertices();
  const std::vector<double>& s = windows.s();
  SmoothPath path;
  path.s = s;
  path.pieces.reserve(splines.size());
  std::size_t next = 0;
  const auto add = [&](double from, double middle, std::size_t k, std::size_t first,
                       std::size_t last) {
    const SmoothingWindows::Deviation D = windows.deviation(from, middle, first, last);
    const Joints d = windows.direction(k);
    path.pieces.push_back({from, v.u(k) + d * (from - s[k]) + D.d0, d + D.d1, D.d2, D.d3, k});
  };
  windows.for_each_span(0.0, s.back(), [&](const SmoothingWindows::Span& span) {
    const auto [from, to, k, first, last] = span;
    const double middle = span.middle();
    while (next < faired.size() && faired[next].to <= from + kMinPiece) ++next;
    double at = from;
    for (; next < faired.size() && faired[next].from < to; ++next) {
      const Fairing::Stretch& run = faired[next];
      if (run.from > at + kMinPiece) add(at, middle, k, first, last);
      if (run.from >= from) {
        path.pieces.insert(path.pieces.end(),
                           splines.begin() + static_cast<std::ptrdiff_t>(run.first),
                           splines.begin() + static_cast<std::ptrdiff_t>(run.last));
      }
      at = run.to;
      if (run.to > to - kMinPiece) break;
    }
    if (at < to - kMinPiece) add(at, middle, k, first, last);
  });
  return path;
}

}  // namespace

SmoothPath smooth(Polyline vertices, const Joints& jerk) {
  assert(vertices.size() >= 2);
  SmoothingWindows windows(std::move(vertices));
  windows.choose();
  return join(windows, Fairing(windows, jerk));
}

}  // namespace servomill::controllers
