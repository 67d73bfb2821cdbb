#include "sim/programs/verify_post.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>

#include "controllers/gcode/interpreter.h"
#include "plant/kinematics/inverse.h"
#include "plant/kinematics/straight_tool_path.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "sim/preparation/prepared_case.h"

namespace servomill::sim {
namespace {

using controllers::ClRecord;
using Eigen::Vector3d;

// Words have seven decimals of mm and deg; the tip is up to some metres from a rotary axis.
constexpr double kTip = 1e-8;          // m
constexpr double kAxis = 2e-8;         // rad
constexpr double kJoint = 1e-9;        // m, rad
constexpr double kTime = 1e-6;         // relative
constexpr double kDigits = 5e-9;       // m, rad: of the ends of a block, for its time
constexpr double kStandingTip = 1e-9;  // m; as the post-processor
constexpr int kSamples = 8;            // of one block
constexpr int kZ = 2;

bool near(const ToolPose& a, const ToolPose& b) {
  return (a.p_WT - b.p_WT).norm() <= kTip && angle_between(a.k_W, b.k_W) <= kAxis;
}

// State of the machine that a program reaches, block by block.
struct State {
  Joints Q = Joints::Zero();
  ToolPose P;
  bool knows_P = false;  // every axis has been named
  bool controls_tip = false;
  int tool = 0, coolant = 0, direction = 0;
  double speed = 0.0;  // rad/s
};

class PostReplay {
 public:
  PostReplay(const std::string& program, const controllers::ClData& data,
             const MachineSettings& machine, const controllers::PostOptions& options,
             const std::string& cl_file)
      : program_(program), data_(data), chain_(machine.chain), options_(options), file_(cl_file) {
    controllers::ProgramSetup setup;
    setup.tools = options.tools;
    setup.work_offset[static_cast<std::size_t>(options.work_system - 1)].head<3>() =
        options.work_offset;
    setup.machine = tool_centre_point(machine);
    setup.start = elsewhere();
    now_.Q = chain_.layout.joints(setup.start);
    moves_ = controllers::interpret(program, "program", std::move(setup));
    result_.only_locations = options.mode == controllers::PostMode::locations;
    if (options_.tool > 0 && data.first_without_tool() != nullptr) {
      tools_.push_back(options_.tool);
    }
  }

  PostVerification run() {
    for (const ClRecord& record : data_.records) {
      record_ = &record;
      if (is_motion(record.kind)) {
        to_location(record);
      } else {
        expect(record);
      }
    }
    to_end();
    return result_;
  }

 private:
  // A start that no program can have meant.
  AxisWords elsewhere() const {
    AxisWords words;
    words << -0.0123, 0.0234, -0.0345, 0.0456, -0.0567, 0.0678;
    return chain_.layout.words(chain_.layout.joints(words));  // 0 for axes that it lacks
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError({file_, record_ != nullptr ? record_->line : 0, 0},
                     fmt::format("not as verified: line {} of the program, '{}': {}", line_,
                                 text_of_line(), what));
  }

  std::string_view text_of_line() const {
    std::string_view rest = program_;
    for (int n = 1; n < line_; ++n)
      rest.remove_prefix(std::min(rest.find('\n'), rest.size() - 1) + 1);
    return rest.substr(0, rest.find('\n'));
  }

  bool is_safe() const { return options_.approach == controllers::Approach::safe; }
  bool is_retracted(const Joints& Q) const {
    return std::abs(Q[kZ] - options_.safe.retract_Z) <= kJoint;
  }
  ToolPose clear_of(const ToolPose& P) const {
    return {P.p_WT + options_.safe.clearance * P.k_W, P.k_W};
  }

  Vector3d p_ST() const {
    const auto* tool = options_.tools.find(now_.tool);
    return tool == nullptr ? Vector3d::Zero() : Vector3d(-tool->offset.head<3>());
  }

  // ---- what the locations ask for beside motion

  void expect(const ClRecord& record) {
    switch (record.kind) {
      case MoveKind::tool:
        tools_.push_back(record.number);
        changes_tool_ = true;
        break;
      case MoveKind::spindle:
        wanted_.direction = record.direction;
        wanted_.speed = record.value;
        break;
      case MoveKind::coolant:
        wanted_.coolant = record.number;
        break;
      default:
        events_.push_back(&record);
    }
  }

