#include "controllers/gcode/post_processor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "controllers/gcode/free_axis.h"
#include "controllers/gcode/number_text.h"
#include "controllers/gcode/printer.h"
#include "controllers/path/slowed_motion.h"
#include "plant/kinematics/branches.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr double kStandingTip = 1e-9;    // m; a shorter way of the tip is none
constexpr std::size_t kMostFaults = 20;  // a machine that is too small has one a location
constexpr std::string_view kRemedies =
    "lead the tool axis past at a distance, retract there, or let the axes begin elsewhere "
    "(--start)";

using Eigen::Vector3d;

// Share of the tolerance of the tip for the chords between inserted points (m).
double chord_of(const PostOptions& options) {
  switch (options.mode) {
    case PostMode::joints:
      return kChordTolerance * options.tolerance.tip;
    case PostMode::locations:  // no chord, but for the choice of solutions
      return options.tolerance.tip;
    case PostMode::tip:  // the NC keeps the tip where it belongs
      break;
  }
  return std::numeric_limits<double>::infinity();
}

class Post {
 public:
  Post(const ClData& data, const std::string& file, const plant::InverseKinematics& inverse,
       const PostOptions& options)
      : data_(data),
        file_(file),
        inverse_(inverse),
        options_(options),
        safe_(inverse, options.safe, options.work_offset, options.work_system),
        free_axis_(inverse, {chord_of(options), options.tolerance.axis}),
        rounding_(options.tolerance.tip),
        Q_(options.start) {
    if (options.mode == PostMode::joints) rounding_ -= chord_of(options);
  }

  PostProcessed run(std::vector<Warning>* of_refused) {
    if (is_safe()) retract();
    if (options_.tool > 0 && data_.first_without_tool() != nullptr) load(options_.tool, 0);
    for (std::size_t i = 0; i < data_.records.size() && faults_.size() < kMostFaults; ++i) {
      throw_if_interrupted();
      const ClRecord& record = data_.records[i];
      if (is_motion(record.kind)) {
        go_to(i);
      } else if (record.kind == MoveKind::tool) {
        load(record.number, record.line);
      } else {
        leave_before(i);
        pass_on(record);
      }
    }
    if (is_safe()) finish();
    sum_up();
    if (faults_.empty()) return std::move(out_);
    if (of_refused != nullptr) {
      of_refused->insert(of_refused->end(), out_.warnings.begin(), out_.warnings.end());
    }
    throw InputError(std::move(faults_));
  }

 private:
  void fault(int line, std::string message) {
    faults_.push_back({{file_, line, 0}, std::move(message)});
  }

  void warn(int line, std::string message) {
    out_.warnings.push_back({{file_, line, 0}, std::move(message)});
  }

  // Adds the warnings that are given once.
  void sum_up() {
    if (singular_ > 0) {
      warn(first_singular_,
           fmt::format("the tool axis is singular, here and at {} more locations: a rotary axis is "
                       "free",
                       singular_ - 1));
    }
    if (bent_ > 0) {
      const std::string more =
          bent_ == 1 ? "" : fmt::format(", and by more than the tolerance on {} more", bent_ - 1);
      warn(most_bent_,
           fmt::format("on the way here the axes lead the tip {:.4g} mm off the straight "
                       "way{}; only --classical inserts no points",
                       bend_ / mm, more));
    }
    if (slowed_) {
      warn(slowed_->line, to_string(*slowed_, inverse_.chain().layout));
    }
  }

  Move& add(MoveKind kind, int line) {
    Move& move = out_.moves.emplace_back();
    move.kind = kind;
    move.line = line;
    move.work_offset = options_.work_system;
    move.tool_offset = tool_;
    move.path_tolerance = rounding_;
    move.s_begin = move.s_end = s_;
    return move;
  }

  void load(int tool, int line) {
    const ToolEntry* entry = options_.tools.find(tool);
    if (entry == nullptr && !options_.tools.empty()) {
      return fault(line, fmt::format("tool {} is not in the tool table", tool));
    }
    if (is_safe()) leave();
    tool_ = tool;
    tool_offset_ = entry != nullptr ? entry->offset : AxisWords::Zero();
    p_ST_ = -tool_offset_.head<3>();
    free_axis_.set_tool(p_ST_);
    add(MoveKind::tool, line).number = tool;
    if (is_safe()) {
      retract();  // machines move in M6
    } else {      // and stop spindle and coolant; the new tip is elsewhere
      has_location_ = false;
      if (runs_.direction != 0) emit(*spindle_);
      if (runs_.coolant != 0) emit(*coolant_);
    }
  }

