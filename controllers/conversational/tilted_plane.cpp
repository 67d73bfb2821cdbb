// PLANE, FUNCTION TCPM, and the rotary axes that turn to a plane.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "controllers/conversational/translator.h"
#include "controllers/translation/plane_angles.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::conversational {
namespace {

// First about the X axis of the machine, then about Y, then about Z: iTNC 530 (340 422) p. 460.
Eigen::Matrix3d rotation_of(const std::array<double, 3>& angles) {
  const auto about = [&](std::size_t i, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(angles[i] * deg, axis).toRotationMatrix();
  };
  return about(2, Eigen::Vector3d::UnitZ()) * about(1, Eigen::Vector3d::UnitY()) *
         about(0, Eigen::Vector3d::UnitX());
}

}  // namespace

// FUNCTION TCPM, FUNCTION RESET TCPM, FUNCTION DWELL TIME.
void Translator::function_block(Words& words) {
  if (words.take("RESET") != nullptr && words.take("TCPM") != nullptr) {
    words.refuse_rest("FUNCTION RESET TCPM");
    return tcp_control(false);
  }
  if (words.take("DWELL") != nullptr) {
    const auto time = words.take_number("TIME");
    if (!time) fail("FUNCTION DWELL: only TIME is supported, in seconds");
    words.refuse_rest("FUNCTION DWELL");
    return cycle_dwell(value(*time));
  }
  const bool is_tcpm = words.take("TCPM") && words.take("F");
  const bool is_on_axes = words.take("CONT") != nullptr;
  const bool has_positions = (is_on_axes || words.take("TCP") != nullptr) && words.take("AXIS") &&
                             words.take("POS") && words.take("PATHCTRL");
  const bool is_vector = words.take("VECTOR") != nullptr;
  const bool is_known = is_tcpm && has_positions && (is_vector || words.take("AXIS") != nullptr);
  const bool has_other_path = is_on_axes || is_vector;
  if (!is_known || (has_other_path && !setup_.accepts_unknown_positions)) {
    fail(
        "FUNCTION: only TCPM F TCP AXIS POS PATHCTRL AXIS (same as M128), RESET TCPM and DWELL "
        "TIME are supported");
  }
  words.refuse_rest("FUNCTION TCPM");
  if (has_other_path) {
    forget_feeds(
        "FUNCTION TCPM with F CONT or PATHCTRL VECTOR: only the end points of moves are known");
  }
  tcp_control(true);
}

// PLANE SPATIAL, PLANE RESET.
void Translator::plane(const HeidenhainBlock& block) {
  Words words(std::span(block.words).subspan(1));
  if (block.words.front().text == "FUNCTION") return function_block(words);
  const auto behaviour = [&]() -> std::string {
    for (const char* name : {"STAY", "TURN", "MOVE"}) {
      if (words.take(name) != nullptr) return name;
    }
    return {};
  };
  if (words.take("RESET") != nullptr) {
    const std::string how = behaviour();
    plane_options(words);
    retract_before_plane(words, how);
    words.refuse_rest("PLANE RESET");
    return reset_plane(how);
  }
  if (words.take("SPATIAL") == nullptr) {
    if (can_leave_plane_unknown()) return survey_plane("PLANE other than SPATIAL");
    fail("PLANE: only SPATIAL and RESET are supported; define the plane with spatial angles");
  }
  std::array<double, 3> angles{};
  constexpr std::array<std::string_view, 3> kNames = {"SPA", "SPB", "SPC"};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto angle = words.take_number(kNames[i]);
    if (!angle) fail(fmt::format("PLANE SPATIAL requires {}", kNames[i]));
    angles[i] = value(*angle);
  }
  tilt(angles, behaviour(), words);
}

