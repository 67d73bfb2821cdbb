#include "controllers/path/trajectory.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>

#include "controllers/path/quicken.h"
#include "controllers/path/stretch_limits.h"
#include "plant/vocabulary/arc_sweep.h"
#include "plant/vocabulary/interrupt.h"

namespace servomill::controllers {
namespace {

constexpr double kLeastChord = 1e-9;   // m, points closer than this to the last are skipped
constexpr double kLeastChain = 1e-12;  // m, below this there is no motion
constexpr double kReversal = -0.5;     // cosine of the sharpest corner that is not a stop
constexpr double kLongLeg = 3.0;       // windows, below it corners share their curvature
constexpr std::array<double, 3> kCurveShares = {0.25, 0.5, 0.8};  // tried on each chain
constexpr std::size_t kManyPieces = 1000;  // of which the last share is taken: see quicken.h
constexpr double kChordAngle = 0.1;        // rad, longest chord of an arc
constexpr double kSameCircle = 1e-9;    // m, by which circles that are meant to be one may differ
constexpr double kChordsPerWindow = 4;  // chords of an arc in the half-width of its window

}  // namespace

// Collects moves into chains and plans each when it ends.
class Planner {
 public:
  Planner(const JointLayout& layout, const JointLimits& limits, const PathOptions& options,
          const Joints& start, const TipMotions& tip)
      : layout_(layout), options_(options), tip_(tip) {
    assert(options.tolerance > 0.0 && options.exact_tolerance > 0.0);
    assert(options.rotary_tolerance > 0.0 && options.rotary_radius > 0.0);
    assert(options.feed_override > 0.0 && options.rapid_override > 0.0);
    assert(options.block_time >= 0.0 && options.tolerance_share > 0.0);
    scale_.setOnes();
    scale_.tail<kJoints - kLinearJoints>().setConstant(options.rotary_radius);
    limits_ = {limits.v.cwiseProduct(scale_), limits.a.cwiseProduct(scale_),
               limits.j.cwiseProduct(scale_)};
    out_.rotary_radius_ = options.rotary_radius;
    out_.start_ = out_.end_ = start;
    words_ = layout.words(start);
    restart();
  }

  Trajectory run(const MoveRange& moves) {
    out_.moves_.reserve(moves.size());
    std::size_t next = 0;
    for (const Move& move : moves) {
      throw_if_interrupted();
      const std::size_t i = next++;
      out_.moves_.push_back({move.s_begin, move.s_end, move.line, move.kind == MoveKind::rapid});
      switch (move.kind) {
        case MoveKind::rapid:
        case MoveKind::feed:
        case MoveKind::arc:
          if (move.tool_control == ToolControl::none)
            add_motion(move, i);
          else
            add_tip_motion(move, i);
          break;
        case MoveKind::dwell:
          add_dwell(move, i);
          break;
        case MoveKind::tool:
        case MoveKind::stop:
        case MoveKind::end:
          finish_chain();
          break;
        case MoveKind::spindle:
        case MoveKind::coolant:
        case MoveKind::message:
          break;
      }
    }
    finish_chain();
    out_.duration_ = t_;
    return std::move(out_);
  }

 private:
  using Chain = Trajectory::Chain;

  // A move as a part of the chain.
  struct Leg {
    bool rapid = false, rotary_only = false;
    bool stop_after = false, exact_corners = false;
    Joints tangent_begin, tangent_end;  // unit, scaled
    double length = 0.0;                // m, scaled
    double tolerance = 0.0;             // m
    double feed = 0.0;                  // m/s along the scaled path
  };

  struct LegSpan : Chain::Span {
    std::uint32_t feed = 0;  // index into feeds_
    bool rapid = false;
  };

  Joints scaled(const Joints& Q) const { return Q.cwiseProduct(scale_); }