  // Everything but motion.
  void act(const Move& move) {
    switch (move.kind) {
      case MoveKind::tool:
        if (tools_.empty() || tools_.front() != move.number) {
          fail(fmt::format("tool {} is loaded, which the cutter locations do not call for",
                           move.number));
        }
        wanted_.tool = now_.tool = tools_.front();
        tools_.pop_front();
        if (!is_safe()) return;
        if (!is_retracted(now_.Q)) fail("a tool is changed below the height to retract to");
        if (now_.direction != 0 || now_.coolant != 0 || stopped_in_ == move.line) {
          fail("a tool is changed while the spindle or the coolant is on");
        }
        return;
      case MoveKind::spindle:
        if (move.direction == 0 && now_.direction != 0) stopped_in_ = move.line;
        now_.direction = move.direction;
        now_.speed = move.value;
        return;
      case MoveKind::coolant:
        now_.coolant = move.number;
        return;
      case MoveKind::end:
        if (is_safe() && stopped_in_ == move.line) fail("the program ends with the spindle on");
        return;
      default:
        take_event(move);
    }
  }

  void take_event(const Move& move) {
    const bool is_wanted =
        !events_.empty() && events_.front()->kind == move.kind &&
        (move.kind != MoveKind::stop || events_.front()->number == move.number) &&
        (move.kind != MoveKind::dwell || std::abs(events_.front()->value - move.value) <= kTime);
    if (!is_wanted) fail("a dwell, stop or message that the cutter locations do not have here");
    events_.pop_front();
    const bool at_location = !has_location_ || changes_tool_ || near(now_.P, last_);
    if (move.kind == MoveKind::dwell && !at_location) fail("the dwell is not at its location");
  }

  void check_state() const {
    if (!events_.empty()) fail("a dwell, stop or message before this location is missing");
    if (!tools_.empty()) fail(fmt::format("tool {} is not loaded", tools_.front()));
    if (now_.tool != wanted_.tool) fail(fmt::format("tool {} is in the spindle", now_.tool));
    const bool same_speed = std::abs(now_.speed - wanted_.speed) <= kTime * std::abs(wanted_.speed);
    if (now_.direction != wanted_.direction || (wanted_.direction != 0 && !same_speed)) {
      fail("the spindle does not run as the cutter locations specify");
    }
    if (now_.coolant != wanted_.coolant) fail("the coolant is not as the cutter locations specify");
  }

  // ---- motion

  // The next motion; what is not motion before it has been done. nullptr: the program has ended.
  const Move* next_motion() {
    while (next_ < moves_.size()) {
      throw_if_interrupted();
      const Move& move = moves_[next_++];
      line_ = move.line;
      if (is_motion(move.kind)) return &move;
      act(move);
    }
    return nullptr;
  }

  // One block from where the machine is: pose at the share t of it.
  struct Block {
    const Move* move = nullptr;
    State from, to;
  };

  Block block_of(const Move& move) const {
    Block block{&move, now_, now_};
    block.to.controls_tip = move.tool_control != ToolControl::none;
    const Joints end = chain_.layout.joints(move.end_machine);
    if (block.to.controls_tip) {
      block.to.Q.tail<kJoints - kLinearJoints>() = end.tail<kJoints - kLinearJoints>();
      block.to.P = {move.end_machine.head<3>(), axis_at(block.to.Q)};
    } else {
      block.to.Q = end;
      block.to.P = plant::forward(chain_, end, p_ST());
    }
    return block;
  }

  Vector3d axis_at(const Joints& Q) const { return plant::forward(chain_, Q, p_ST()).k_W; }

  ToolPose pose_at(const Block& block, double t) const {
    const Joints Q = block.from.Q + t * (block.to.Q - block.from.Q);
    if (!block.to.controls_tip) return plant::forward(chain_, Q, p_ST());
    return {block.from.P.p_WT + t * (block.to.P.p_WT - block.from.P.p_WT), axis_at(Q)};
  }

  bool rotates(const Block& block) const {
    return (block.to.Q - block.from.Q).tail<kJoints - kLinearJoints>().cwiseAbs().maxCoeff() >
           kJoint;
  }

  static double time_of(const Block& block) {
    const Move& move = *block.move;
    const double length = move.s_end - move.s_begin;
    const double way =
        length > 0.0 ? length : (block.to.Q - block.from.Q).tail<kJoints - kLinearJoints>().norm();
    return way > 0.0 ? way / move.feed : 0.0;
  }

