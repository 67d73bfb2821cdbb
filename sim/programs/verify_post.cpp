#include "sim/programs/verify_post.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "controllers/gcode/interpreter.h"
#include "plant/kinematics/straight_tool_path.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/preparation/case_program.h"
#include "sim/preparation/prepared_case.h"
#include "sim/programs/post_functions.h"
#include "sim/programs/post_kinematics.h"

namespace servomill::sim::programs {
namespace {

using controllers::ClRecord;
using Eigen::Vector3d;

constexpr double kTime = 1e-6;         // relative
constexpr double kDigits = 5e-9;       // m, rad: of the ends of a block, for its time
constexpr double kStandingTip = 1e-9;  // m; as the post-processor
constexpr int kSamples = 8;            // of one block
constexpr int kZ = 2;

class PostReplay {
 public:
  PostReplay(const std::string& program, const controllers::ClData& data,
             const model::MachineSettings& machine, const controllers::PostOptions& options,
             const std::string& cl_file)
      : program_(program),
        data_(data),
        kinematics_(machine.chain, options),
        options_(options),
        file_(cl_file),
        functions_(options) {
    controllers::ProgramSetup setup;
    setup.tools = options.tools;
    setup.work_offset[static_cast<std::size_t>(options.work_system - 1)].head<3>() =
        options.work_offset;
    setup.machine = preparation::tool_centre_point(machine);
    setup.start = elsewhere(machine.chain.layout);
    now_.Q = machine.chain.layout.joints(setup.start);
    moves_ = controllers::interpret(program, "program", std::move(setup));
    stage_.emplace("moves", static_cast<double>(moves_.size()));
    result_.only_locations = options.mode == controllers::PostMode::locations;
    if (options_.tool > 0 && data.first_without_tool() != nullptr) {
      functions_.expect_tool(options_.tool);
    }
  }

  PostVerification run() {
    for (const ClRecord& record : data_.records) {
      record_ = &record;
      if (is_motion(record.kind)) {
        to_location(record);
      } else {
        functions_.expect(record);
      }
    }
    to_end();
    return result_;
  }

 private:
  // A start that no program can have meant.
  static AxisWords elsewhere(const JointLayout& layout) {
    AxisWords words;
    words << -0.0123, 0.0234, -0.0345, 0.0456, -0.0567, 0.0678;
    return layout.words(layout.joints(words));  // 0 for axes that it lacks
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError({file_, record_ != nullptr ? record_->line : 0, 0},
                     fmt::format("verification failed: line {} of the program, '{}': {}", line_,
                                 text_of_line(), what));
  }

  std::string_view text_of_line() const {
    std::string_view rest = program_;
    for (int n = 1; n < line_; ++n)
      rest.remove_prefix(std::min(rest.find('\n'), rest.size() - 1) + 1);
    return rest.substr(0, rest.find('\n'));
  }

  bool is_safe() const { return options_.approach == controllers::Approach::safe; }
  ToolPose clear_of(const ToolPose& P) const {
    return {P.p_WT + options_.safe.clearance * P.k_W, P.k_W};
  }

  // ---- motion

  // The next motion; what is not motion before it has been done. nullptr: the program has ended.
  const Move* next_motion() {
    while (next_ < moves_.size()) {
      throw_if_interrupted();
      stage_->reach(static_cast<double>(next_));
      const Move& move = moves_[next_++];
      line_ = move.line;
      if (is_motion(move.kind)) return &move;
      const bool at_location =
          !has_location_ || functions_.changes_tool() || same_pose(now_.P, last_);
      const std::string fault = functions_.act(move, now_, !at_location);
      if (!fault.empty()) fail(fault);
    }
    return nullptr;
  }

  void to_location(const ClRecord& record) {
    const ToolPose P{record.P.p_WT + options_.work_offset, record.P.k_W};
    if (record.kind == MoveKind::feed && has_location_ && !functions_.changes_tool()) {
      feed_to(record, P);
    } else {
      jump_to(record, P);
    }
    const std::string fault = functions_.arrive(now_);
    if (!fault.empty()) fail(fault);
    last_ = P;
    has_location_ = true;
    ++result_.locations;
  }

  void arrive(const PostBlock& block) {
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
        fail(fmt::format("length {} is active with tool {}", move->tool_offset, now_.tool));
      }
      check_rounding(*move);
      const PostBlock block = kinematics_.block_of(*move, now_);
      const double t_next = result_.only_locations ? 1.0 : share_at(path, P, block.to.P);
      if (t_next < t - kTime) fail("the tool moves backwards on its path");
      check_path(block, path, t, t_next);
      // a free axis may turn with the tool in place, before it leaves
      const bool goes = t_next - t > kTime || same_pose(block.to.P, P);
      if (goes) check_time(block, record, path, t_next - t);
      arrive(block);
      t = t_next;
    } while (!same_pose(now_.P, P));
  }

  void check_rounding(const Move& move) const {
    if (move.path_mode != PathMode::continuous) return;
    const bool is_bounded =
        move.path_tolerance > 0.0 && move.path_tolerance <= options_.tolerance.tip * (1.0 + kTime);
    if (!is_bounded) fail("corners are not limited to the tolerance (G64 P)");
  }

  void check_time(const PostBlock& block, const ClRecord& record,
                  const plant::StraightToolPath& path, double share) const {
    const bool is_still = path.length() < kStandingTip;
    const double rate =
        is_still ? options_.rotary_rate : (record.feed > 0.0 ? record.feed : options_.feed);
    const double wanted = share * (is_still ? path.angle() : path.length()) / rate;
    const double time = block.time();
    if (std::abs(time - wanted) <= kTime * wanted + kDigits / rate) return;
    fail(fmt::format("the block takes {:.6g} s; at the feed of the locations {:.6g} s", time,
                     wanted));
  }