  void add_motion(const Move& move, std::size_t index) {
    assert(move.kind == MoveKind::rapid || move.feed > 0.0);
    const Joints Q_end = layout_.joints(move.end_machine);
    const Joints u_end = scaled(Q_end);
    const Joints step = u_end - u_;
    if (move.kind != MoveKind::arc && step.isZero(0.0)) {
      if (move.path_mode == PathMode::exact_stop) finish_chain();
      return;
    }
    Leg leg;
    leg.rapid = move.kind == MoveKind::rapid;
    leg.stop_after = move.path_mode == PathMode::exact_stop;
    leg.exact_corners = move.path_mode == PathMode::exact_path;
    std::optional<ArcSweep> arc;
    if (move.kind == MoveKind::arc) {
      arc = arc_sweep(move, words_.head<3>());
      leg.tangent_begin = arc_tangent(*arc, step, 0.0);
      leg.tangent_end = arc_tangent(*arc, step, 1.0);
    } else {
      leg.rotary_only = step.head<kLinearJoints>().isZero(0.0);
      leg.tangent_begin = leg.tangent_end = step.normalized();
    }
    leg.length = arc ? arc->length() : step.norm();
    leg.tolerance = tolerance_of(move);
    leg.feed = speed_along(leg, move);
    if (last_ && must_stop(*last_, leg)) finish_chain();
    LegSpan span = begin_span(index, leg);
    span.feed = index_of(feed_limit(move, leg));
    if (arc) {
      const bool continues = last_ && last_arc_ && is_same_circle(*last_arc_, *arc, step);
      if (!continues) arc_index_ = static_cast<int>(index);
      // on one circle the joint of two arcs is a point like any other
      if (continues && !skipped_) vertices_.set_last_arc(arc_index_);
      add_arc(*arc, move, step, arc_index_);
    } else {
      add_point(u_end, move, leg.feed, -1);
    }
    span.last = last_vertex();
    if (span.last > span.first) spans_.push_back(span);
    last_move_ = index;
    u_ = u_end;
    Q_ = Q_end;
    words_ = move.end_machine;
    last_ = leg;
    last_arc_ = arc;
    if (leg.stop_after) finish_chain();
  }

  // A move under tool control is one leg of many chords. Their inner ends lie on a curve, as the
  // points of an arc do.
  void add_tip_motion(const Move& move, std::size_t index) {
    const TipMotion* motion = tip_.of(index);
    assert(motion != nullptr);
    const std::span<const JointChord> chords = tip_.chords_of(*motion);
    const Leg leg = tip_leg(move, *motion, chords);
    if (leg.length == 0.0) {
      if (leg.stop_after) finish_chain();
      return;
    }
    if (last_ && must_stop(*last_, leg)) finish_chain();
    const double time = time_of(*motion);
    double from = 0.0;
    for (const JointChord& chord : chords) {
      const bool inner = &chord != &chords.back();
      LegSpan span = begin_span(index, leg);
      span.feed = index_of(FeedLimit{});
      span.share = static_cast<std::uint32_t>(shares_.size());
      const double chord_time = time * (chord.fraction - from);
      add_chord(chord, chord_time, inner ? static_cast<int>(index) : -1);
      if (skipped_) continue;
      span.last = last_vertex();
      spans_.push_back(span);
      shares_.push_back({from, chord.fraction});
      times_.push_back(chord_time);
      from = chord.fraction;
    }
    if (from > 0.0) shares_.back().to = 1.0;
    last_move_ = index;
    Q_ = chords.back().end;
    u_ = scaled(Q_);
    words_ = layout_.words(Q_);
    last_ = leg;
    last_arc_.reset();
    if (leg.stop_after) finish_chain();
  }

  std::uint32_t last_vertex() const { return static_cast<std::uint32_t>(vertices_.size() - 1); }
  const Joints& last_u() const { return vertices_.u(vertices_.size() - 1); }

  LegSpan begin_span(std::size_t move, const Leg& leg) const {
    LegSpan span;
    span.move = static_cast<std::uint32_t>(move);
    span.first = last_vertex();
    span.rapid = leg.rapid;
    return span;
  }

  // The feed mostly is that of the move before.
  std::uint32_t index_of(const FeedLimit& feed) {
    if (feeds_.empty() || feeds_.back() != feed) feeds_.push_back(feed);
    return static_cast<std::uint32_t>(feeds_.size() - 1);
  }

  // s, least by the feed of the tip; 0: none is given
  double time_of(const LegSpan& span) const {
    return span.share == Chain::kWhole ? 0.0 : times_[span.share];
  }

  void add_chord(const JointChord& chord, double time, int arc) {
    const Joints u = scaled(chord.end);
    const double length = (u - last_u()).norm();
    skipped_ = length < kLeastChord;
    if (skipped_) return;
    const double speed = time > 0.0 ? length / time : limits_.v.norm();
    vertices_.push_back(
        {u, chord.tolerance_linear, chord.tolerance_rotary * options_.rotary_radius, speed, arc});
  }

