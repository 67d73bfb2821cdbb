#include "controllers/gcode/post_processor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "controllers/gcode/free_axis.h"
#include "controllers/gcode/post_approach.h"
#include "controllers/gcode/post_blocks.h"
#include "controllers/gcode/post_report.h"
#include "plant/kinematics/branches.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr double kStandingTip = 1e-9;  // m; a shorter way of the tip is none
constexpr std::string_view kRemedies =
    "keep the tool axis away from it, retract there, or change the start position (--start)";

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

// Share of the tolerance of the tip that chords leave to the NC, to round corners with (m).
double rounding_of(const PostOptions& options) {
  const double tolerance = options.tolerance.tip;
  return options.mode == PostMode::joints ? tolerance - chord_of(options) : tolerance;
}

class Post {
 public:
  Post(const ClData& data, const std::string& file, const plant::InverseKinematics& inverse,
       const PostOptions& options)
      : data_(data),
        inverse_(inverse),
        options_(options),
        report_(file, inverse.chain().layout),
        blocks_(inverse, options, rounding_of(options), report_),
        access_(inverse, options, blocks_, report_),
        free_axis_(inverse, {chord_of(options), options.tolerance.axis}) {}

  PostProcessed run(std::vector<Warning>* of_refused) {
    if (access_.is_safe()) access_.retract();
    if (options_.tool > 0 && data_.first_without_tool() != nullptr) load(options_.tool, 0);
    Stage stage("records", static_cast<double>(data_.records.size()));
    for (std::size_t i = 0; i < data_.records.size() && !report_.is_full(); ++i) {
      throw_if_interrupted();
      stage.advance();
      const ClRecord& record = data_.records[i];
      if (is_motion(record.kind)) {
        go_to(i);
      } else if (record.kind == MoveKind::tool) {
        load(record.number, record.line);
      } else {
        access_.leave_before(std::span(data_.records).subspan(i), here_);
        access_.function(record);
      }
    }
    if (access_.is_safe()) access_.finish(here_);
    std::vector<Warning> warnings = report_.conclude(of_refused);
    return {blocks_.take(), std::move(warnings), inserted_};
  }

 private:
  void load(int tool, int line) {
    const ToolEntry* entry = options_.tools.find(tool);
    if (entry == nullptr && !options_.tools.empty()) {
      return report_.fault(line, fmt::format("tool {} is not in the tool table", tool));
    }
    if (access_.is_safe()) access_.leave(here_);
    blocks_.load(tool, entry, line);
    free_axis_.set_tool(blocks_.p_ST());
    if (access_.is_safe()) {
      access_.retract();  // machines move in M6
    } else {              // and stop spindle and coolant; the new tip is elsewhere
      has_location_ = false;
      access_.switch_on_again();
    }
  }

  ToolPose pose_of(const ClRecord& record) const {
    return {record.P.p_WT + options_.work_offset, record.P.k_W};
  }

  void go_to(std::size_t i) {
    const ClRecord& record = data_.records[i];
    const bool is_first = access_.is_safe() ? access_.is_retracted() : !has_location_;
    if (record.kind == MoveKind::rapid || is_first) return jump_to(i);
    const double feed = record.feed > 0.0 ? record.feed : options_.feed;
    if (feed == 0.0) {
      if (!missed_feed_)
        report_.fault(record.line,
                      "no feed rate is defined for this location; add FEDRAT or --feed");
      missed_feed_ = true;
      return jump_to(i);
    }
    feed_to(pose_of(record), record.line, feed);
  }

  void jump_to(std::size_t i) {
    const ClRecord& record = data_.records[i];
    const ToolPose P = pose_of(record);
    plant::JointSolution next = inverse_.nearest(P, blocks_.p_ST(), blocks_.Q());
    if (!next.is_reached()) return report_.fault(record.line, reason(next, inverse_));
    if (next.is_singular) report_.note_singular(record.line);
    if (next.is_singular) next.Q = looking_ahead(i, P, next.Q);
    next.Q = held(P, next.Q);
    const bool crosses = access_.is_retracted() || rotation_between(blocks_.Q(), next.Q) > 0.0;
    if (access_.is_safe() && crosses) {
      access_.approach(record, here_, P, next.Q);
    } else {
      blocks_.motion(MoveKind::rapid, record.line, P, next.Q, 0.0, 0.0);
    }
    here_ = P;
    has_location_ = true;
  }

  // Q, or the rotary axes as they are where they have this tool axis: next to a singular direction
  // equal tool axes have solutions that differ by more than the decimals of the program.
  Joints held(const ToolPose& P, const Joints& Q) const {
    const Joints& Q_0 = blocks_.Q();
    if (rotation_between(Q_0, Q) > kSameAngle) return Q;
    const Vector3d k = plant::forward(inverse_.chain(), Q_0, blocks_.p_ST()).k_W;
    if (angle_between(k, P.k_W) > kSameAxis) return Q;
    return plant::inverse_fixed_rotary(inverse_.chain(), P.p_WT, Q_0, blocks_.p_ST()).value_or(Q);
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
        (turn.back() - blocks_.Q()).tail<kJoints - kLinearJoints>().cwiseAbs().maxCoeff(&joint);
    report_.warn(
        line, fmt::format("{} rotates by {:.6g} deg at a fixed TCP before the tool axis leaves a "
                          "singular direction; a retract there would avoid it",
                          inverse_.chain().layout.letter_of(kLinearJoints + joint), angle / deg));
    for (const Joints& Q : turn) {
      blocks_.motion(MoveKind::feed, line, here_, Q, 0.0,
                     rotation_between(blocks_.Q(), Q) / options_.rotary_rate);
    }
    inserted_ += turn.size();
  }

