#include "controllers/path/tcp_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/move_curve.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

using Eigen::Vector3d;

// Shares of the tolerance of the tip. Chords in the half-width of a window of their curvature: 4.
constexpr double kChordShare = 0.04;
constexpr double kMoreThanSeen = 1.25;  // chords between the places that are looked at
constexpr double kAxisShare = 0.5;      // of the tolerance of the tool axis, for the rotary joints
static_assert(kGreatCircleShare + kAxisShare * std::numbers::sqrt2 < 1.0);
constexpr double kLongestTurn = 30.0 * deg;  // of a joint or an arc in one chord
constexpr int kArcParts = 12;                // of each turn of an arc
constexpr int kMaxHalvings = 40;
constexpr double kSameAngle = 1e-9;  // rad, rounding of work offsets
constexpr std::array<double, 3> kLooks = {0.25, 0.5, 0.75};

auto rotary(const Joints& Q) { return Q.tail<kJoints - kLinearJoints>(); }

// The chords of one move after the other.
class Tracer {
 public:
  Tracer(const ToolCentrePoint& machine, const std::map<int, Vector3d>& tips, const Joints& start,
         const JointLimits& limits, const PathOptions& options)
      : machine_(machine),
        layout_(machine.chain().layout),
        tips_(tips),
        limits_(limits),
        options_(options),
        Q_(start),
        out_(options.plans_in_memory),
        tolerances_(options.rotary_radius,
                    [this](const JointChord& chord) { out_.chords.push_back(chord); }) {}
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  void follow(const Move& move) { Q_ = layout_.joints(move.end_machine); }

  /// @return why the machine cannot do it, or ""
  std::string trace(const Move& move, std::size_t index) {
    p_ST_ = tips_.at(move.tool_offset);
    curve_ = MoveCurve(machine_.tip_words(layout_.words(Q_), p_ST_), move);
    set_tolerances(move);
    const Joints Q_begin = Q_;
    circle_ = move.tool_control == ToolControl::tool_axis;
    k_begin_ = machine_.tool_axis(Q_);
    k_end_ = move.tool_axis;
    const AxisTurn turn = turn_of(move);
    if (!turn.fault.empty()) {
      follow(move);
      return turn.fault;
    }
    TcpMotion motion{index, count_, 0, time_of(move, turn)};
    chords_.clear();
    RotaryKnot at{0.0, Q_};
    for (const RotaryKnot& knot : turn.knots) {
      if (!add_between(at, knot, move)) {
        follow(move);
        return "the linear axes cannot reach this TCP position";
      }
      at = knot;
    }
    tolerances_.end_move();
    count_ += chords_.size();
    motion.last = count_;
    note_slowing(motion, move, Q_begin);
    out_.motions.push_back(motion);
    return {};
  }

  TipMotions take() {
    tolerances_.finish();
    out_.chords.finish();
    out_.motions.finish();
    return std::move(out_);
  }

 private:
  struct Point {
    double t = 0.0;
    Joints Q;
  };
  void set_tolerances(const Move& move) {
    const double programmed = options_.tolerance_share * move.path_tolerance;
    T_ = programmed > 0.0 ? programmed : options_.tolerance;
    axis_tolerance_ = options_.rotary_tolerance;
    if (move.path_mode == PathMode::continuous) return;
    T_ = options_.exact_tolerance;
    axis_tolerance_ *= options_.exact_tolerance / options_.tolerance;
  }

  AxisTurn turn_of(const Move& move) const {
    const Joints Q_end = layout_.joints(move.end_machine);
    if (move.tool_control != ToolControl::tool_axis) {
      AxisTurn out;
      out.knots.push_back({1.0, Q_end});
      out.angle = rotary(Joints(Q_end - Q_)).norm();
      return out;
    }
    AxisTurn out = machine_.great_circle(Q_, move.tool_axis);
    if (out.fault.empty()) {
      const Joints& Q_last = out.knots.back().Q;
      if ((rotary(Q_last) - rotary(Q_end)).cwiseAbs().maxCoeff() > kSameAngle) {
        throw std::logic_error("interpreter and planner rotate the tool axis on different paths");
      }
    }
    return out;
  }

  double time_of(const Move& move, const AxisTurn& turn) const {
    if (move.kind == MoveKind::rapid) return 0.0;
    const double way = curve_.length() > kStandingTip ? curve_.length() : turn.angle;
    return way / (move.feed * options_.feed_override);
  }

