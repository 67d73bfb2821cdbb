/// Splines that replace the smoothed polyline where chords are shorter than its windows.
#pragma once

#include <cstddef>
#include <vector>

#include "controllers/path/fair_spline.h"
#include "controllers/path/smooth_path.h"
#include "controllers/path/smoothing_windows.h"

namespace servomill::controllers {

/// Splines through runs of short chords. They join the smoothed polyline with its direction and
/// curvature.
class Fairing {
 public:
  /// @param path  whose windows are chosen; must outlive this
  /// @param jerk  limits of the scaled joints
  Fairing(const SmoothingWindows& path, const Joints& jerk);

  const std::vector<Stretch>& stretches() const { return stretches_; }
  const std::vector<CubicPiece>& pieces() const { return pieces_; }

 private:
  // Progress of fairing a run of vertices: splines of overlapping blocks.
  struct Run {
    std::size_t next = 0, last = 0;  // vertices not yet done
    std::size_t length = 0;          // of the next block
    FairSpline::State begin, end;
    std::vector<CubicPiece> tail;  // of the last spline, beyond where the next begins
    double tail_end = 0.0;
  };

  FairSpline::State state_at(double s, std::size_t k) const;
  bool is_dense(std::size_t i) const;
  void fair_run(std::size_t i, std::size_t j);
  void accept(Run& run, std::size_t to, const FairSpline::State& stop);
  void finish_tail(Run& run);
  void try_less(Run& run, std::size_t to) const;
  void open(double s);
  void close(double s);

  const SmoothingWindows& path_;
  const Polyline& v_;
  const std::vector<double>&s_, &w_;
  std::size_t n_;  // chords
  Joints jerk_;
  FairSpline spline_;
  std::vector<CubicPiece> pieces_;
  std::vector<Stretch> stretches_;
};

}  // namespace servomill::controllers
