// Planning of a program: collects its moves into motions from rest to rest.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "controllers/path/chain_memory.h"
#include "controllers/path/chain_speeds.h"
#include "controllers/path/collected_motion.h"
#include "controllers/path/curve_points.h"
#include "controllers/path/motion_stretches.h"
#include "controllers/path/path_leg.h"
#include "controllers/path/stored_chain.h"
#include "controllers/path/tcp_motion.h"
#include "controllers/path/trajectory.h"
#include "plant/vocabulary/arc_sweep.h"
#include "plant/vocabulary/interrupt.h"

namespace servomill::controllers {
namespace {

constexpr double kMinChord = 1e-9;   // m, points closer than this to the last are skipped
constexpr double kMinChain = 1e-12;  // m, below this there is no motion

}  // namespace

// Collects moves into chains and plans each when it ends.
class Planner {
 public:
  Planner(const JointLayout& layout, const JointLimits& limits, const PathOptions& options,
          const Joints& start, const TipMotions& tip)
      : layout_(layout),
        options_(options),
        tip_(tip),
        scale_(scale_of(options)),
        limits_{limits.v.cwiseProduct(scale_), limits.a.cwiseProduct(scale_),
                limits.j.cwiseProduct(scale_)},
        rules_(limits_, options),
        store_(options.plans_in_memory),
        stretches_(limits_, options) {
    assert(options.tolerance > 0.0 && options.exact_tolerance > 0.0);
    assert(options.rotary_tolerance > 0.0 && options.rotary_radius > 0.0);
    assert(options.feed_override > 0.0 && options.rapid_override > 0.0);
    assert(options.block_time >= 0.0 && options.tolerance_share > 0.0);
    out_.rotary_radius_ = options.rotary_radius;
    out_.start_ = out_.end_ = start;
    words_ = layout.words(start);
    restart();
  }