  // ---- to and from the workpiece

  bool is_safe() const { return options_.approach == Approach::safe; }

  void program_line(const std::string& text) {
    if (text.empty()) return;
    Move& move = add(MoveKind::message, last_line_);
    move.number = kProgramLine;
    move.text = text;
  }

  void retract() {
    program_line(safe_.retract_line());
    Q_ = safe_.retracted(Q_);
    is_retracted_ = true;
  }

  // Along the tool axis away from the workpiece, then up.
  void depart(int line) {
    if (is_retracted_) return;
    const auto clear = safe_.joints_clear_of(here_, Q_, p_ST_);
    if (!clear.fault.empty()) return fault(line, "on the way back from here, " + clear.fault);
    block(MoveKind::rapid, line, safe_.clear_of(here_), clear.Q, 0.0, 0.0);
    retract();
  }

  // Departs, and stops coolant and spindle: what the data stop first, then the rest.
  void leave() {
    depart(last_line_);
    for (const ClRecord& record : held_) {
      const bool starts = (record.kind == MoveKind::spindle && record.direction != 0) ||
                          (record.kind == MoveKind::coolant && record.number != 0);
      if (!starts) emit(record);
    }
    held_.clear();
    if (runs_.coolant != 0) add(MoveKind::coolant, last_line_).number = 0;
    if (runs_.direction != 0) add(MoveKind::spindle, last_line_).value = spindle_->value;
    runs_ = {};
  }

  // The blocks after the last location before a tool change or the end wait for the retract; a
  // dwell belongs to the location.
  void leave_before(std::size_t i) {
    const MoveKind kind = data_.records[i].kind;
    if (!is_safe() || is_retracted_ || kind == MoveKind::dwell || kind == MoveKind::message) return;
    for (std::size_t n = i; n < data_.records.size(); ++n) {
      if (is_motion(data_.records[n].kind)) return;
      if (data_.records[n].kind == MoveKind::tool) break;
    }
    depart(last_line_);
  }

  void approach(const ClRecord& record, const ToolPose& P, const Joints& Q) {
    depart(record.line);
    const auto clear = safe_.joints_clear_of(P, Q, p_ST_);
    if (!clear.fault.empty()) return fault(record.line, "on the way here, " + clear.fault);
    program_line(safe_.rotary_line(Q));
    switch_on();
    program_line(safe_.plane_line(clear.Q));
    is_retracted_ = false;
    block(MoveKind::rapid, record.line, safe_.clear_of(P), clear.Q, 0.0, 0.0);
    const double feed = record.feed > 0.0 ? record.feed : options_.feed;
    const bool feeds = record.kind != MoveKind::rapid && feed > 0.0;
    const double c = safe_.clearance();
    block(feeds ? MoveKind::feed : MoveKind::rapid, record.line, P, Q, feeds ? c : 0.0,
          feeds ? c / feed : 0.0);
  }

  // Spindle and coolant as the locations ask for them, in the order of their records.
  void switch_on() {
    for (const ClRecord& record : held_) emit(record);
    held_.clear();
    if (spindle_ && spindle_->direction != 0 && runs_.direction == 0) emit(*spindle_);
    if (coolant_ && coolant_->number != 0 && runs_.coolant == 0) emit(*coolant_);
  }

  void finish() {
    leave();
    Joints home = options_.start;
    for (int j = kLinearJoints; j < kJoints; ++j) {
      const bool is_endless = !std::isfinite(inverse_.settings().lower[j]) ||
                              !std::isfinite(inverse_.settings().upper[j]);
      if (!is_endless) continue;
      constexpr double kTurn = 2.0 * std::numbers::pi;  // rad
      home[j] += kTurn * std::round((Q_[j] - home[j]) / kTurn);
    }
    if (rotation_between(Q_, home) > 0.0) program_line(safe_.rotary_line(home));
  }

