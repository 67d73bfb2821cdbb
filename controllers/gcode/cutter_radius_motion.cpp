// Cutter radius compensation: G40 G41 G42 G41.1 G42.1, and the moves under it.
#include <fmt/format.h>

#include <cmath>

#include "controllers/gcode/interpreter_machine.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {

// ------------------------------------------------------------------------------ switching on, off

void Interpreter::Machine::cutter_compensation() {
  const int code = request().code(Group::g_cutter_compensation);
  if (state_.compensation.is_on) {
    // these came before this step: G40 in their block is too late
    if (state_.normal_axis != before_.normal_axis) refuse_code(Group::g_plane);
    if (request().code(Group::m_tool) == 60) refuse_code(Group::m_tool);
    refuse_code(Group::m_override);
  }
  if (code == 400) stop_compensation();
  if (code > 400) start_compensation();
  if (state_.compensation.is_on) refuse_codes_under_compensation();
}

void Interpreter::Machine::refuse_code(Group group) const {
  const Request::Chosen& chosen = request().of(group);
  if (chosen.code == nullptr) return;
  const char letter = group >= Group::m_input_output ? 'M' : 'G';
  fail(chosen.column,
       fmt::format("{} is not allowed with cutter compensation active; program G40 first",
                   code_name(letter, chosen.code->tenths)));
}

void Interpreter::Machine::refuse_codes_under_compensation() {
  for (const Group group : {Group::g_tool_length, Group::g_work_system, Group::g_work_plane,
                            Group::g_path_control, Group::g_retract}) {
    refuse_code(group);
  }
  const int code = request().code(Group::g_non_modal);
  if (code == 921 || code == 922 || code == 923) {
    warn(request().of(Group::g_non_modal).column,
         fmt::format("{} has no effect while cutter compensation is active", code_name('G', code)));
    request_.codes[static_cast<std::size_t>(Group::g_non_modal)] = {};
  }
  const bool sets_active_system =
      code == 100 && (request()['L'] == 2.0 || request()['L'] == 20.0) &&
      (std::abs(request()['P']) < 0.5 || std::abs(request()['P'] - state_.work_system) < 0.5);
  const bool is_machine_move = code == 530 && state_.compensation.acts();
  const bool is_other = code > 100 && code != 530;
  if (sets_active_system || is_machine_move || is_other) refuse_code(Group::g_non_modal);
  const int motion_code = request().motion_code();
  if (motion_code > 30) {
    fail(request().motion.column,
         fmt::format("{} is not allowed with cutter compensation active; program G40 first",
                     code_name('G', motion_code)));
  }
}

void Interpreter::Machine::start_compensation() {
  const Request::Chosen& chosen = request().of(Group::g_cutter_compensation);
  const std::string name = code_name('G', chosen.code->tenths);
  Compensation& compensation = state_.compensation;
  if (state_.normal_axis == 0) {
    fail(chosen.column, fmt::format("{} is not allowed in the YZ plane; use G17 or G18", name));
  }
  if (compensation.is_on) {
    fail(chosen.column,
         fmt::format("{} is not allowed with cutter compensation active; program G40 first", name));
  }
  if (state_.tool_control != ToolControl::none) {
    fail(chosen.column,
         fmt::format("{} is not allowed under TCP control; program G49 first", name));
  }
  const double diameter = compensation_diameter();
  const bool is_left = chosen.code->tenths < 420;
  compensation.is_on = true;
  compensation.cutter = {std::abs(diameter) / 2.0, is_left == (diameter >= 0.0)};
  compensation.is_radius_unknown = false;
  if (diameter == 0.0) warn_without_diameter(chosen.column, name);
  const char unused = chosen.code->tenths % 10 == 1 ? 'R' : 'L';  // taken, and left, by LinuxCNC
  if (request().has(unused)) {
    warn(request().word(unused).column, fmt::format("{} has no effect with {}", unused, name));
  }
}

// Number of the tool whose diameter counts; 0: none is in the spindle.
int Interpreter::Machine::compensating_tool() const {
  if (request().of(Group::g_cutter_compensation).code->tenths % 10 == 1) return 0;
  const int number = request().has('D') ? integer('D') : 0;
  return number == 0 ? state_.tool : number;
}