  Trajectory run(const MoveRange& moves) {
    std::size_t next = 0;
    for (const Move& move : moves) {
      throw_if_interrupted();
      const std::size_t i = next++;
      switch (move.kind) {
        case MoveKind::spline:
          add_spline(move, i);
          break;
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

  Joints scaled(const Joints& Q) const { return Q.cwiseProduct(scale_); }

  void go_on_behind(const Leg& leg) {
    if (leg.stop_after) return finish_chain();
    divide_long_motion();
  }

  // A move that moves nothing.
  void stand(const Leg& leg) {
    if (leg.stop_after) finish_chain();
  }

  void add_motion(const Move& move, std::size_t index) {
    assert(move.kind == MoveKind::rapid || move.feed > 0.0);
    const Joints Q_end = layout_.joints(move.end_machine);
    const Joints u_end = scaled(Q_end);
    const Joints step = u_end - u_;
    if (move.kind != MoveKind::arc && step.isZero(0.0)) return stand(leg_of(move));
    Leg leg = leg_of(move);
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
    leg.tolerance = rules_.tolerance_of(move);
    leg.feed = rules_.speed_along(leg, move);
    leg.acceleration_share = rules_.acceleration_share(leg, move);
    if (last_ && rules_.must_stop(*last_, leg)) finish_chain();
    ChainSpeeds::Span span = motion_.begin_span(move, index);
    span.feed = motion_.speeds.index_of(rules_.feed_limit(move, leg));
    if (arc) {
      const auto begin = end_of_circle(*arc, step, 0.0);
      join_curve(index, last_arc_ ? is_same_circle(*last_arc_, *arc, step)
                                  : last_end_ && begin && goes_on(*last_end_, *begin));
      add_arc(*arc, move, step, arc_index_);
    } else {
      add_point(u_end, move, leg.feed, -1);
    }
    span.last = motion_.last_vertex();
    if (span.last > span.first) motion_.speeds.spans.push_back(span);
    last_span_ = motion_.begin_span(move, index);
    u_ = u_end;
    Q_ = Q_end;
    words_ = move.end_machine;
    last_ = leg;
    last_arc_ = arc;
    last_end_ = arc ? end_of_circle(*arc, step, 1.0) : std::nullopt;
    go_on_behind(leg);
  }

  // On one circle, or on curves that go on in each other, the joint is a point like any other.
  void join_curve(std::size_t index, bool continues) {
    continues = continues && last_;
    if (!continues) arc_index_ = static_cast<int>(index);
    if (continues && !skipped_) motion_.vertices.set_last_arc(arc_index_);
  }

  // X and Y on a spline; the other axes are at rest.
  void add_spline(const Move& move, std::size_t index) {
    assert(move.tool_control == ToolControl::none && move.feed > 0.0);
    const SplineCurve& curve = move.spline->curve;
    if (curve.length() == 0.0) return stand(leg_of(move));
    const SplineCurve::State begin = curve.state(0.0), end = curve.state(curve.length());
    Leg leg = leg_of(move);
    leg.tangent_begin = with_linear(Joints::Zero(), begin.tangent);
    leg.tangent_end = with_linear(Joints::Zero(), end.tangent);
    leg.length = curve.length();
    leg.tolerance = rules_.tolerance_of(move);
    leg.feed = rules_.speed_along(leg, move);
    if (last_ && rules_.must_stop(*last_, leg)) finish_chain();
    const std::uint32_t feed = motion_.speeds.index_of(rules_.feed_limit(move, leg));
    join_curve(index, last_end_ && goes_on(*last_end_, {begin.tangent, begin.curvature}));
    double from = 0.0;
    for (const CurvePoint& point : points_of(curve, leg.tolerance)) {
      ChainSpeeds::Span span = motion_.begin_span(move, index);
      span.feed = feed;
      add_point(with_linear(u_, point.p), move, 0.0, point.is_inside ? arc_index_ : -1, true);
      if (skipped_) continue;
      motion_.end_part(span, from, point.share, 0.0);
      from = point.share;
    }
    if (from > 0.0) motion_.shares.back().to = 1.0;
    last_span_ = motion_.begin_span(move, index);
    Q_ = layout_.joints(move.end_machine);
    u_ = scaled(Q_);
    words_ = move.end_machine;
    last_ = leg;
    last_arc_.reset();
    last_end_ = CurveEnd{end.tangent, end.curvature};
    go_on_behind(leg);
  }

  // A move under tool control is one leg of many chords. Their inner ends lie on a curve, as the
  // points of an arc do.
  void add_tip_motion(const Move& move, std::size_t index) {
    const TcpMotion& motion = tip_.of(index);
    const std::span<const JointChord> chords = tip_.chords_of(motion);
    const Leg leg = tip_leg(move, motion, chords);
    if (leg.length == 0.0) return stand(leg);
    if (last_ && rules_.must_stop(*last_, leg)) finish_chain();
    const double time = time_of(motion);
    double from = 0.0;
    for (const JointChord& chord : chords) {
      const bool inner = &chord != &chords.back();
      ChainSpeeds::Span span = motion_.begin_span(move, index);
      span.feed = motion_.speeds.index_of(FeedLimit{});
      const double chord_time = time * (chord.fraction - from);
      add_chord(chord, chord_time, inner ? static_cast<int>(index) : -1);
      if (skipped_) continue;
      motion_.end_part(span, from, chord.fraction, chord_time);
      from = chord.fraction;
    }
    if (from > 0.0) motion_.shares.back().to = 1.0;
    last_span_ = motion_.begin_span(move, index);
    Q_ = chords.back().end;
    u_ = scaled(Q_);
    words_ = layout_.words(Q_);
    last_ = leg;
    last_arc_.reset();
    last_end_.reset();
    go_on_behind(leg);
  }

  void add_chord(const JointChord& chord, double time, int arc) {
    const Joints u = scaled(chord.end);
    const double length = (u - motion_.last_u()).norm();
    skipped_ = length < kMinChord;
    if (skipped_) return;
    const double speed = time > 0.0 ? length / time : limits_.v.norm();
    motion_.vertices.push_back(
        {u, chord.tolerance_linear, chord.tolerance_rotary * options_.rotary_radius, speed, arc});
  }

  // Tangents where it begins and ends to move; length 0 if it does not.
  Leg tip_leg(const Move& move, const TcpMotion& motion, std::span<const JointChord> chords) const {
    Leg leg = leg_of(move);
    set_tolerances(leg, chords, options_.rotary_radius);
    Joints at = u_;
    for (const JointChord& chord : chords) {
      const Joints step = scaled(chord.end) - at;
      const double length = step.norm();
      at += step;
      if (length < kMinChord) continue;
      if (leg.length == 0.0) leg.tangent_begin = step / length;
      leg.tangent_end = step / length;
      leg.length += length;
    }
    const double time = time_of(motion);
    leg.feed = time > 0.0 ? leg.length / time : limits_.v.norm();
    return leg;
  }

  // s, least by feed and block time; 0: none
  double time_of(const TcpMotion& motion) const {
    return std::max(motion.time, options_.block_time);
  }

  Joints arc_tangent(const ArcSweep& arc, const Joints& step, double fraction) const {
    return with_linear(step, arc.derivative(fraction)).normalized();
  }

  // With X Y Z in the order of the layout.
  Joints with_linear(Joints u, const Eigen::Vector3d& p) const {
    AxisWords words = AxisWords::Zero();
    words.head<3>() = p;
    u.head<kLinearJoints>() = layout_.joints(words).head<kLinearJoints>();
    return u;
  }

  void add_arc(const ArcSweep& arc, const Move& move, const Joints& step, int index) {
    const double radius = std::max(arc.r_begin, arc.r_end), sweep = std::abs(arc.sweep);
    const double chord = chord_angle(radius, rules_.tolerance_of(move));
    const int n = std::max(1, static_cast<int>(std::ceil(sweep / chord)));
    const Joints u_begin = u_;
    for (int i = 1; i <= n; ++i) {
      const double fraction = static_cast<double>(i) / n;
      Joints u = with_linear(u_begin + step * fraction, arc.point(fraction));
      if (i == n) u = u_begin + step;
      add_point(u, move, 0.0, i < n ? index : -1);
    }
  }

  void add_point(const Joints& u, const Move& move, double speed, int arc, bool is_exact = false) {
    PathVertex vertex{u,       rules_.tolerance_of(move), options_.rotary_tolerance, speed, arc,
                      is_exact};
    if (move.path_mode != PathMode::continuous) {
      vertex.tolerance_rotary *= options_.exact_tolerance / options_.tolerance;
    }
    vertex.tolerance_rotary *= options_.rotary_radius;
    skipped_ = (u - motion_.last_u()).norm() < kMinChord;
    if (!skipped_) motion_.vertices.push_back(vertex);
  }

  void add_dwell(const Move& move, std::size_t index) {
    assert(move.value >= 0.0);
    finish_chain();
    Chain chain;
    chain.duration = move.value;
    chain.spans.push_back(motion_.begin_span(move, index));
    append(std::move(chain), Q_);
  }

  void restart() {
    Q_ = out_.end_;
    u_ = scaled(Q_);
    motion_.start_at(u_);
    longest_ = options_.stretch;
    last_.reset();
    last_arc_.reset();
    last_end_.reset();
    skipped_ = false;
  }

  void finish_chain() {
    if (!last_) return;
    if (skipped_) reach_end();
    if (!stretches_.empty()) {
      add_stretch(std::move(motion_));
      append(stretches_.finish(), Q_);
    } else if (motion_.vertices.size() > 1) {
      Chain chain;
      const auto make = [this] { return plan_chain(); };
      chain.plan = last_->acceleration_share < 1.0
                       ? make()
                       : memory_.plan(motion_.vertices, motion_.speeds, make);
      chain.duration = chain.plan->law.duration;
      chain.spans.assign(motion_.speeds.spans.begin(), motion_.speeds.spans.end());
      chain.shares = std::move(motion_.shares);
      append(std::move(chain), Q_);
    }
    out_.end_ = Q_;
    restart();
  }

  void append(Chain chain, const Joints& end) {
    chain.t = t_;
    chain.begin = out_.end_;
    chain.end = out_.end_ = end;
    t_ += chain.duration;
    if (out_.chains_.empty()) out_.first_ = chain.spans.front();
    out_.last_ = chain.spans.back();
    out_.chains_.push_back(store_.keep(std::move(chain)));
  }

  // A motion of many vertices goes on in a stretch of its own.
  void divide_long_motion() {
    if (motion_.vertices.size() <= longest_ || last_->acceleration_share < 1.0) return;
    if (const auto seam = motion_.seam()) return add_stretch(motion_.take_before(*seam));
    longest_ *= 2;
  }

  void add_stretch(CollectedMotion motion) {
    const Joints end = seam_;
    seam_ = motion.last_u().cwiseQuotient(scale_);
    if (auto before = stretches_.add(std::move(motion))) append(*std::move(before), end);
  }

  // Plans the motion along the vertices, which are gone afterwards.
  ChainMemory::Plan plan_chain() {
    auto plan = std::make_shared<Chain::Plan>();
    plan->path = smooth(std::move(motion_.vertices), limits_.j);
    plan->path.pieces.shrink_to_fit();
    plan->law = fastest_law(plan->path, motion_.speeds, limits_of(*last_, limits_), options_);
    return plan;
  }

  // The end lies within kMinChord of the last vertex, but not on it.
  void reach_end() {
    if ((u_ - motion_.last_u()).norm() <= kMinChain) return;
    const double speed = motion_.vertices.speed(motion_.last_vertex());
    motion_.end_at({u_, options_.tolerance, options_.rotary_tolerance, speed, -1}, last_span_);
  }

  const JointLayout& layout_;
  PathOptions options_;
  const TipMotions& tip_;
  Joints scale_;
  JointLimits limits_;  // scaled
  LegRules rules_;
  Trajectory out_;
  ChainMemory memory_;
  ChainStore store_;
  MotionStretches stretches_;
  Joints seam_ = Joints::Zero();  // m, rad; where the stretch that waits ends
  std::size_t longest_ = 0;       // vertices of a stretch
  double t_ = 0.0;
  // of the chain being collected
  AxisWords words_;                   // where it is, machine coordinates
  Joints Q_, u_;                      // the same, joints; scaled
  std::optional<ArcSweep> last_arc_;  // of the leg before, if it was an arc
  std::optional<CurveEnd> last_end_;  // of the leg before, if it was a circle or a spline
  int arc_index_ = -1;                // of the circle that is being followed
  CollectedMotion motion_;
  std::optional<Leg> last_;
  ChainSpeeds::Span last_span_;
  bool skipped_ = false;  // the last point was too close to the one before
};

Trajectory plan(const MoveRange& moves, const JointLayout& layout, const Joints& start,
                const JointLimits& limits, const PathOptions& options, const TipMotions& tip) {
  return Planner(layout, limits, options, start, tip).run(moves);
}

}  // namespace servomill::controllers
