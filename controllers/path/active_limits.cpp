#include "controllers/path/active_limits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "plant/vocabulary/interrupt.h"

namespace servomill::controllers {
namespace {

using Chain = Trajectory::Chain;

// Feed of a move, and the form of its path.
struct MoveFeed {
  double feed = 0.0;  // m/s or rad/s, override applied; 0: rapid
  double way = 0.0;   // m, programmed length
  bool controls_tip = false;
  bool is_curved = false;  // the programmed path itself has curvature
};

std::vector<MoveFeed> feeds_of(const MoveRange& moves, const PathOptions& options) {
  std::vector<MoveFeed> out;
  out.reserve(moves.size());
  for (const Move& move : moves) {
    const bool controls_tip = move.tool_control != ToolControl::none;
    const bool has_feed = is_motion(move.kind) && move.kind != MoveKind::rapid;
    out.push_back({has_feed ? move.feed * options.feed_override : 0.0, move.s_end - move.s_begin,
                   controls_tip, controls_tip || move.kind == MoveKind::arc});
  }
  return out;
}

// Time (s) at which a phase reaches s, within [from, to]; s(from) <= s.
double time_at(const Phase& phase, double s, double from, double to) {
  // Newton within a bracket that halves where a step leaves it: from an hour to 1e-13 s in 56
  // halvings.
  constexpr int kSteps = 60;
  constexpr double kResolution = 1e-13;  // s
  double t = from;
  for (int i = 0; i < kSteps && to - from > kResolution; ++i) {
    const Phase::State now = phase.at(t);
    (now.s < s ? from : to) = t;
    const double step = now.v > 0.0 ? (s - now.s) / now.v : 0.0;
    if (now.v > 0.0 && std::abs(step) < kResolution) return std::clamp(t + step, from, to);
    const double next = t + step;
    t = next > from && next < to ? next : 0.5 * (from + to);
  }
  return t;
}

// The limit that is used most.
struct MostUsed {
  double use = 0.0;
  LimitKind kind = LimitKind::none;
  int joint = -1;

  void add(double other, LimitKind other_kind, int other_joint = -1) {
    if (!(other > use)) return;
    use = other;
    kind = other_kind;
    joint = other_joint;
  }
};

// Goes through the motions from rest to rest.
class StretchWalk {
 public:
  StretchWalk(const MoveRange& moves, const Trajectory& trajectory, const JointLimits& limits,
              const PathOptions& options, const std::function<void(const MotionStretch&)>& take)
      : feeds_(feeds_of(moves, options)), limits_(limits), options_(options), take_(take) {
    for (Joints* one : {&limits_.v, &limits_.a, &limits_.j}) {
      one->tail<kJoints - kLinearJoints>() *= trajectory.rotary_radius();
    }
  }

  void walk(const Chain& chain) {
    if (chain.plan == nullptr) {
      take_({chain.spans.front().move, chain.duration});
      return;
    }
    const SmoothPath& path = chain.plan->path;
    const std::vector<Phase>& phases = chain.plan->law.phases;
    std::size_t i = 0, n = 0;  // piece, span
    double t = 0.0;
    for (std::size_t k = 0; k < phases.size();) {
      const bool is_last = k + 1 == phases.size();
      const double t_phase = is_last ? chain.plan->law.duration : phases[k + 1].t;
      const double s_phase = is_last ? path.length() : phases[k + 1].s;
      const double s_piece = i + 1 < path.pieces.size() ? path.end_of(i) : kNever;
      const double s_span = n + 1 < chain.spans.size() ? chain.end_of(chain.spans[n]) : kNever;
      const double s = std::min(s_piece, s_span);
      const bool is_within = s < s_phase;
      const double t_next = is_within ? time_at(phases[k], s, t, t_phase) : t_phase;
      if (t_next > t) add(chain, phases[k], path.pieces[i], n, t, t_next);
      t = std::max(t, t_next);
      if (!is_within) ++k;
      if (is_within && s_piece == s) ++i;
      if (is_within && s_span == s) ++n;
    }
  }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  void add(const Chain& chain, const Phase& phase, const CubicPiece& piece, std::size_t n,
           double from, double to) {
    const Phase::State now = phase.at(0.5 * (from + to));
    const Chain::Span& span = chain.spans[n];
    const double y = now.s - piece.s;
    const Joints d1 = piece.c1 + y * (piece.c2 + piece.c3 * (y / 2.0));
    const Joints d2 = piece.c2 + piece.c3 * y;
    MostUsed most;
    add_feed(chain, span, d1, now.v, most);
    add_joints(feeds_[span.move], d1, d2, piece.c3, now, most);
    if (most.use < kInUse) most = {};
    take_({span.move, to - from, most.kind, most.joint});
  }