  // Tangents where it begins and ends to move; length 0 if it does not.
  Leg tip_leg(const Move& move, const TipMotion& motion, std::span<const JointChord> chords) const {
    Leg leg;
    leg.rapid = move.kind == MoveKind::rapid;
    leg.stop_after = move.path_mode == PathMode::exact_stop;
    leg.exact_corners = move.path_mode == PathMode::exact_path;
    leg.tolerance = chords.empty() ? 0.0 : chords.front().tolerance_linear;
    Joints at = u_;
    for (const JointChord& chord : chords) {
      const Joints step = scaled(chord.end) - at;
      const double length = step.norm();
      at += step;
      if (length < kLeastChord) continue;
      if (leg.length == 0.0) leg.tangent_begin = step / length;
      leg.tangent_end = step / length;
      leg.length += length;
    }
    const double time = time_of(motion);
    leg.feed = time > 0.0 ? leg.length / time : limits_.v.norm();
    return leg;
  }

  // s, least by feed and block time; 0: none
  double time_of(const TipMotion& motion) const {
    return std::max(motion.time, options_.block_time);
  }

  // Returns true if an arc continues another one, on the same circle and in the same direction.
  static bool is_same_circle(const ArcSweep& one, const ArcSweep& next, const Joints& step) {
    const auto near = [](double a, double b) { return std::abs(a - b) < kSameCircle; };
    const bool is_flat = near(one.along_begin, one.along_end) &&
                         near(next.along_begin, next.along_end) &&
                         step.tail<kJoints - kLinearJoints>().isZero(0.0);
    return is_flat && one.c == next.c && (one.sweep > 0.0) == (next.sweep > 0.0) &&
           near(one.centre_a, next.centre_a) && near(one.centre_b, next.centre_b) &&
           near(one.r_begin, next.r_begin) && near(one.r_end, next.r_end) &&
           near(one.r_begin, one.r_end);
  }

  Joints arc_tangent(const ArcSweep& arc, const Joints& step, double fraction) const {
    Joints t = step;
    t.head<kLinearJoints>() = linear_joints(arc.derivative(fraction));
    return t.normalized();
  }

  // X Y Z in the order of the layout.
  Eigen::Vector3d linear_joints(const Eigen::Vector3d& p) const {
    AxisWords words = AxisWords::Zero();
    words.head<3>() = p;
    return layout_.joints(words).head<kLinearJoints>();
  }

  bool must_stop(const Leg& from, const Leg& to) const {
    if (from.rapid != to.rapid || from.rotary_only != to.rotary_only) return true;
    const double cosine = from.tangent_end.dot(to.tangent_begin);
    if (cosine < kReversal) return true;
    const Joints turn = to.tangent_begin - from.tangent_end;
    if (from.exact_corners || to.exact_corners) return turn.norm() > options_.exact_corner;
    return stopping_is_faster(from, to, turn);
  }

  // Programmed speed along the scaled path, where it goes straight.
  double speed_along(const Leg& leg, const Move& move) const {
    const Joints d = leg.tangent_begin.cwiseAbs();
    const FeedLimit feed = feed_limit(move, leg);
    double v = limits_.v.cwiseQuotient(d.cwiseMax(1e-12)).minCoeff();
    const double linear = d.head<kLinearJoints>().norm();
    const double rotary = d.tail<kJoints - kLinearJoints>().norm();
    if (linear > 0.0) v = std::min(v, feed.linear / linear);
    if (rotary > 0.0) v = std::min(v, feed.rotary / rotary);
    return std::min(v, feed.path);
  }

  // Does rounding a lone corner between long legs take longer than stopping in it? Compares the
  // time lost against passing at speed v: T for the stop, with T the time of the ramp from v to 0;
  // T_c (v - v_c)/v + 2 w (1/v_c - 1/v) for passing a window of half-width w at v_c.
  bool stopping_is_faster(const Leg& from, const Leg& to, const Joints& turn) const {
    const double linear = turn.head<kLinearJoints>().norm();
    const double w = 6.0 * std::min(from.tolerance, to.tolerance) / std::max(linear, 1e-12);
    const double L = std::min(from.length, to.length);
    if (L < kLongLeg * w) return false;
    const Joints d = from.tangent_end.cwiseAbs().cwiseMax(to.tangent_begin.cwiseAbs());
    const double a = limits_.a.cwiseQuotient(d.cwiseMax(1e-12)).minCoeff();
    const double j = limits_.j.cwiseQuotient(d.cwiseMax(1e-12)).minCoeff();
    const double peak = std::pow(L * std::sqrt(j) / 2.0, 2.0 / 3.0);  // rest to rest on the leg
    const double v = std::min({from.feed, to.feed, peak});
    const Joints bend = turn.cwiseAbs().cwiseMax(1e-12);
    const double v_c = std::min(std::cbrt(limits_.j.cwiseQuotient(bend).minCoeff() * w * w),
                                std::sqrt(limits_.a.cwiseQuotient(bend).minCoeff() * w));
    if (v_c >= v) return false;
    const auto ramp = [&](double dv) {
      return dv * j > a * a ? dv / a + a / j : 2.0 * std::sqrt(dv / j);
    };
    return ramp(v) < ramp(v - v_c) * (v - v_c) / v + 2.0 * w * (1.0 / v_c - 1.0 / v);
  }