// MB and the feed of a PLANE block that positions the rotary axes: before them the tool retracts by
// MB along its axis, or to the limit of travel (iTNC 530, PLANE, MB; from memory).
void Translator::retract_before_plane(Words& words, const std::string& behaviour) {
  Positioning p;
  const HeidenhainWord* mb = words.take("MB");
  const bool is_to_limit =
      mb != nullptr ? words.take("MAX") != nullptr : words.take("MBMAX") != nullptr;
  if (mb != nullptr && !is_to_limit) fail(mb->place, "'MB' requires a number or MAX");
  p.is_retract_to_limit = is_to_limit;
  if (const auto MB = is_to_limit ? std::nullopt : words.take_number("MB")) p.retract = length(*MB);
  while (words.peek() != nullptr && words.peek()->address.starts_with('F')) read_feed(words, p);
  if (behaviour != "TURN" && behaviour != "MOVE") return;
  if (p.retract && *p.retract != 0.0) retract(p);
  if (!is_to_limit) return;
  if (plane_ && can_leave_plane_unknown()) return forget_linear_positions();
  retract_to_limit(p);
}

// SEQ, TABLE ROT and COORD ROT; returns the sign of SEQ, or 0.
int Translator::plane_options(Words& words) {
  const int seq = words.take("SEQ+") != nullptr ? 1 : words.take("SEQ-") != nullptr ? -1 : 0;
  if (words.take("SYM+") != nullptr || words.take("SYM-") != nullptr) {
    fail(
        "PLANE: SYM selects a solution by a machine-specific rule and is not supported; use SEQ+, "
        "SEQ- or neither");
  }
  if (words.take("TABLE") != nullptr || words.take("COORD") != nullptr) {
    if (words.take("ROT") == nullptr) fail("PLANE: ROT must follow TABLE and COORD");
    warn_once("TABLE ROT",
              "PLANE: TABLE ROT and COORD ROT are ignored; they matter only with a free rotary "
              "table axis");
  }
  return seq;
}

// True in surveys without a machine, which print no places in tilted planes.
bool Translator::can_leave_plane_unknown() const {
  return setup_.accepts_unknown_positions && !setup_.machine;
}

// A plane of unknown tilt: surveys leave out what moves in it.
void Translator::survey_plane(const std::string& what) {
  require_no_compensation("PLANE");
  if (is_tcp_) fail("PLANE is not allowed with M128; cancel it with M129");
  warn_once("plane",
            what + ": the tilt is not evaluated; moves in the plane are excluded from the extent");
  if (plane_) reset_plane("STAY");
  path_.flush();
  plane_turn_.clear();
  is_tool_in_plane_ = false;
  plane_line_ = "G68.2";
  for (std::size_t i = 0; i < 3; ++i) plane_line_ += " " + word("XYZ"[i], frame_.shift[i]);
  plane_line_ += " I0 J90 K0";
  lines_.put({plane_line_, place_, {true, false, {}}});
  enter_plane({90.0, 0.0, 0.0});
  for (const int number : {120, 121, 122}) {
    parameters_.forget({'Q', number}, "is the rotary axis angle of PLANE");
  }
  for (std::size_t i = 3; i < work_.size(); ++i) work_[i].reset();
}

// Positions count from the plane, where nothing has been programmed yet.
void Translator::enter_plane(const std::array<double, 3>& angles) {
  plane_ = angles;
  frame_before_plane_ = frame_;
  frame_ = {};
  forget_linear_positions();
}

