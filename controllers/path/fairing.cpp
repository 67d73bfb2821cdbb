#include "controllers/path/fairing.h"

#include <algorithm>
#include <cstddef>

#include "plant/vocabulary/interrupt.h"

namespace servomill::controllers {
namespace {

constexpr double kDense = 1.5;        // chords in a window, above which a spline pays
constexpr std::size_t kMinRun = 16;   // vertices that are worth a spline
constexpr std::size_t kBlock = 512;   // vertices of one spline
constexpr std::size_t kOverlap = 48;  // of them are done again with the next

}  // namespace

Fairing::Fairing(const SmoothingWindows& path, const Joints& jerk)
    : path_(path),
      v_(path.vertices()),
      s_(path.s()),
      w_(path.width()),
      n_(path.chords()),
      jerk_(jerk.cwiseMax(1e-12)) {
  for (std::size_t i = 1; i < n_;) {
    throw_if_interrupted();
    if (!is_dense(i)) {
      ++i;
      continue;
    }
    std::size_t j = i;
    while (j + 1 < n_ && is_dense(j + 1)) ++j;
    if (j - i >= kMinRun) fair_run(i, j);
    i = j + 1;
  }
}

// Place, direction and curvature of the smoothed polyline at s, on chord k.
FairSpline::State Fairing::state_at(double s, std::size_t k) const {
  const PathState at = path_.state_at(s, k);
  return {s, at.q, at.d1, at.d2, k};
}

// Tells if the window at vertex i is wide enough to cover its neighbours.
bool Fairing::is_dense(std::size_t i) const {
  if (v_.traits(i).arc >= 0 || v_.traits(i + 1).arc >= 0) return false;
  return w_[i] > kDense * std::min(s_[i] - s_[i - 1], s_[i + 1] - s_[i]);
}

// Windows outside the run that reach into it are left alone.
void Fairing::fair_run(std::size_t i, std::size_t j) {
  const double a = std::clamp(s_[i - 1] + w_[i - 1], std::max(s_[i] - w_[i], s_[i - 1]), s_[i]);
  const double b = std::clamp(s_[j + 1] - w_[j + 1], s_[j], std::min(s_[j] + w_[j], s_[j + 1]));
  Run run;
  run.next = i, run.last = j, run.length = kBlock;
  run.begin = state_at(a, i - 1), run.end = state_at(b, j);
  while (run.next <= run.last) {
    throw_if_interrupted();
    const std::size_t to = std::min(run.next + run.length, run.last);
    if (to - run.next < kMinRun) break;
    const FairSpline::State stop = to == j ? run.end : state_at(s_[to], to);
    if (spline_.fit(v_, s_, w_, jerk_, run.begin, stop)) {
      accept(run, to, stop);
    } else if (!run.tail.empty()) {
      finish_tail(run);
    } else {
      try_less(run, to);
    }
  }
  finish_tail(run);
}

// Keeps the spline up to some vertices before its end; there the next one begins.
void Fairing::accept(Run& run, std::size_t to, const FairSpline::State& stop) {
  const std::vector<CubicPiece>& pieces = spline_.pieces();
  std::size_t cut = pieces.size();
  const bool ends = to == run.last;
  if (!ends) {
    while (pieces[cut - 1].s > s_[to - std::min(kOverlap, (to - run.next) / 2)]) --cut;
    --cut;
  }
  const auto middle = pieces.begin() + static_cast<std::ptrdiff_t>(cut);
  open(run.begin.s);
  pieces_.insert(pieces_.end(), pieces.begin(), middle);
  run.tail.assign(middle, pieces.end());
  run.tail_end = stop.s;
  run.begin = ends ? stop : spline_.state_at(cut);
  close(run.begin.s);
  run.next = ends ? to + 1 : run.begin.chord + 1;
  run.length = kBlock;
}

// No spline joins the last one: that one stays to its end.
void Fairing::finish_tail(Run& run) {
  if (run.tail.empty()) return;
  pieces_.insert(pieces_.end(), run.tail.begin(), run.tail.end());
  close(run.tail_end);
  run.tail.clear();
  while (run.next <= run.last && s_[run.next] <= run.tail_end) ++run.next;
  run.begin = state_at(run.tail_end, run.next - 1);
}

// Fewer vertices; if they are few, what is between windows stays as it is.
void Fairing::try_less(Run& run, std::size_t to) const {
  if (to - run.next > 2 * kMinRun) {
    run.length = (to - run.next) / 2;
    return;
  }
  run.next = to + 1;
  run.begin = state_at(s_[to], to);
  run.length = kBlock;
}

void Fairing::open(double s) {
  if (stretches_.empty() || stretches_.back().to != s) {
    stretches_.push_back({s, s, pieces_.size(), pieces_.size()});
  }
}
void Fairing::close(double s) {
  stretches_.back().to = s;
  stretches_.back().last = pieces_.size();
}

}  // namespace servomill::controllers