  void pass_on(const ClRecord& record) {
    if (record.kind == MoveKind::spindle) spindle_ = record;
    if (record.kind == MoveKind::coolant) coolant_ = record;
    if (is_safe() && is_retracted_) {
      held_.push_back(record);
    } else {
      emit(record);
    }
  }

  void emit(const ClRecord& record) {
    // no length, and no tip control above all, before X and Y are there
    if (record.kind == MoveKind::dwell && is_safe() && is_retracted_) {
      return program_line(dwell_block(record.value));
    }
    if (record.kind == MoveKind::spindle) runs_.direction = record.direction;
    if (record.kind == MoveKind::coolant) runs_.coolant = record.number;
    Move& move = add(record.kind, record.line);
    move.value = record.value;
    move.number = record.number;
    move.direction = record.direction;
    move.text = record.text;
  }

  ToolPose pose_of(const ClRecord& record) const {
    return {record.P.p_WT + options_.work_offset, record.P.k_W};
  }

  void go_to(std::size_t i) {
    const ClRecord& record = data_.records[i];
    const bool is_first = is_safe() ? is_retracted_ : !has_location_;
    if (record.kind == MoveKind::rapid || is_first) return jump_to(i);
    const double feed = record.feed > 0.0 ? record.feed : options_.feed;
    if (feed == 0.0) {
      if (!missed_feed_)
        fault(record.line, "no feed is given for this location; add FEDRAT or --feed");
      missed_feed_ = true;
      return jump_to(i);
    }
    feed_to(pose_of(record), record.line, feed);
  }

  void jump_to(std::size_t i) {
    const ClRecord& record = data_.records[i];
    const ToolPose P = pose_of(record);
    plant::JointSolution next = inverse_.nearest(P, p_ST_, Q_);
    if (!next.is_reached()) return fault(record.line, reason(next, inverse_));
    note_singular(next, record.line);
    if (next.is_singular) next.Q = looking_ahead(i, P, next.Q);
    next.Q = held(P, next.Q);
    const bool crosses = is_retracted_ || rotation_between(Q_, next.Q) > 0.0;
    if (is_safe() && crosses) {
      approach(record, P, next.Q);
    } else {
      block(MoveKind::rapid, record.line, P, next.Q, 0.0, 0.0);
    }
    here_ = P;
    has_location_ = true;
  }

  // Q, or the rotary axes as they are where they have this tool axis: next to a singular direction
  // equal tool axes have solutions that differ by more than the decimals of the program.
  Joints held(const ToolPose& P, const Joints& Q) const {
    if (rotation_between(Q_, Q) > kSameAngle) return Q;
    const Vector3d k = plant::forward(inverse_.chain(), Q_, p_ST_).k_W;
    if (angle_between(k, P.k_W) > kSameAxis) return Q;
    return plant::inverse_fixed_rotary(inverse_.chain(), P.p_WT, Q_, p_ST_).value_or(Q);
  }

  // ---- the free axis of a singular direction

  // Joints at P, with a tool axis that is singular, that need not change where the feed moves that
  // follow lead the tool axis away; Q if none do.
  Joints looking_ahead(std::size_t i, const ToolPose& P, const Joints& Q) const {
    std::vector<ToolPose> upright = {P};
    for (std::size_t n = i + 1; n < data_.records.size(); ++n) {
      const ClRecord& record = data_.records[n];
      if (record.kind == MoveKind::rapid || record.kind == MoveKind::tool) return Q;
      if (!is_motion(record.kind)) continue;
      const ToolPose next = pose_of(record);
      const double turn = angle_between(P.k_W, next.k_W);
      if (turn >= plant::kRoundTurn) return Q;
      if (turn < kSameAxis) {
        upright.push_back(next);
        continue;
      }
      return free_axis_.before_leaving(upright, next, Q).value_or(Q);
    }
    return Q;
  }

  void turn_here(const std::vector<Joints>& turn, int line) {
    if (turn.empty()) return;
    int joint = 0;
    const double angle =
        (turn.back() - Q_).tail<kJoints - kLinearJoints>().cwiseAbs().maxCoeff(&joint);
    warn(line,
         fmt::format("{} turns by {:.6g} deg with the tip in place before the tool axis leaves "
                     "a singular direction; a retract there would avoid it",
                     inverse_.chain().layout.letter_of(kLinearJoints + joint), angle / deg));
    for (const Joints& Q : turn) {
      block(MoveKind::feed, line, here_, Q, 0.0, rotation_between(Q_, Q) / options_.rotary_rate);
    }
    out_.inserted += turn.size();
  }