  // ---- feed moves

  // In a singular direction the free rotary axis rotates first, at a fixed TCP (`departure`); the
  // chords that follow keep TCP and tool axis within the tolerance.
  void feed_to(const ToolPose& P, int line, double feed) {
    if (angle_between(here_.k_W, P.k_W) >= plant::kRoundTurn) {
      return report_.fault(
          line, "the tool axis is reversed (180 deg): the direction of rotation is undetermined");
    }
    const plant::JointSolution end = inverse_.nearest(P, blocks_.p_ST(), blocks_.Q());
    if (!end.is_reached()) return report_.fault(line, reason(end, inverse_));
    if (end.is_singular) report_.note_singular(line);
    const plant::StraightToolPath path(here_, P);
    plant::LinearisedPath way;
    if (options_.mode == PostMode::locations) {
      note_bend(path, end.Q, line);
      way.points = {{1.0, end.Q}};
    } else if (auto leaving = free_axis_.departure(path, here_, blocks_.Q())) {
      turn_here(leaving->rotation, line);
      way = std::move(leaving->path);
    } else {
      way = free_axis_.linearised(path, blocks_.Q());
    }
    if (!way.is_complete) {
      report_.fault(line, fmt::format("at {:.1f} % of the move to this location {}", 100.0 * way.t,
                                      why_not(way, path)));
      here_ = P;
      blocks_.set_Q(end.Q);
      return;
    }
    inserted_ += way.points.size() - 1;
    double t = 0.0;
    for (const plant::PathPoint& point : way.points) {
      throw_if_interrupted();
      const double share = point.t - t;
      const bool stands = path.length() < kStandingTip;
      const double time =
          share * (stands ? path.angle() / options_.rotary_rate : path.length() / feed);
      blocks_.motion(MoveKind::feed, line, path.at(point.t), point.Q, share * path.length(), time);
      t = point.t;
    }
    here_ = P;
  }

  std::string why_not(const plant::LinearisedPath& way, const plant::StraightToolPath& path) const {
    if (!way.failure.is_reached()) return reason(way.failure, inverse_);
    const Joints& Q = way.points.empty() ? blocks_.Q() : way.points.back().Q;
    const auto joint = plant::joint_at_its_end(inverse_, path.at(way.t), blocks_.p_ST(), Q);
    if (!joint) {
      return fmt::format(
          "the tool axis passes a singular direction, where the axes would have to "
          "jump; {}",
          kRemedies);
    }
    const bool linear = *joint < kLinearJoints;
    return fmt::format(
        "axis {} reaches its travel limit at {:.6g} {}; the alternative solution would require the "
        "axes to jump; {}",
        inverse_.chain().layout.letter_of(*joint), Q[*joint] / (linear ? mm : deg),
        linear ? "mm" : "deg", kRemedies);
  }

  // How far a block to Q alone leads the tip off its way.
  void note_bend(const plant::StraightToolPath& path, const Joints& Q, int line) {
    const Joints& Q_0 = blocks_.Q();
    constexpr int kLooks = 16;
    double worst = 0.0;
    for (int n = 1; n < kLooks; ++n) {
      const double t = static_cast<double>(n) / kLooks;
      const Vector3d tip =
          plant::forward(inverse_.chain(), Q_0 + t * (Q - Q_0), blocks_.p_ST()).p_WT;
      worst = std::max(worst, (tip - path.at(t).p_WT).norm());
    }
    if (worst > options_.tolerance.tip) report_.note_bend(line, worst);
  }

  const ClData& data_;
  const plant::InverseKinematics& inverse_;
  const PostOptions& options_;
  PostReport report_;
  PostBlocks blocks_;
  PostApproach access_;
  FreeAxis free_axis_;
  ToolPose here_;  // the last location
  bool has_location_ = false, missed_feed_ = false;
  std::size_t inserted_ = 0;
};

}  // namespace

std::string reason(const plant::JointSolution& solution, const plant::InverseKinematics& inverse) {
  switch (solution.reach) {
    case plant::Reach::reached:
      return "it is reached";
    case plant::Reach::orientation:
      if (inverse.chain().axes.size() == std::size_t(number_of_linear_axes(inverse.chain())))
        return "the machine has no rotary axes";
      return fmt::format("the rotary axes cannot reach this tool axis; the error is {:.3g} deg",
                         solution.miss / deg);
    case plant::Reach::position:
      return fmt::format(
          "the machine lacks a linear axis to reach this location; the error is {:.3g} mm",
          solution.miss / mm);
    case plant::Reach::parallel_axes:
      return "two linear axes are parallel at the rotary angles of this tool axis";
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