  void to_location(const ClRecord& record) {
    const ToolPose P{record.P.p_WT + options_.work_offset, record.P.k_W};
    if (record.kind == MoveKind::feed && has_location_ && !changes_tool_) {
      feed_to(record, P);
    } else {
      jump_to(record, P);
    }
    check_state();
    last_ = P;
    has_location_ = true;
    changes_tool_ = false;
    ++result_.locations;
  }

  void arrive(const Block& block) {
    now_ = block.to;
    now_.knows_P = true;
    ++result_.blocks;
  }

  void feed_to(const ClRecord& record, const ToolPose& P) {
    const plant::StraightToolPath path(last_, P);
    double t = 0.0;
    do {
      const Move* move = next_motion();
      if (move == nullptr) fail("the program ends before this location");
      if (move->kind != MoveKind::feed) fail("a rapid where the cutter locations have a feed");
      if (move->tool_offset != now_.tool) {
        fail(fmt::format("length {} is in force with tool {}", move->tool_offset, now_.tool));
      }
      check_rounding(*move);
      const Block block = block_of(*move);
      const double t_next = result_.only_locations ? 1.0 : share_at(path, P, block.to.P);
      if (t_next < t - kTime) fail("the tool goes back on its path");
      check_path(block, path, t, t_next);
      // a free axis may turn with the tool in place, before it leaves
      const bool goes = t_next - t > kTime || near(block.to.P, P);
      if (goes) check_time(block, record, path, t_next - t);
      arrive(block);
      t = t_next;
    } while (!near(now_.P, P));
  }

  void check_rounding(const Move& move) const {
    if (move.path_mode != PathMode::continuous) return;
    const bool is_bounded =
        move.path_tolerance > 0.0 && move.path_tolerance <= options_.tolerance.tip * (1.0 + kTime);
    if (!is_bounded) fail("nothing keeps corners within the tolerance (G64 P)");
  }

  void check_time(const Block& block, const ClRecord& record, const plant::StraightToolPath& path,
                  double share) const {
    const bool is_still = path.length() < kStandingTip;
    const double rate =
        is_still ? options_.rotary_rate : (record.feed > 0.0 ? record.feed : options_.feed);
    const double wanted = share * (is_still ? path.angle() : path.length()) / rate;
    const double time = time_of(block);
    if (std::abs(time - wanted) <= kTime * wanted + kDigits / rate) return;
    fail(fmt::format("the block takes {:.6g} s; at the feed of the locations {:.6g} s", time,
                     wanted));
  }

  // Share of a path that a pose on it has gone: by the tip, or by the axis where that tells more.
  double share_at(const plant::StraightToolPath& path, const ToolPose& end,
                  const ToolPose& pose) const {
    if (near(pose, end)) return 1.0;
    const double L = path.length(), beta = path.angle();
    if (L / kTip < beta / kAxis) return angle_between(last_.k_W, pose.k_W) / beta;
    if (L < kStandingTip) return 0.0;
    return (pose.p_WT - last_.p_WT).dot(end.p_WT - last_.p_WT) / (L * L);
  }

  void check_path(const Block& block, const plant::StraightToolPath& path, double t,
                  double t_next) {
    if (result_.only_locations) return;
    for (int n = 1; n <= kSamples; ++n) {
      const double share = static_cast<double>(n) / kSamples;
      const ToolPose is = pose_at(block, share), wanted = path.at(t + share * (t_next - t));
      const double tip = (is.p_WT - wanted.p_WT).norm(), axis = angle_between(is.k_W, wanted.k_W);
      if (!(tip <= options_.tolerance.tip + kTip)) {
        fail(fmt::format("the tip is {:.4g} um off the straight path", tip / um));
      }
      if (!(axis <= options_.tolerance.axis + kAxis)) {
        fail(fmt::format("the tool axis is {:.4g} urad off its great circle", axis / urad));
      }
      result_.tip = std::max(result_.tip, tip);
      result_.axis = std::max(result_.axis, axis);
    }
  }

  void jump_to(const ClRecord& record, const ToolPose& P) {
    bool has_fed = false;
    do {
      const Move* move = next_motion();
      if (move == nullptr) fail("the program ends before this location");
      const Block block = block_of(*move);
      const bool is_feed = move->kind == MoveKind::feed;
      if (has_fed || (is_feed && record.kind == MoveKind::rapid)) {
        fail("a feed where the cutter locations have a rapid");
      }
      has_fed = is_feed;
      if (is_safe()) check_safe(block, &P);
      arrive(block);
    } while (!near(now_.P, P));
  }