  // ---- feed moves

  void feed_to(const ToolPose& P, int line, double feed) {
    if (angle_between(here_.k_W, P.k_W) >= plant::kRoundTurn) {
      return fault(
          line, "the tool axis is reversed (180 deg): no direction of rotation is the shorter one");
    }
    const plant::JointSolution end = inverse_.nearest(P, p_ST_, Q_);
    if (!end.is_reached()) return fault(line, reason(end, inverse_));
    note_singular(end, line);
    const plant::StraightToolPath path(here_, P);
    plant::LinearisedPath way;
    if (options_.mode == PostMode::locations) {
      note_bend(path, end.Q, line);
      way.points = {{1.0, end.Q}};
    } else if (auto leaving = free_axis_.departure(path, here_, Q_)) {
      turn_here(leaving->rotation, line);
      way = std::move(leaving->path);
    } else {
      way = free_axis_.linearised(path, Q_);
    }
    if (!way.is_complete) {
      fault(line, fmt::format("at {:.1f} % of the way here {}", 100.0 * way.t, why_not(way, path)));
      here_ = P;
      Q_ = end.Q;
      return;
    }
    out_.inserted += way.points.size() - 1;
    double t = 0.0;
    for (const plant::PathPoint& point : way.points) {
      throw_if_interrupted();
      const double share = point.t - t;
      const bool stands = path.length() < kStandingTip;
      const double time =
          share * (stands ? path.angle() / options_.rotary_rate : path.length() / feed);
      block(MoveKind::feed, line, path.at(point.t), point.Q, share * path.length(), time);
      t = point.t;
    }
    here_ = P;
  }

  std::string why_not(const plant::LinearisedPath& way, const plant::StraightToolPath& path) const {
    if (!way.failure.is_reached()) return reason(way.failure, inverse_);
    const Joints& Q = way.points.empty() ? Q_ : way.points.back().Q;
    const auto joint = plant::joint_at_its_end(inverse_, path.at(way.t), p_ST_, Q);
    if (!joint) {
      return fmt::format(
          "the tool axis passes a singular direction, where the axes would have to "
          "jump; {}",
          kRemedies);
    }
    const bool linear = *joint < kLinearJoints;
    return fmt::format(
        "axis {} comes to the end of its travel at {:.6g} {}, and otherwise the axes "
        "would have to jump; {}",
        inverse_.chain().layout.letter_of(*joint), Q[*joint] / (linear ? mm : deg),
        linear ? "mm" : "deg", kRemedies);
  }

  // How far a block to Q alone leads the tip off its way.
  void note_bend(const plant::StraightToolPath& path, const Joints& Q, int line) {
    constexpr int kLooks = 16;
    double worst = 0.0;
    for (int n = 1; n < kLooks; ++n) {
      const double t = static_cast<double>(n) / kLooks;
      const Vector3d tip = plant::forward(inverse_.chain(), Q_ + t * (Q - Q_), p_ST_).p_WT;
      worst = std::max(worst, (tip - path.at(t).p_WT).norm());
    }
    if (worst <= options_.tolerance.tip) return;
    ++bent_;
    if (worst <= bend_) return;
    bend_ = worst;
    most_bent_ = line;
  }

  // The NC slows down where a post-processed time is too short.
  void note_speed(int line, const ToolPose& P, const Joints& Q, double time) {
    if (!(time > 0.0)) return;
    // under tip control linear joints go elsewhere than to Q in between
    const int first = options_.mode == PostMode::tip ? kLinearJoints : 0;
    bool counts = false;
    for (int j = first; j < kJoints; ++j) {
      if (!inverse_.chain().layout.has(j)) continue;
      SlowedMotion here{line, j, std::abs(Q[j] - Q_[j]) / time, options_.v_max[j],
                        inverse_.distance_from_singular(P.k_W)};
      if (!(here.needed > here.allowed)) continue;
      if (!counts) ++too_fast_;
      counts = true;
      if (!slowed_ || here.share() < slowed_->share()) slowed_ = here;
    }
    if (slowed_) slowed_->others = too_fast_ - 1;
  }