void Translator::tilt(const std::array<double, 3>& angles, const std::string& behaviour,
                      Words& words) {
  require_no_compensation("PLANE");
  if (is_tcp_) fail("PLANE is not allowed with M128; cancel it with M129");
  if (behaviour.empty()) fail("PLANE SPATIAL requires STAY, TURN or MOVE");
  if (behaviour == "MOVE") {
    const std::string why =
        "PLANE ... MOVE: the compensating movement of the linear axes is not supported; use TURN";
    if (!can_leave_plane_unknown()) fail(why);
    warn_once("MOVE", why + "; excluded from the extent");
  }
  const int seq = plane_options(words);
  retract_before_plane(words, behaviour);
  words.refuse_rest("PLANE SPATIAL");
  if (!frame_.is_plain() &&
      (frame_.rotation != 0.0 || frame_.is_any_mirrored() || frame_.scale != 1.0)) {
    fail("PLANE is not allowed while cycle 8, 10 or 11 is active; define them after PLANE");
  }
  if (setup_.tools.find(tool_) == nullptr) {
    const std::string why = fmt::format(
        "PLANE: the length of tool {} is unknown; pass a tool table with --tools", tool_);
    if (!setup_.accepts_unknown_positions) fail(why);
    warn_once("PLANE", why);
  }
  if (plane_) reset_plane("STAY");
  path_.flush();
  const Eigen::Matrix3d R = rotation_of(angles);
  plane_turn_ = turn_of_plane(R, seq);
  is_tool_in_plane_ = behaviour != "STAY" || (R.isIdentity(1e-12) && rotary_axes_are_at_zero());
  if (behaviour != "STAY" && !plane_turn_.empty()) lines_.put(plane_turn_, place_);
  const std::array<double, 3> euler = translation::euler_angles(R);
  plane_line_ = "G68.2";
  for (std::size_t i = 0; i < 3; ++i) plane_line_ += " " + word("XYZ"[i], frame_.shift[i]);
  for (std::size_t i = 0; i < 3; ++i) plane_line_ += " " + word("IJK"[i], euler[i]);
  lines_.put(plane_line_, place_);
  if (behaviour != "STAY") lines_.put("G53.1", place_);
  enter_plane(angles);
  for (std::size_t i = 3; i < work_.size(); ++i) {
    if (behaviour != "STAY") work_[i].reset();
  }
  is_rotary_zero_left_ |= behaviour != "STAY" && !R.isIdentity(1e-12);
}

// SEQ+ and SEQ- want the principal axis at a positive or negative angle: the first rotary axis from
// the tool, or the last from the table (TNC 640, PLANE, SEQ; from memory), which is the last one of
// the chain from the workpiece to the tool. Returns the line that takes the axes there before the
// plane is tilted; without SEQ the nearest solution is that of G53.1.
std::string Translator::turn_of_plane(const Eigen::Matrix3d& R, int seq) {
  const bool is_level = R.isApprox(Eigen::Matrix3d::Identity(), 1e-12);
  for (const int number : {120, 121, 122}) {
    if (is_level) {
      parameters_.set({'Q', number}, 0.0);
    } else {
      parameters_.forget({'Q', number}, "is the rotary axis angle of PLANE");
    }
  }
  if (seq == 0 || is_level || !setup_.machine) return {};
  const plant::MachineChain& chain = setup_.machine->chain();
  int principal = -1;
  for (const plant::ChainAxis& axis : chain.axes) {
    const auto joint = chain.layout.joint_of(axis.axis);
    if (joint && !is_linear(axis.axis)) principal = *joint;
  }
  if (principal < 0) return {};
  const plant::JointSolutions found = setup_.machine->inverse().solve(
      {Eigen::Vector3d::Zero(), R.col(2)}, Eigen::Vector3d::Zero(), Joints::Zero());
  constexpr double kLevel = 1e-9;  // rad
  for (int i = 0; i < found.count; ++i) {
    const plant::JointSolution& one = found.all[static_cast<std::size_t>(i)];
    const bool is_allowed =
        one.reach != plant::Reach::orientation && one.reach != plant::Reach::travel;
    if (!is_allowed || seq * one.Q[principal] < -kLevel) continue;
    std::string text = "G53 G0";
    const AxisWords words = chain.layout.words(one.Q);
    for (std::size_t k = 3; k < work_.size(); ++k) {
      if (!chain.layout.joint_of(kAllAxes[k])) continue;
      text += " " + word(letter(kAllAxes[k]), words[static_cast<int>(k)] / deg);
    }
    return text;
  }
  fail(fmt::format(
      "PLANE: no rotary axis position within the travel limits has {} {} 0, as {} requires",
      chain.layout.letter_of(principal), seq > 0 ? ">=" : "<=", seq > 0 ? "SEQ+" : "SEQ-"));
}