  FeedLimit feed_limit(const Move& move, const Leg& leg) const {
    FeedLimit feed;
    if (options_.block_time > 0.0) feed.path = leg.length / options_.block_time;
    if (leg.rapid) return feed;
    const double value = move.feed * options_.feed_override;
    (leg.rotary_only ? feed.rotary : feed.linear) =
        leg.rotary_only ? value * options_.rotary_radius : value;
    return feed;
  }

  double tolerance_of(const Move& move) const {
    if (move.path_mode != PathMode::continuous) return options_.exact_tolerance;
    const double programmed = options_.tolerance_share * move.path_tolerance;
    return programmed > 0.0 ? programmed : options_.tolerance;
  }

  void add_arc(const ArcSweep& arc, const Move& move, const Joints& step, int index) {
    const double radius = std::max(arc.r_begin, arc.r_end), sweep = std::abs(arc.sweep);
    const double window = std::sqrt(12.0 * tolerance_of(move) * radius);
    const double chord = std::min(kChordAngle, window / kChordsPerWindow / radius);
    const int n = std::max(1, static_cast<int>(std::ceil(sweep / chord)));
    const Joints u_begin = u_;
    for (int i = 1; i <= n; ++i) {
      const double fraction = static_cast<double>(i) / n;
      Joints u = u_begin + step * fraction;
      u.head<kLinearJoints>() = linear_joints(arc.point(fraction));
      if (i == n) u = u_begin + step;
      add_point(u, move, 0.0, i < n ? index : -1);
    }
  }

  void add_point(const Joints& u, const Move& move, double speed, int arc) {
    PathVertex vertex{u, tolerance_of(move), options_.rotary_tolerance, speed, arc};
    if (move.path_mode != PathMode::continuous) {
      vertex.tolerance_rotary *= options_.exact_tolerance / options_.tolerance;
    }
    vertex.tolerance_rotary *= options_.rotary_radius;
    skipped_ = (u - last_u()).norm() < kLeastChord;
    if (!skipped_) vertices_.push_back(vertex);
  }

  void add_dwell(const Move& move, std::size_t index) {
    assert(move.value >= 0.0);
    finish_chain();
    Chain chain;
    chain.t = t_;
    chain.duration = move.value;
    chain.begin = chain.end = Q_;
    chain.spans.push_back({static_cast<std::uint32_t>(index)});
    t_ += chain.duration;
    out_.chains_.push_back(std::move(chain));
  }

  void restart() {
    Q_ = out_.end_;
    u_ = scaled(Q_);
    vertices_.clear();
    vertices_.push_back(PathVertex{u_, 0.0, 0.0, 0.0, -1});
    spans_.clear();
    feeds_.clear();
    shares_.clear();
    times_.clear();
    last_.reset();
    last_arc_.reset();
    skipped_ = false;
  }

  void finish_chain() {
    if (!last_) return;
    if (skipped_) reach_end();
    if (vertices_.size() > 1) {
      Chain chain;
      chain.t = t_;
      chain.begin = out_.end_;
      chain.end = Q_;
      chain.path = smooth(std::move(vertices_), limits_.j);
      chain.path.pieces.shrink_to_fit();
      plan_fastest(chain);
      chain.duration = chain.law.duration;
      chain.spans.assign(spans_.begin(), spans_.end());
      chain.shares = std::move(shares_);
      t_ += chain.duration;
      out_.chains_.push_back(std::move(chain));
    }
    out_.end_ = Q_;
    restart();
  }