void Interpreter::Machine::warn_without_diameter(int column, const std::string& name) {
  const int number = compensating_tool();
  state_.compensation.is_radius_unknown = number > 0 && setup_.tools.entry_of(number) == nullptr;
  warn(column, state_.compensation.is_radius_unknown
                   ? fmt::format("{}: the diameter of tool {} is unknown; the programmed path is "
                                 "used without compensation; pass a tool table with --tools",
                                 name, number)
                   : fmt::format("{}: the tool diameter is 0; the path is not compensated", name));
}

// Diameter of the tool, m; negative: on the other side of the path.
double Interpreter::Machine::compensation_diameter() const {
  const Request::Chosen& chosen = request().of(Group::g_cutter_compensation);
  const std::string name = code_name('G', chosen.code->tenths);
  if (chosen.code->tenths % 10 == 1) {
    if (!request().has('D'))
      fail(chosen.column, fmt::format("{} requires a D word (tool diameter)", name));
    if (request().has('L')) {
      const int column = request().word('L').column;
      if (state_.normal_axis == 2)
        fail(column,
             fmt::format(
                 "L with {} in the XY plane; L, the orientation of a turning tool, requires G18",
                 name));
      refuse_turning_tool(column, integer('L'));
    }
    return request()['D'] * state_.unit;
  }
  if (request().has('D') && integer('D') < 0) {
    fail_at('D', fmt::format("{} D{}; must be >= 0", name, integer('D')));
  }
  const int number = compensating_tool();
  if (request().has('D')) tool_named('D', number);
  const ToolEntry* tool = setup_.tools.find(number);
  if (tool == nullptr && number != 0) {
    fail(chosen.column, fmt::format("{}: the diameter of tool {} is unknown; pass a tool table "
                                    "with --tools",
                                    name, number));
  }
  if (tool == nullptr) return 0.0;  // nothing in the spindle
  refuse_turning_tool(request().has('D') ? request().word('D').column : chosen.column,
                      tool->orientation);
  return tool->diameter;
}

// In orientation 9 the controlled point is the centre of the cutter, as it is of a mill.
void Interpreter::Machine::refuse_turning_tool(int column, int orientation) const {
  if (orientation == 0 || orientation == 9) return;
  fail(column,
       fmt::format(
           "turning tool of orientation {}; cutter compensation supports round tools only (0 or 9)",
           orientation));
}

void Interpreter::Machine::stop_compensation() {
  Compensation& compensation = state_.compensation;
  if (compensation.is_entered) {
    end_queue_at(state_.in_plane(state_.position));
    compensation.left_at = state_.to_account(state_.position);
    state_.position = state_.programmed();
    compensation.refuses_arc = true;
  }
  compensation.begin.reset();
  compensation.is_on = compensation.is_entered = false;
}

// ------------------------------------------------------------------------------------------ motion

// @param path            programmed, in the plane
// @param end             of the programmed move
// @param length          of the programmed path, m
void Interpreter::Machine::compensate(MoveKind kind, const PlaneMove& path, const AxisWords& end,
                                      double length, double feed) {
  Compensation& compensation = state_.compensation;
  const bool enters = !compensation.is_entered;
  const bool stays = !enters && !path.is_arc && path.begin == path.end;
  Compensated made;
  if (enters) {
    made = entry_move(compensation.cutter, path);
  } else if (stays) {
    made.move.end = state_.in_plane(state_.position);
  } else {
    made = following_move(compensation.cutter, path);
  }
  if (!made.fault.empty()) fail(request().motion.column, made.fault);
  if (enters && !path.is_arc) compensation.begin = path.begin;
  if (!enters && !stays) turn_corner(kind, path, end, feed);

  const double s_begin = state_.s;
  state_.s += length;
  compensation.left_at.reset();
  state_.position = state_.with_plane(end, made.move.end);
  compensation.programmed = path.end;
  compensation.is_entered = true;
  compensation.is_first_corner = enters || (stays && compensation.is_first_corner);
  Compensation::Waiting& waiting = compensation.queue.emplace_back();
  waiting.path = made.move;
  describe(waiting.move, kind);
  set_feed(waiting.move, feed);
  waiting.move.s_begin = s_begin;
  if (path.is_arc) {
    AxisWords centre = state_.with_plane(AxisWords::Zero(), made.move.centre);
    centre[state_.normal_axis] = end[state_.normal_axis];
    describe_arc(waiting.move, centre, made.move.turns);
  }
}