  std::optional<Point> point_at(double t, const RotaryKnot& from, const RotaryKnot& to) const {
    const double f = (t - from.fraction) / (to.fraction - from.fraction);
    Joints Q_rotary = t >= to.fraction ? to.Q : Joints(from.Q + f * (to.Q - from.Q));
    if (circle_ && to.is_even && t < to.fraction) {
      Q_rotary = machine_.point(ToolCentrePoint::axis_between(k_begin_, k_end_, t), Q_rotary).Q;
    }
    const auto Q = machine_.joints(curve_.at(t).head<3>(), Q_rotary, p_ST_);
    if (!Q) return std::nullopt;
    return Point{t, *Q};
  }

  bool add_between(const RotaryKnot& from, const RotaryKnot& to, const Move& move) {
    const double angle = rotary(Joints(to.Q - from.Q)).cwiseAbs().maxCoeff();
    int parts = std::max(1, static_cast<int>(std::ceil(angle / kLongestTurn)));
    if (move.kind == MoveKind::arc) {
      const double share = to.fraction - from.fraction;
      parts = std::max(parts,
                       static_cast<int>(std::ceil(kArcParts * std::abs(move.arc.turns) * share)));
    }
    Point at{from.fraction, Q_};
    for (int i = 1; i <= parts; ++i) {
      throw_if_interrupted();
      const double f = static_cast<double>(i) / parts;
      const double t = i == parts ? to.fraction : from.fraction + f * (to.fraction - from.fraction);
      const auto next = point_at(t, from, to);
      if (!next || !split(at, *next, from, to, kMaxHalvings)) return false;
      at = *next;
    }
    return true;
  }

  bool split(const Point& a, const Point& b, const RotaryKnot& from, const RotaryKnot& to,
             int halvings_left) {
    const double error = error_of(a, b);
    if (halvings_left == 0 || error <= kChordShare * T_) {
      add(a, b, error, to.is_even);
      return true;
    }
    const auto middle = point_at(0.5 * (a.t + b.t), from, to);
    return middle && split(a, *middle, from, to, halvings_left - 1) &&
           split(*middle, b, from, to, halvings_left - 1);
  }

  // Largest distance of the tip on a chord from where it should be then.
  double error_of(const Point& a, const Point& b) const {
    double worst = 0.0;
    for (const double f : kLooks) {
      const Vector3d tip = plant::forward(machine_.chain(), a.Q + f * (b.Q - a.Q), p_ST_).p_WT;
      const Vector3d wanted = curve_.at(a.t + f * (b.t - a.t)).head<3>();
      worst = std::max(worst, (tip - wanted).norm());
    }
    return worst;
  }

  void add(const Point& a, const Point& b, double error, bool is_even) {
    const double arm = plant::jacobian(machine_.chain(), b.Q, p_ST_)
                           .J_pQ.rightCols<kJoints - kLinearJoints>()
                           .norm();
    const double missed = std::min(kMoreThanSeen * error, kChordShare * T_);
    chords_.push_back({b.Q, b.t, 0.0, 0.0, is_even});
    tolerances_.add(chords_.back(), {a.Q, T_, T_ - missed, arm, kAxisShare * axis_tolerance_});
    Q_ = b.Q;
  }

  // Speed, acceleration and jerk of the joints at the programmed feed, from the last chords.
  class Rates {
   public:
    explicit Rates(const Joints& Q_begin) : last_{Derivative{0.0, Q_begin}} {}

    void go_to(const JointChord& chord, double time) {
      // divided differences, newest first
      std::array<Derivative, kOrders + 1> now{Derivative{time, chord.end}};
      double factor = 1.0;
      for (std::size_t n = 1; n <= kOrders; ++n) {
        const Derivative& before = last_[n - 1];
        now[n] = {before.begin, (now[n - 1].value - before.value) / (time - before.begin)};
        factor *= static_cast<double>(n);
        rate_[n] = factor * now[n].value.cwiseAbs();
      }
      last_ = now;
      even_ = chord.is_even ? even_ + 1 : 0;
    }
    // Derivative of that order, from 1.
    const Joints& of(std::size_t order) const { return rate_[order]; }
    // Higher orders come from as many chords without a corner between them.
    std::size_t known() const { return std::clamp<std::size_t>(even_, 1, kOrders); }