  // The end lies within kLeastChord of the last vertex, but not on it.
  void reach_end() {
    if ((u_ - last_u()).norm() <= kLeastChain) return;
    const double speed = vertices_.speed(vertices_.size() - 1);
    if (spans_.empty()) {
      LegSpan span = begin_span(last_move_, *last_);
      span.first = 0;
      span.feed = index_of(FeedLimit{});
      spans_.push_back(span);
    }
    vertices_.push_back({u_, options_.tolerance, options_.rotary_tolerance, speed, -1});
    spans_.back().last = last_vertex();
    if (spans_.back().share != Chain::kWhole) shares_.back().to = 1.0;
  }

  void plan_fastest(Chain& chain) const {
    for (const double share : kCurveShares) {
      if (chain.path.pieces.size() > kManyPieces && share < kCurveShares.back()) continue;
      TimeLaw law = plan_speed(limits_of(chain.path, share));
      if (!chain.law.phases.empty() && law.duration >= chain.law.duration) continue;
      chain.law = std::move(law);
      if (chain.path.pieces.size() == 1) return;  // a straight line has no curvature
    }
    std::vector<double> v_top;
    for_each_piece(chain.path, [&](const CubicPiece& piece, double h, const JointLimits& limits,
                                   const FeedLimit& feed) {
      v_top.push_back(straight_speed(piece, h, limits, feed));
    });
    chain.law = quicken(std::move(chain.law), chain.path, v_top, limits_);
  }

