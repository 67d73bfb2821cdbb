/// Parts of the path that follow splines as they are.
///
/// Inside a spline the smoothed polyline (smooth_path.h) is replaced by the C2 cubic spline that
/// interpolates its points: both miss the curve by some nanometres, but the third derivative of the
/// interpolation is that of the curve, where windows whose widths are no whole number of chords
/// let it ripple. Next to lines, arcs and corners the smoothed polyline stays, with a correction
///
///     r(s),   r''' constant on each third of the way,                                         (1)
///
/// that vanishes with r' and r'' where the spline begins and leads to place, direction and
/// curvature of the interpolation where no window from outside acts any more. Where the path begins
/// or ends with a spline it does so on the curve: at rest curvature costs nothing.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "controllers/path/smooth_path.h"
#include "controllers/path/smoothing_windows.h"

namespace servomill::controllers {

class ExactCurves {
 public:
  /// @param path  whose windows are chosen; must outlive this
  explicit ExactCurves(const SmoothingWindows& path);

  const std::vector<Stretch>& stretches() const { return stretches_; }
  const std::vector<CubicPiece>& pieces() const { return pieces_; }

 private:
  bool is_inside(std::size_t i) const;
  void add_run(std::size_t first, std::size_t last);
  std::size_t behind_windows(std::size_t from, std::size_t to) const;
  Joints slope(std::size_t i, std::size_t first, std::size_t last) const;
  std::vector<CubicPiece> interpolation(std::size_t from, std::size_t to, std::size_t first,
                                        std::size_t last) const;
  bool lead(double from, double to, const PathState& at_from, const PathState& at_to);

  const SmoothingWindows& path_;
  const Polyline& v_;
  const std::vector<double>&s_, &w_;
  double allowed_ = 0.0;  // m, of a correction
  std::vector<CubicPiece> pieces_;
  std::vector<Stretch> stretches_;
};

}  // namespace servomill::controllers