    static constexpr std::size_t kOrders = 3;

   private:
    struct Derivative {
      double begin = 0.0;  // s, of the chords it spans
      Joints value = Joints::Zero();
    };
    std::array<Derivative, kOrders + 1> last_;
    std::array<Joints, kOrders + 1> rate_;
    std::size_t even_ = 0;
  };

  void note_slowing(const TcpMotion& motion, const Move& move, const Joints& Q_begin) {
    if (motion.time == 0.0 || motion.first == motion.last) return;
    std::optional<FeedReduction> worst;
    // a rotary joint first: where it is too slow the linear ones only follow it
    for (const auto& [first, end] : {std::pair(kLinearJoints, kJoints), {0, kLinearJoints}}) {
      Rates rates(Q_begin);
      for (const JointChord& chord : chords_) {
        rates.go_to(chord, motion.time * chord.fraction);
        find_slowest(rates, chord, move.line, first, end, worst);
      }
      if (worst) break;
    }
    if (worst) out_.slowed.push_back(*worst);
  }

  // Joints first ... end - 1 that are too slow behind a chord; the slowest so far is in `worst`.
  void find_slowest(const Rates& rates, const JointChord& chord, int line, int first, int end,
                    std::optional<FeedReduction>& worst) const {
    const std::array<const Joints*, 3> limits = {&limits_.v, &limits_.a, &limits_.j};
    const double from_singular =
        circle_ ? machine_.inverse().distance_from_singular(machine_.tool_axis(chord.end))
                : 0.5 * std::numbers::pi;
    const std::size_t orders = from_singular < kNearSingular ? rates.known() : 1;
    for (std::size_t n = 1; n <= orders; ++n) {
      for (int j = first; j < end; ++j) {
        if (!layout_.has(j) || rates.of(n)[j] <= (*limits[n - 1])[j]) continue;
        const FeedReduction here{
            line, j, rates.of(n)[j], (*limits[n - 1])[j], from_singular, static_cast<int>(n)};
        if (here.share() < (worst ? worst->share() : 1.0)) worst = here;
      }
    }
  }

  const ToolCentrePoint& machine_;
  const JointLayout& layout_;
  const std::map<int, Vector3d>& tips_;
  const JointLimits& limits_;
  const PathOptions& options_;
  Joints Q_;
  Vector3d p_ST_ = Vector3d::Zero();
  MoveCurve curve_;
  double T_ = 0.0, axis_tolerance_ = 0.0;  // m, rad
  bool circle_ = false;                    // the tool axis turns on a great circle
  Vector3d k_begin_ = Vector3d::UnitZ(), k_end_ = Vector3d::UnitZ();
  TipMotions out_;
  std::size_t count_ = 0;           // of chords, of the moves before
  std::vector<JointChord> chords_;  // of the move
  ChordTolerances tolerances_;
};

}  // namespace

const TcpMotion& TipMotions::of(std::size_t move) const {
  const std::span<const TcpMotion> all = motions.range(0, motions.size());
  const auto found =
      std::lower_bound(all.begin(), all.end(), move,
                       [](const TcpMotion& m, std::size_t index) { return m.move < index; });
  assert(found != all.end() && found->move == move);
  constexpr std::ptrdiff_t kReleased = 65536;
  if ((found - all.begin()) % kReleased == 0) {
    chords.release();
    motions.release();
  }
  return *found;
}

TipMotions tip_motions(const MoveRange& moves, const ToolCentrePoint& machine,
                       const std::map<int, Vector3d>& tips, const Joints& start,
                       const JointLimits& limits, const PathOptions& options,
                       const std::string& file) {
  Tracer tracer(machine, tips, start, limits, options);
  std::vector<Fault> faults;
  std::size_t next = 0;
  for (const Move& move : moves) {
    throw_if_interrupted();
    const std::size_t i = next++;
    if (!is_motion(move.kind)) continue;
    if (move.tool_control == ToolControl::none) {
      tracer.follow(move);
      continue;
    }
    const std::string why = tracer.trace(move, i);
    if (!why.empty()) faults.push_back({{file, move.line, 0}, why});
  }
  if (!faults.empty()) throw InputError(std::move(faults));
  return tracer.take();
}

}  // namespace servomill::controllers