// L A+Q120 C+Q122 behind PLANE ... STAY: the axes go to the solution that PLANE has left in Q120 to
// Q122. True if the block is such a one.
bool Translator::turn_to_plane(const Positioning& p) {
  bool is_turn = plane_.has_value() && !p.target[0] && !p.target[1] && !p.target[2];
  for (std::size_t i = 3; i < p.target.size() && is_turn; ++i) {
    if (!p.target[i]) continue;
    const Operand& operand = p.target[i]->value;
    const QName name{'Q', 117 + static_cast<int>(i)};
    is_turn = !p.target[i]->is_increment && operand.name == name && operand.sign > 0.0;
  }
  if (!is_turn) return false;
  if (p.feed && p.feed->kind != Feed::Kind::rapid) {
    warn_once("turn",
              "F in the block that positions the rotary axes to the plane: treated as FMAX");
  }
  path_.flush();
  if (plane_turn_.empty()) {
    lines_.put("G53.1", place_);
  } else {  // G-code has no words of rotary axes in a tilted plane
    for (const std::string& line : {std::string("G69"), plane_turn_, plane_line_}) {
      lines_.put(line, place_);
    }
  }
  was_rapid_ = true;
  is_tool_in_plane_ = is_rotary_zero_left_ = true;
  forget_linear_positions();
  for (std::size_t i = 3; i < work_.size(); ++i) work_[i].reset();
  return true;
}

// True if no rotary axis stands elsewhere than at zero, where programs begin.
bool Translator::rotary_axes_are_at_zero() const {
  for (std::size_t i = 3; i < work_.size(); ++i) {
    if (!work_[i] && is_rotary_zero_left_) return false;
    if (work_[i].value_or(0.0) != 0.0 || frame_.shift[i] != 0.0) return false;
  }
  return true;
}

void Translator::reset_plane(const std::string& behaviour) {
  require_no_compensation("PLANE RESET");
  if (!plane_) {
    if (behaviour == "STAY" || behaviour.empty()) return;
    // nothing is tilted: rotary axes go to zero
    if (!setup_.machine && rotary_axes_are_at_zero()) {
      return warn_once("PLANE RESET",
                       "PLANE RESET TURN or MOVE moves the rotary axes to zero; they are assumed "
                       "to be there: no preceding block moves them");
    }
  } else {
    if (!frame_.is_plain()) {
      fail(
          "PLANE RESET is not allowed while cycle 7, 8, 10 or 11 is active in the tilted plane; "
          "reset it first");
    }
    path_.flush();
    lines_.put("G69", place_);
    plane_.reset();
    frame_ = frame_before_plane_;
    forget_linear_positions();
  }
  const bool turns = behaviour == "TURN" || behaviour == "MOVE";
  if (turns && can_leave_plane_unknown()) {
    warn_once("PLANE RESET",
              "PLANE RESET TURN or MOVE moves the rotary axes of the machine to zero, which is "
              "unknown here; pass it with --machine");
    for (std::size_t i = 3; i < work_.size(); ++i) work_[i] = frame_.shift[i];
    return forget_linear_positions();
  }
  if (behaviour == "MOVE") {
    fail(
        "PLANE RESET MOVE: the compensating movement of the linear axes is not supported; use "
        "TURN");
  }
  if (behaviour != "TURN") return;
  path_.flush();
  if (!setup_.machine) {
    fail("PLANE RESET TURN: the rotary axes depend on the machine; pass it with --machine");
  }
  std::string text = "G0";
  const JointLayout& layout = setup_.machine->chain().layout;
  for (std::size_t i = 3; i < work_.size(); ++i) {
    if (!layout.joint_of(kAllAxes[i])) continue;
    text += " " + word(letter(kAllAxes[i]), frame_.shift[i]);
    work_[i] = frame_.shift[i];
  }
  lines_.put(std::move(text), place_);
}

}  // namespace servomill::controllers::conversational