  // Speed of X, Y and Z, of the rotary joints with those at rest, of the tip under TCP control.
  void add_feed(const Chain& chain, const Chain::Span& span, const Joints& d1, double v,
                MostUsed& most) const {
    const double length = chain.end_of(span) - chain.begin_of(span);
    const auto [from, to] = chain.share_of(span);
    const double moves_per_second = length > 0.0 ? v * (to - from) / length : 0.0;
    if (options_.block_time > 0.0) {
      most.add(options_.block_time * moves_per_second, LimitKind::block_time);
    }
    const MoveFeed& move = feeds_[span.move];
    if (!(move.feed > 0.0)) return;
    const double linear = d1.head<kLinearJoints>().norm();
    const double rotary = d1.tail<kJoints - kLinearJoints>().norm() / options_.rotary_radius;
    const bool tip_moves = move.controls_tip && move.way > 0.0;
    const bool is_rotary = !tip_moves && (linear == 0.0 || move.controls_tip);
    const double speed =
        tip_moves ? move.way * moves_per_second : (is_rotary ? rotary : linear) * v;
    most.add(speed / move.feed, LimitKind::feed);
  }

  void add_joints(const MoveFeed& move, const Joints& d1, const Joints& d2, const Joints& d3,
                  const Phase::State& now, MostUsed& most) const {
    const double rapid = move.feed > 0.0 ? 1.0 : options_.rapid_override;
    for (int j = 0; j < kJoints; ++j) {
      if (!(limits_.v[j] > 0.0 && limits_.a[j] > 0.0 && limits_.j[j] > 0.0)) continue;
      most.add(std::abs(d1[j]) * now.v / (rapid * limits_.v[j]), LimitKind::velocity, j);
      const double bend2 = d2[j] * now.v * now.v, ramp2 = d1[j] * now.a;
      const double bend3 = d3[j] * now.v * now.v * now.v + 3.0 * d2[j] * now.v * now.a;
      const double ramp3 = d1[j] * now.j;
      const auto kind = [&](LimitKind straight, double bend, double ramp) {
        return !move.is_curved && std::abs(bend) > std::abs(ramp) ? LimitKind::corner : straight;
      };
      most.add(std::abs(bend2 + ramp2) / limits_.a[j], kind(LimitKind::acceleration, bend2, ramp2),
               j);
      most.add(std::abs(bend3 + ramp3) / limits_.j[j], kind(LimitKind::jerk, bend3, ramp3), j);
    }
  }

  std::vector<MoveFeed> feeds_;
  JointLimits limits_;  // scaled
  PathOptions options_;
  const std::function<void(const MotionStretch&)>& take_;
};

}  // namespace

void for_each_stretch(const MoveRange& moves, const Trajectory& trajectory,
                      const JointLimits& limits, const PathOptions& options,
                      const std::function<void(const MotionStretch&)>& take) {
  StretchWalk walk(moves, trajectory, limits, options, take);
  for (std::size_t n = 0; n < trajectory.chains(); ++n) {
    throw_if_interrupted();
    walk.walk(*trajectory.chain(n));
  }
}

}  // namespace servomill::controllers