  void to_end() {
    record_ = nullptr;
    while (const Move* move = next_motion()) {
      if (!is_safe() || move->kind != MoveKind::rapid) fail("a motion after the last location");
      const Block block = block_of(*move);
      check_safe(block, nullptr);
      arrive(block);
    }
    if (!events_.empty() || !tools_.empty()) {
      fail("a dwell, stop, message or tool after the last location is missing");
    }
    if (!is_safe()) return;
    if (!is_retracted(now_.Q)) fail("the program ends below the height to retract to");
    for (int j = kLinearJoints; j < kJoints; ++j) {
      constexpr double kTurn = 2.0 * std::numbers::pi;  // rad
      const double off = std::remainder(now_.Q[j] - options_.start[j], kTurn);
      if (std::abs(off) > kAxis) fail("the rotary axes do not come back to their start");
    }
    if (now_.direction != 0 || now_.coolant != 0)
      fail("the program ends with spindle or coolant on");
  }

  // Does a block move neither X nor Y of the machine? Under tip control the end of the block is
  // that of the tip; after it G53 names Z alone.
  bool moves_only_Z(const Block& block) const {
    if (block.from.controls_tip) return true;
    Joints end = block.to.Q;
    double tolerance = kJoint;
    if (block.to.controls_tip) {
      const auto found = plant::inverse_fixed_rotary(chain_, block.to.P.p_WT, end, p_ST());
      if (!found) return false;
      end = *found;
      tolerance = kTip;
    }
    return (end - block.from.Q).head<2>().cwiseAbs().maxCoeff() <= tolerance;
  }

  // A block to or from a location.
  void check_safe(const Block& block, const ToolPose* P) const {
    const bool starts_up = is_retracted(block.from.Q), ends_up = is_retracted(block.to.Q);
    if (!block.from.knows_P) {
      const Joints d = block.to.Q - block.from.Q;
      const bool only_Z = (d - Joints::Unit(kZ) * d[kZ]).cwiseAbs().maxCoeff() <= kJoint;
      if (!ends_up || !only_Z) fail("the program does not begin with a retract of Z");
      return;
    }
    const bool is_up = starts_up && ends_up && !block.to.controls_tip;
    if (is_up) return;
    if (rotates(block)) fail("a rotary axis moves below the height to retract to");
    if (P != nullptr && near(block.from.P, last_) && near(block.to.P, *P)) return;  // plain rapid
    const Vector3d d = block.to.P.p_WT - block.from.P.p_WT, u = block.to.P.k_W;
    const bool along_axis = (d - u.dot(d) * u).norm() <= kTip;
    const bool leaves =
        has_location_ && near(block.from.P, last_) && near(block.to.P, clear_of(last_));
    const bool arrives = P != nullptr && near(block.to.P, *P) && near(block.from.P, clear_of(*P));
    if (along_axis && (leaves || arrives)) return;
    const bool goes_up = ends_up && has_location_ && near(block.from.P, clear_of(last_));
    const bool comes_down = starts_up && P != nullptr && near(block.to.P, clear_of(*P));
    if ((goes_up || comes_down) && moves_only_Z(block)) return;
    fail("the tool moves below the height to retract to, but not along its axis");
  }

  std::string_view program_;
  const controllers::ClData& data_;
  const plant::MachineChain& chain_;
  const controllers::PostOptions& options_;
  const std::string& file_;
  std::vector<Move> moves_;
  std::size_t next_ = 0;
  int line_ = 0, stopped_in_ = 0;  // M6 and M30 stop the spindle, too
  const ClRecord* record_ = nullptr;
  State now_, wanted_;
  std::deque<int> tools_;
  std::deque<const ClRecord*> events_;
  ToolPose last_;
  bool has_location_ = false, changes_tool_ = false;
  PostVerification result_;
};

}  // namespace

PostVerification verify_post(const std::string& program, const controllers::ClData& data,
                             const MachineSettings& machine,
                             const controllers::PostOptions& options, const std::string& cl_file) {
  return PostReplay(program, data, machine, options, cl_file).run();
}

std::string to_string(const PostVerification& v) {
  const std::string head =
      fmt::format("verified: {} locations, {} blocks of motion", v.locations, v.blocks);
  if (v.only_locations) return head + "; between locations nothing was compared (--classical)";
  return fmt::format("{}, tip within {:.3g} um and tool axis within {:.3g} urad of the path", head,
                     v.tip / um, v.axis / urad);
}

}  // namespace servomill::sim
