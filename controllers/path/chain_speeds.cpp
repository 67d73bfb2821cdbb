#include "controllers/path/chain_speeds.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>

#include "controllers/path/time_optimal_law.h"

namespace servomill::controllers {
namespace {

constexpr std::array<double, 3> kCurveShares = {0.25, 0.5, 0.8};  // tried on each chain
constexpr std::size_t kManyPieces =
    1000;  // of which the last share is taken: see time_optimal_law.h

// The pieces of one path and the moves that reach into them.
class ChainTiming {
 public:
  ChainTiming(const SmoothPath& path, const ChainSpeeds& speeds, const JointLimits& limits,
              const PathOptions& options)
      : path_(path), speeds_(speeds), limits_(limits), options_(options) {}

  TimeLaw fastest() const {
    TimeLaw best;
    for (const double share : kCurveShares) {
      if (path_.pieces.size() > kManyPieces && share < kCurveShares.back()) continue;
      TimeLaw law = plan_speed(limits_of(share));
      if (!best.phases.empty() && law.duration >= best.duration) continue;
      best = std::move(law);
      if (path_.pieces.size() == 1) return best;  // a straight line has no curvature
    }
    return refined(std::move(best), {}, {});
  }

  TimeLaw refined(TimeLaw law, std::span<const SegmentLimits> stretches,
                  const EndSpeeds& ends) const {
    std::vector<double> v_top;
    for_each_piece(
        [&](const CubicPiece& piece, double h, const JointLimits& limits, const FeedLimit& feed) {
          v_top.push_back(straight_speed(piece, h, limits, feed));
        });
    return refine_time_law(std::move(law), path_, v_top, limits_, stretches, ends);
  }

  std::vector<SegmentLimits> limits_of(double curve_share) const {
    std::vector<SegmentLimits> out;
    out.reserve(path_.pieces.size());
    for_each_piece(
        [&](const CubicPiece& piece, double h, const JointLimits& limits, const FeedLimit& feed) {
          out.push_back(segment_limits(piece, h, limits, feed, curve_share));
          out.back().end = path_.end_of(out.size() - 1);
        });
    return merge_similar(out);
  }

 private:
  // Speed along the path at s on span n of a move under tool control: that of its chord in the
  // middle, and linear from there towards the middle of the next chord of the move.
  double speed_of(std::size_t n, double s) const {
    const auto middle = [&](std::size_t k) {
      return 0.5 * (path_.s[speeds_.spans[k].first] + path_.s[speeds_.spans[k].last]);
    };
    const auto speed = [&](std::size_t k) {
      return (path_.s[speeds_.spans[k].last] - path_.s[speeds_.spans[k].first]) /
             speeds_.time_of(speeds_.spans[k]);
    };
    const auto is_same = [&](std::size_t k) {
      return k < speeds_.spans.size() && speeds_.spans[k].move == speeds_.spans[n].move;
    };
    const std::size_t next = s > middle(n) ? n + 1 : n - 1, other = s > middle(n) ? n - 1 : n + 1;
    const std::size_t k = is_same(next) ? next : other;
    if (!is_same(k)) return speed(n);
    const double x = (s - middle(n)) / (middle(k) - middle(n));
    const double low = std::min(speed(n), speed(k)), high = std::max(speed(n), speed(k));
    return std::clamp(speed(n) + x * (speed(k) - speed(n)), 0.5 * low, 2.0 * high);
  }

  // The least feed of the moves that reach into a piece of the path; of the chords of one move
  // under tool control the mean, so that their steps do not add up to a slower feed.
  FeedLimit feed_between(double begin, double end, std::size_t k) const {
    FeedLimit feed = speeds_.feeds[speeds_.spans[k].feed];
    double way = 0.0, time = 0.0;
    for (std::size_t n = k; n < speeds_.spans.size(); ++n) {
      const ChainSpeeds::Span& span = speeds_.spans[n];
      const double first = path_.s[span.first], last = path_.s[span.last];
      if (n > k && first >= end) break;
      const FeedLimit& own = speeds_.feeds[span.feed];
      feed.linear = std::min(feed.linear, own.linear);
      feed.rotary = std::min(feed.rotary, own.rotary);
      feed.path = std::min(feed.path, own.path);
      if (n > k && speeds_.spans[n - 1].move != span.move) way = time = 0.0;
      const double share = std::min(end, last) - std::max(begin, first);
      if (speeds_.time_of(span) == 0.0 || share <= 0.0) continue;
      way += share;
      time += share / speed_of(n, 0.5 * (std::max(begin, first) + std::min(end, last)));
      const bool is_last = n + 1 == speeds_.spans.size() ||
                           speeds_.spans[n + 1].move != span.move ||
                           path_.s[speeds_.spans[n + 1].first] >= end;
      if (is_last) feed.path = std::min(feed.path, way / time);
    }
    return feed;
  }

  template <class F>
  void for_each_piece(F&& f) const {
    JointLimits rapid = limits_;
    rapid.v *= options_.rapid_override;
    std::size_t k = 0;
    for (std::size_t i = 0; i < path_.pieces.size(); ++i) {
      const CubicPiece& piece = path_.pieces[i];
      while (k + 1 < speeds_.spans.size() && piece.segment >= speeds_.spans[k].last) ++k;
      const FeedLimit feed = feed_between(piece.s, path_.end_of(i), k);
      f(piece, path_.end_of(i) - piece.s, speeds_.spans[k].rapid ? rapid : limits_, feed);
    }
  }

  const SmoothPath& path_;
  const ChainSpeeds& speeds_;
  const JointLimits& limits_;
  const PathOptions& options_;
};

}  // namespace

std::uint32_t ChainSpeeds::index_of(const FeedLimit& feed) {
  if (feeds.empty() || feeds.back() != feed) feeds.push_back(feed);
  return static_cast<std::uint32_t>(feeds.size() - 1);
}

double ChainSpeeds::time_of(const Span& span) const {
  return span.share == Trajectory::Chain::kWhole ? 0.0 : times[span.share];
}

void ChainSpeeds::clear() {
  spans.clear();
  feeds.clear();
  times.clear();
}

TimeLaw fastest_law(const SmoothPath& path, const ChainSpeeds& speeds, const JointLimits& limits,
                    const PathOptions& options) {
  return ChainTiming(path, speeds, limits, options).fastest();
}

std::vector<SegmentLimits> limits_along(const SmoothPath& path, const ChainSpeeds& speeds,
                                        const JointLimits& limits, const PathOptions& options) {
  return ChainTiming(path, speeds, limits, options).limits_of(kCurveShares.back());
}

TimeLaw refined_law(TimeLaw law, const SmoothPath& path, const ChainSpeeds& speeds,
                    const JointLimits& limits, const PathOptions& options,
                    const std::vector<SegmentLimits>& stretches, const EndSpeeds& ends) {
  return ChainTiming(path, speeds, limits, options).refined(std::move(law), stretches, ends);
}

}  // namespace servomill::controllers
