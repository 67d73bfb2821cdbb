#include "controllers/gcode/post_processor.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr double kStandingTip = 1e-9;    // m; a shorter way of the tip is none
constexpr std::size_t kMostFaults = 20;  // a machine that is too small has one a location
constexpr std::string_view kJumps =
    "the tool axis passes a singular direction, or the end of a rotary axis' travel, where the "
    "axes "
    "would have to jump; lead it past at a distance, or retract there";

class Post {
 public:
  Post(const ClData& data, const std::string& file, const plant::InverseKinematics& inverse,
       const PostOptions& options)
      : data_(data), file_(file), inverse_(inverse), options_(options), Q_(options.start) {}

  Posted run() {
    tool_ = options_.tool;
    bool loads_tool = false;
    for (const ClRecord& record : data_.records) loads_tool |= record.kind == MoveKind::tool;
    if (!loads_tool && tool_ > 0) load(tool_, 0);
    for (const ClRecord& record : data_.records) {
      if (faults_.size() >= kMostFaults) break;
      if (is_motion(record.kind)) {
        go_to(record);
      } else if (record.kind == MoveKind::tool) {
        load(record.number, record.line);
      } else {
        pass_on(record);
      }
    }
    if (!faults_.empty()) throw InputError(std::move(faults_));
    if (singular_ > 0) {
      out_.warnings.push_back(
          {{file_, first_singular_, 0},
           fmt::format("the tool axis is singular, here and at {} more locations: a rotary axis "
                       "keeps its angle",
                       singular_ - 1)});
    }
    return std::move(out_);
  }

 private:
  void fault(int line, std::string message) {
    faults_.push_back({{file_, line, 0}, std::move(message)});
  }

  Move& add(MoveKind kind, int line) {
    Move& move = out_.moves.emplace_back();
    move.kind = kind;
    move.line = line;
    move.work_offset = options_.work_system;
    move.tool_offset = tool_;
    move.path_tolerance = options_.tolerance.tip;
    move.s_begin = move.s_end = s_;
    return move;
  }

  void load(int tool, int line) {
    const ToolEntry* entry = options_.tools.find(tool);
    if (entry == nullptr && !options_.tools.empty()) {
      return fault(line, fmt::format("tool {} is not in the tool table", tool));
    }
    tool_ = tool;
    tool_offset_ = entry != nullptr ? entry->offset : AxisWords::Zero();
    p_ST_ = -tool_offset_.head<3>();
    add(MoveKind::tool, line).number = tool;
  }

  void pass_on(const ClRecord& record) {
    Move& move = add(record.kind, record.line);
    move.value = record.value;
    move.number = record.number;
    move.direction = record.direction;
    move.text = record.text;
  }

  void go_to(const ClRecord& record) {
    ToolPose P = record.P;
    P.p_WT += options_.part_zero;
    if (record.kind == MoveKind::rapid || !has_location_) return jump_to(P, record);
    const double feed = record.feed > 0.0 ? record.feed : options_.feed;
    if (feed == 0.0) {
      if (!missed_feed_)
        fault(record.line, "no feed is given for this location; add FEDRAT or --feed");
      missed_feed_ = true;
      return jump_to(P, record);
    }
    feed_to(P, record.line, feed);
  }

  void jump_to(const ToolPose& P, const ClRecord& record) {
    const plant::JointSolution next = inverse_.nearest(P, p_ST_, Q_);
    if (!next.is_reached()) return fault(record.line, reason(next, inverse_));
    note_singular(next, record.line);
    block(MoveKind::rapid, record.line, P, next.Q, 0.0, 0.0);
    here_ = P;
    has_location_ = true;
  }

  void feed_to(const ToolPose& P, int line, double feed) {
    if (angle_between(here_.k_W, P.k_W) >= plant::kRoundTurn) {
      return fault(line, "the tool axis turns round: no way of turning is the shortest");
    }
    const plant::JointSolution end = inverse_.nearest(P, p_ST_, Q_);
    if (!end.is_reached()) return fault(line, reason(end, inverse_));
    note_singular(end, line);
    const plant::StraightToolPath path(here_, P);
    plant::ToolTolerance tolerance = options_.tolerance;
    if (options_.mode == PostMode::tip) {  // the NC keeps the tip where it belongs
      tolerance.tip = std::numeric_limits<double>::infinity();
    }
    plant::LinearisedPath way;
    way.points = {{1.0, end.Q}};
    if (options_.mode != PostMode::locations) {
      way = plant::linearise(inverse_, p_ST_, path, Q_, tolerance);
    }
    if (!way.is_complete) {
      here_ = P;
      Q_ = end.Q;
      const std::string why =
          way.failure.is_reached() ? std::string(kJumps) : reason(way.failure, inverse_);
      return fault(line, fmt::format("at {:.1f} % of the way here {}", 100.0 * way.t, why));
    }
    out_.inserted += way.points.size() - 1;
    double t = 0.0;
    for (const plant::PathPoint& point : way.points) {
      const double share = point.t - t;
      const bool stands = path.length() < kStandingTip;
      const double time =
          share * (stands ? path.angle() / options_.turn_rate : path.length() / feed);
      block(MoveKind::feed, line, path.at(point.t), point.Q, share * path.length(), time);
      t = point.t;
    }
    here_ = P;
  }

  // One block to the joints Q, on which the tip takes its way (m) in that time (s).
  void block(MoveKind kind, int line, const ToolPose& P, const Joints& Q, double way, double time) {
    Move& move = add(kind, line);
    AxisWords words = inverse_.chain().layout.words(Q);
    move.end_machine = words;
    if (options_.mode == PostMode::tip) {
      words.head<3>() = P.p_WT;
    } else {
      words -= tool_offset_;
    }
    words.head<3>() -= options_.part_zero;
    move.end = words;
    const bool moves_tip = way > 0.0;
    if (kind == MoveKind::feed) {
      const bool in_time = options_.mode != PostMode::tip || !moves_tip;
      move.feed_mode = in_time ? FeedMode::inverse_time : FeedMode::units_per_minute;
      const double turn = (Q - Q_).tail<kJoints - kLinearJoints>().norm();
      // a block of no time at all: nothing moves
      move.feed = time > 0.0 ? (moves_tip ? way : turn) / time : options_.turn_rate;
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
  Posted out_;
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
  return fmt::format("axis {} would stand at {:.6g} {}, beyond its travel of {:g} to {:g}",
                     inverse.chain().layout.letter_of(solution.joint),
                     solution.Q[solution.joint] / unit, linear ? "mm" : "deg",
                     inverse.settings().lower[solution.joint] / unit,
                     inverse.settings().upper[solution.joint] / unit);
}

Posted post(const ClData& data, const std::string& file, const plant::InverseKinematics& inverse,
            const PostOptions& options) {
  return Post(data, file, inverse, options).run();
}

}  // namespace servomill::controllers