  // Share of a path that a pose on it has gone: by the tip, or by the axis where that tells more.
  double share_at(const plant::StraightToolPath& path, const ToolPose& end,
                  const ToolPose& pose) const {
    if (same_pose(pose, end)) return 1.0;
    const double L = path.length(), beta = path.angle();
    if (L / kPostTip < beta / kPostAxis) return angle_between(last_.k_W, pose.k_W) / beta;
    if (L < kStandingTip) return 0.0;
    return (pose.p_WT - last_.p_WT).dot(end.p_WT - last_.p_WT) / (L * L);
  }

  void check_path(const PostBlock& block, const plant::StraightToolPath& path, double t,
                  double t_next) {
    if (result_.only_locations) return;
    for (int n = 1; n <= kSamples; ++n) {
      const double share = static_cast<double>(n) / kSamples;
      const ToolPose is = kinematics_.pose_at(block, share),
                     wanted = path.at(t + share * (t_next - t));
      const double tip = (is.p_WT - wanted.p_WT).norm(), axis = angle_between(is.k_W, wanted.k_W);
      if (!(tip <= options_.tolerance.tip + kPostTip)) {
        fail(fmt::format("the TCP is {:.4g} um off the straight path", tip / um));
      }
      if (!(axis <= options_.tolerance.axis + kPostAxis)) {
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
      const PostBlock block = kinematics_.block_of(*move, now_);
      const bool is_feed = move->kind == MoveKind::feed;
      if (has_fed || (is_feed && record.kind == MoveKind::rapid)) {
        fail("a feed where the cutter locations have a rapid");
      }
      has_fed = is_feed;
      if (is_safe()) check_safe(block, &P);
      arrive(block);
    } while (!same_pose(now_.P, P));
  }

  void to_end() {
    record_ = nullptr;
    while (const Move* move = next_motion()) {
      if (!is_safe() || move->kind != MoveKind::rapid) fail("a motion after the last location");
      const PostBlock block = kinematics_.block_of(*move, now_);
      check_safe(block, nullptr);
      arrive(block);
    }
    if (functions_.is_pending()) {
      fail("a dwell, stop, message or tool after the last location is missing");
    }
    if (!is_safe()) return;
    if (!is_retracted(now_.Q, options_)) fail("the program ends below the retract height");
    for (int j = kLinearJoints; j < kJoints; ++j) {
      constexpr double kTurn = 2.0 * std::numbers::pi;  // rad
      const double off = std::remainder(now_.Q[j] - options_.start[j], kTurn);
      if (std::abs(off) > kPostAxis) fail("the rotary axes do not return to their start");
    }
    if (now_.direction != 0 || now_.coolant != 0)
      fail("the program ends with spindle or coolant on");
  }

  // A block to or from a location.
  void check_safe(const PostBlock& block, const ToolPose* P) const {
    const bool starts_up = is_retracted(block.from.Q, options_),
               ends_up = is_retracted(block.to.Q, options_);
    if (!block.from.knows_P) {
      const Joints d = block.to.Q - block.from.Q;
      const bool only_Z = (d - Joints::Unit(kZ) * d[kZ]).cwiseAbs().maxCoeff() <= kPostJoint;
      if (!ends_up || !only_Z) fail("the program does not start with a retract of Z");
      return;
    }
    const bool is_up = starts_up && ends_up && !block.to.controls_tip;
    if (is_up) return;
    if (block.rotates()) fail("a rotary axis moves below the retract height");
    if (P != nullptr && same_pose(block.from.P, last_) && same_pose(block.to.P, *P))
      return;  // plain rapid
    const Vector3d d = block.to.P.p_WT - block.from.P.p_WT, u = block.to.P.k_W;
    const bool along_axis = (d - u.dot(d) * u).norm() <= kPostTip;
    const bool leaves =
        has_location_ && same_pose(block.from.P, last_) && same_pose(block.to.P, clear_of(last_));
    const bool arrives =
        P != nullptr && same_pose(block.to.P, *P) && same_pose(block.from.P, clear_of(*P));
    if (along_axis && (leaves || arrives)) return;
    const bool goes_up = ends_up && has_location_ && same_pose(block.from.P, clear_of(last_));
    const bool comes_down = starts_up && P != nullptr && same_pose(block.to.P, clear_of(*P));
    if ((goes_up || comes_down) && kinematics_.moves_only_Z(block)) return;
    fail("the tool moves below the retract height, but not along its axis");
  }

  std::string_view program_;
  const controllers::ClData& data_;
  PostKinematics kinematics_;
  const controllers::PostOptions& options_;
  const std::string& file_;
  std::vector<Move> moves_;
  std::optional<Stage> stage_;
  std::size_t next_ = 0;
  int line_ = 0;
  const ClRecord* record_ = nullptr;
  PostFunctions functions_;
  PostState now_;
  ToolPose last_;
  bool has_location_ = false;
  PostVerification result_;
};

}  // namespace

PostVerification verify_post(const std::string& program, const controllers::ClData& data,
                             const model::MachineSettings& machine,
                             const controllers::PostOptions& options, const std::string& cl_file) {
  return PostReplay(program, data, machine, options, cl_file).run();
}

std::string to_string(const PostVerification& v) {
  const std::string head =
      fmt::format("verified: {} locations, {} blocks of motion", v.locations, v.blocks);
  if (v.only_locations) return head + "; between locations nothing was compared (--classical)";
  return fmt::format("{}, TCP within {:.3g} um and tool axis within {:.3g} urad of the path", head,
                     v.tip / um, v.axis / urad);
}

}  // namespace servomill::sim::programs