void Interpreter::Machine::turn_corner(MoveKind kind, const PlaneMove& path, const AxisWords& end,
                                       double feed) {
  Compensation& compensation = state_.compensation;
  const Eigen::Vector2d tool = state_.in_plane(state_.position);
  const Corner found = corner(compensation.cutter, tool, compensation.front(), path);
  if (!found.fault.empty()) fail(request().motion.column, found.fault);
  if (std::exchange(compensation.is_first_corner, false)) tell_of_entry(path, found);
  switch (found.kind) {
    case CornerKind::straight:
      release_queue();
      compensation.begin = tool;
      return;
    case CornerKind::concave:
      end_queue_at(found.point);
      return;
    case CornerKind::convex:
      // as LinuxCNC: nothing is checked in front of an arc
      path.is_arc ? release_queue() : end_queue_at(tool);
      go_around(kind, path, found.point, end, feed);
      compensation.begin = found.point;
      return;
  }
}

// Fanuc's offset vector stands on the path (B-63782EN/01 p. 175): at its first point the tool is
// beside the first move of the contour, here beside the entry, unless both go the same way.
void Interpreter::Machine::tell_of_entry(const PlaneMove& path, const Corner& found) {
  const Compensation& compensation = state_.compensation;
  const bool is_silent = setup_.reader == Reader::linuxcnc || text().is_generated() ||
                         compensation.queue.empty() || !compensation.acts();
  if (is_silent || found.kind == CornerKind::straight) return;
  const Eigen::Vector2d here =
      found.kind == CornerKind::concave ? found.point : state_.in_plane(state_.position);
  const double distance = (point_beside_begin(compensation.cutter, path) - here).norm();
  constexpr double kSame = 1e-6;  // m
  constexpr std::string_view kText = "the entry of cutter compensation follows LinuxCNC";
  if (distance < kSame || !noted_.insert(std::string(kText)).second) return;
  warn(request().motion.column,
       fmt::format(
           "{}: the tool ends line {} {:.4f} mm away from its end point on Fanuc and Haas, which "
           "is normal to the start of the next move (or within two moves: parameter 5003, setting "
           "43); an entry followed by a move in the same direction is identical on all",
           kText, compensation.queue.front().move.line, distance / mm));
}

// Around a convex corner, which is of no length in the program. Rotary axes turn here, the axis
// along the normal of the plane moves with the move behind.
void Interpreter::Machine::go_around(MoveKind kind, const PlaneMove& path,
                                     const Eigen::Vector2d& point, const AxisWords& end,
                                     double feed) {
  const bool is_rapid = kind == MoveKind::rapid;  // there are no arcs at rapid
  AxisWords corner_end = end;
  corner_end.head<3>() = state_.with_plane(state_.position, point).head<3>();
  move_to(is_rapid ? kind : MoveKind::arc, corner_end, 0.0, feed);
  if (is_rapid) return;
  AxisWords centre = state_.with_plane(AxisWords::Zero(), path.begin);
  centre[state_.normal_axis] = corner_end[state_.normal_axis];
  describe_arc(out_.back(), centre, state_.compensation.cutter.is_left ? -1 : 1);
}

// The code of this block that ends what waits.
int Interpreter::Machine::column_of_cause() const {
  if (request().motion.code != nullptr) return request().motion.column;
  const Request::Chosen& off = request().of(Group::g_cutter_compensation);
  return off.code != nullptr ? off.column : request().of(Group::m_stop).column;
}

// Ends what waits at a point of the plane, and gives it out.
void Interpreter::Machine::end_queue_at(const Eigen::Vector2d& point) {
  Compensation& compensation = state_.compensation;
  if (compensation.queue.empty()) return;
  const EndTolerance& tolerance = state_.unit == mm ? kEndToleranceMm : kEndToleranceInch;
  for (Compensation::Waiting& waiting : compensation.queue) {
    if (is_motion(waiting.move.kind)) {
      const std::string fault = move_end(waiting.path, compensation.begin, point, tolerance);
      if (!fault.empty()) {
        fail(column_of_cause(), fmt::format("{} (move of line {})", fault, waiting.move.line));
      }
    }
    waiting.move.end = state_.with_plane(waiting.move.end, point);
  }
  release_queue();
  compensation.begin = point;
}

void Interpreter::Machine::release_queue() {
  Compensation& compensation = state_.compensation;
  compensation.begin.reset();
  if (compensation.queue.empty()) return;
  compensation.last_front = compensation.queue.front().path;
  for (Compensation::Waiting& waiting : compensation.queue) {
    waiting.move.end_machine = state_.to_machine(waiting.move.end);
    out_.push_back(std::move(waiting.move));
  }
  compensation.queue.clear();
}

}  // namespace servomill::controllers