  // One block to the joints Q, on which the tip takes its way (m) in that time (s).
  void block(MoveKind kind, int line, const ToolPose& P, const Joints& Q, double way, double time) {
    last_line_ = line;
    Move& move = add(kind, line);
    AxisWords words = move.end_machine = inverse_.chain().layout.words(Q);
    if (options_.mode == PostMode::tip) {
      words.head<3>() = P.p_WT;
    } else {
      words -= tool_offset_;
    }
    words.head<3>() -= options_.work_offset;
    move.end = words;
    const bool moves_tip = way > 0.0;
    if (kind == MoveKind::feed) {
      const bool in_time = options_.mode != PostMode::tip || !moves_tip;
      move.feed_mode = in_time ? FeedMode::inverse_time : FeedMode::units_per_minute;
      const double turn = (Q - Q_).tail<kJoints - kLinearJoints>().norm();
      note_speed(line, P, Q, time);
      // a block of no time at all: nothing moves
      move.feed = time > 0.0 ? (moves_tip ? way : turn) / time : options_.rotary_rate;
    }
    s_ += way;
    move.s_end = s_;
    Q_ = Q;
  }

  void note_singular(const plant::JointSolution& solution, int line) {
    if (!solution.is_singular) return;
    if (singular_++ == 0) first_singular_ = line;
  }

  const ClData& data_;
  const std::string& file_;
  const plant::InverseKinematics& inverse_;
  const PostOptions& options_;
  SafeApproach safe_;
  FreeAxis free_axis_;
  bool is_retracted_ = false;
  int last_line_ = 0;                          // of a location
  std::vector<ClRecord> held_;                 // while retracted, for switch_on()
  std::optional<ClRecord> spindle_, coolant_;  // as last asked for
  struct Runs {
    int direction = 0, coolant = 0;
  };
  Runs runs_;        // as last programmed
  double rounding_;  // m, share of the tolerance of the tip
  PostProcessed out_;
  std::vector<Fault> faults_;
  Joints Q_;
  ToolPose here_;
  bool has_location_ = false, missed_feed_ = false;
  int tool_ = 0;
  AxisWords tool_offset_ = AxisWords::Zero();
  Eigen::Vector3d p_ST_ = Eigen::Vector3d::Zero();
  double s_ = 0.0;
  std::size_t singular_ = 0;
  int first_singular_ = 0;
  std::size_t bent_ = 0;  // blocks that lead the tip off by more than the tolerance
  double bend_ = 0.0;     // m, at most
  int most_bent_ = 0;     // its line
  std::size_t too_fast_ = 0;
  std::optional<SlowedMotion> slowed_;
};

}  // namespace

std::string reason(const plant::JointSolution& solution, const plant::InverseKinematics& inverse) {
  switch (solution.reach) {
    case plant::Reach::reached:
      return "it is reached";
    case plant::Reach::orientation:
      return fmt::format("the rotary axes miss this tool axis by {:.3g} deg", solution.miss / deg);
    case plant::Reach::position:
      return fmt::format("the machine lacks a linear axis to get there; it misses by {:.3g} mm",
                         solution.miss / mm);
    case plant::Reach::parallel_axes:
      return "two linear axes are parallel at the angles that this tool axis needs";
    case plant::Reach::travel:
      break;
  }
  const bool linear = solution.joint < kLinearJoints;
  const double unit = linear ? mm : deg;
  return fmt::format("axis {} would move to {:.6g} {}, outside its travel of {:g} to {:g}",
                     inverse.chain().layout.letter_of(solution.joint),
                     solution.Q[solution.joint] / unit, linear ? "mm" : "deg",
                     inverse.settings().lower[solution.joint] / unit,
                     inverse.settings().upper[solution.joint] / unit);
}

PostProcessed post(const ClData& data, const std::string& file,
                   const plant::InverseKinematics& inverse, const PostOptions& options,
                   std::vector<Warning>* refused) {
  return Post(data, file, inverse, options).run(refused);
}

}  // namespace servomill::controllers