  // Speed along the path at s on span n of a move under tool control: that of its chord in the
  // middle, and linear from there towards the middle of the next chord of the move.
  double speed_of(std::size_t n, double s, const SmoothPath& path) const {
    const auto middle = [&](std::size_t k) {
      return 0.5 * (path.s[spans_[k].first] + path.s[spans_[k].last]);
    };
    const auto speed = [&](std::size_t k) {
      return (path.s[spans_[k].last] - path.s[spans_[k].first]) / time_of(spans_[k]);
    };
    const auto is_same = [&](std::size_t k) {
      return k < spans_.size() && spans_[k].move == spans_[n].move;
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
  FeedLimit feed_between(double begin, double end, std::size_t k, const SmoothPath& path) const {
    FeedLimit feed = feeds_[spans_[k].feed];
    double way = 0.0, time = 0.0;
    for (std::size_t n = k; n < spans_.size(); ++n) {
      const LegSpan& span = spans_[n];
      const double first = path.s[span.first], last = path.s[span.last];
      if (n > k && first >= end) break;
      const FeedLimit& own = feeds_[span.feed];
      feed.linear = std::min(feed.linear, own.linear);
      feed.rotary = std::min(feed.rotary, own.rotary);
      feed.path = std::min(feed.path, own.path);
      if (n > k && spans_[n - 1].move != span.move) way = time = 0.0;
      const double share = std::min(end, last) - std::max(begin, first);
      if (time_of(span) == 0.0 || share <= 0.0) continue;
      way += share;
      time += share / speed_of(n, 0.5 * (std::max(begin, first) + std::min(end, last)), path);
      const bool is_last = n + 1 == spans_.size() || spans_[n + 1].move != span.move ||
                           path.s[spans_[n + 1].first] >= end;
      if (is_last) feed.path = std::min(feed.path, way / time);
    }
    return feed;
  }

  template <class F>
  void for_each_piece(const SmoothPath& path, F&& f) const {
    JointLimits rapid = limits_;
    rapid.v *= options_.rapid_override;
    std::size_t k = 0;
    for (std::size_t i = 0; i < path.pieces.size(); ++i) {
      const CubicPiece& piece = path.pieces[i];
      while (k + 1 < spans_.size() && piece.segment >= spans_[k].last) ++k;
      const FeedLimit feed = feed_between(piece.s, path.end_of(i), k, path);
      f(piece, path.end_of(i) - piece.s, spans_[k].rapid ? rapid : limits_, feed);
    }
  }

  std::vector<StretchLimits> limits_of(const SmoothPath& path, double curve_share) const {
    std::vector<StretchLimits> out;
    out.reserve(path.pieces.size());
    for_each_piece(path, [&](const CubicPiece& piece, double h, const JointLimits& limits,
                             const FeedLimit& feed) {
      out.push_back(stretch_limits(piece, h, limits, feed, curve_share));
      out.back().end = path.end_of(out.size() - 1);
    });
    return merge_similar(out);
  }

  const JointLayout& layout_;
  PathOptions options_;
  const TipMotions& tip_;
  JointLimits limits_;  // scaled
  Joints scale_;
  Trajectory out_;
  double t_ = 0.0;
  // of the chain being collected
  AxisWords words_;                   // where it is, machine coordinates
  Joints Q_, u_;                      // the same, joints; scaled
  std::optional<ArcSweep> last_arc_;  // of the leg before, if it was an arc
  int arc_index_ = -1;                // of the circle that is being followed
  Polyline vertices_;
  std::vector<LegSpan> spans_;
  std::vector<FeedLimit> feeds_;
  std::vector<Chain::Share> shares_;  // of chords of moves under tool control,
  std::vector<double> times_;         // and their least times by the feed of the tip, s
  std::optional<Leg> last_;
  std::size_t last_move_ = 0;
  bool skipped_ = false;  // the last point was too close to the one before
};

Trajectory plan(const MoveRange& moves, const JointLayout& layout, const Joints& start,
                const JointLimits& limits, const PathOptions& options, const TipMotions& tip) {
  return Planner(layout, limits, options, start, tip).run(moves);
}

Trajectory::Sample Trajectory::rest(const Joints& Q, std::size_t move, bool at_end) const {
  Sample out;
  out.Q_ref = Q;
  out.dQ_ref = out.ddQ_ref = out.dddQ_ref = Joints::Zero();
  if (move >= moves_.size()) return out;
  const MoveInfo& info = moves_[move];
  out.s = at_end ? info.s_end : info.s_begin;
  out.line = info.line;
  out.move = move;
  out.rapid = info.rapid;
  return out;
}

Trajectory::Sample Trajectory::at(double t, Cursor& c) const {
  if (chains_.empty()) return rest(start_, 0, false);
  if (t <= 0.0) return rest(start_, chains_.front().spans.front().move, false);
  if (t >= duration_) return rest(end_, chains_.back().spans.back().move, true);
  if (c.chain >= chains_.size() || t < chains_[c.chain].t) c = {};
  while (c.chain + 1 < chains_.size() && t >= chains_[c.chain + 1].t) c = {c.chain + 1, 0, 0, 0};
  const Chain& chain = chains_[c.chain];
  if (chain.path.pieces.empty()) return rest(chain.begin, chain.spans.front().move, false);

  // position on the path
  const double time = t - chain.t;
  const std::vector<Phase>& phases = chain.law.phases;
  if (time < phases[c.phase].t) c = {c.chain, 0, 0, 0};
  while (c.phase + 1 < phases.size() && time >= phases[c.phase + 1].t) ++c.phase;
  const Phase& p = phases[c.phase];
  const Phase::State now = p.at(time);
  const double s = std::clamp(now.s, 0.0, chain.path.length());
  const double v = std::max(now.v, 0.0), a = now.a;

  // the path there
  const std::vector<CubicPiece>& pieces = chain.path.pieces;
  while (c.piece > 0 && s < pieces[c.piece].s) --c.piece;
  while (c.piece + 1 < pieces.size() && s >= pieces[c.piece + 1].s) ++c.piece;
  const CubicPiece& q = pieces[c.piece];
  const double y = s - q.s;
  const Joints d1 = q.c1 + y * (q.c2 + q.c3 * (y / 2.0)), d2 = q.c2 + q.c3 * y;
  while (c.span > 0 && s < chain.begin_of(chain.spans[c.span])) --c.span;
  while (c.span + 1 < chain.spans.size() && s >= chain.end_of(chain.spans[c.span])) ++c.span;
  const Chain::Span& span = chain.spans[c.span];
  const MoveInfo& info = moves_[span.move];

  Sample out;
  out.Q_ref = q.c0 + y * (q.c1 + y * (q.c2 / 2.0 + q.c3 * (y / 6.0)));
  out.dQ_ref = d1 * v;
  out.ddQ_ref = d2 * (v * v) + d1 * a;
  out.dddQ_ref = q.c3 * (v * v * v) + d2 * (3.0 * v * a) + d1 * now.j;
  for (Joints* part : {&out.Q_ref, &out.dQ_ref, &out.ddQ_ref, &out.dddQ_ref}) {
    part->tail<kJoints - kLinearJoints>() /= rotary_radius_;
  }
  const double s_begin = chain.begin_of(span), s_end = chain.end_of(span);
  const double x = std::clamp((s - s_begin) / (s_end - s_begin), 0.0, 1.0);
  const auto [from, to] = chain.share_of(span);
  const double f = from + x * (to - from);
  out.s = info.s_begin + f * (info.s_end - info.s_begin);
  out.line = info.line;
  out.move = span.move;
  out.rapid = info.rapid;
  return out;
}

}  // namespace servomill::controllers
