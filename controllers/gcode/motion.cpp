// G0, G1, G2, G3 and what becomes of them: moves.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <utility>

#include "controllers/gcode/interpreter_machine.h"
#include "controllers/gcode/message_text.h"
#include "plant/vocabulary/arc_sweep.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr double kSpiralLimit = 0.5 * mm, kSpiralShare = 0.05;  // between the radii of an arc
constexpr double kTurnsTol = 1e-3;                              // as LinuxCNC, for P of an arc
constexpr int kNurbsPoint = 52, kNurbsEnd = 53;                 // G5.2 G5.3

constexpr bool is_bezier(int code) { return code == 50 || code == 51; }

}  // namespace

void Interpreter::Machine::motion() {
  if (request().code(Group::g_non_modal) == kNurbsEnd) return end_nurbs();
  const int motion_before = state_.motion;
  const int explicit_code = request().code(Group::g_motion);
  if (explicit_code >= 0 && !is_bezier(explicit_code)) state_.motion = explicit_code;
  const int code = request().motion_code();
  const bool is_inside_nurbs = !state_.nurbs.points.empty();
  if (is_inside_nurbs && std::max(code, explicit_code) >= 0 && code != kNurbsPoint) {
    refuse_inside_nurbs(request().of(Group::g_motion).column,
                        code_name('G', std::max(code, explicit_code)));
  }
  if (std::max(code, explicit_code) >= 0 && !is_canned_cycle(code)) state_.cycle.has_level = false;
  if (request().code(Group::g_non_modal) == 530) {
    const int column = request().of(Group::g_non_modal).column;
    if (code != 0 && code != 10) fail(column, "G53 requires G0 or G1");
    if (state_.is_incremental) fail(column, "G53 with G91; machine coordinates are absolute");
  }
  if (code >= 0 && state_.controls_tip()) refuse_rotary_words();
  if (code >= 0) note_unit_of_control();
  move_as(code, motion_before);
}

void Interpreter::Machine::move_as(int code, int motion_before) {
  if (code == 0 || code == 10) straight();
  if (code == 20 || code == 30) arc();
  if (is_bezier(code)) bezier();
  if (code == kNurbsPoint) nurbs_point();
  if (code == 330 || code == 331) synchronised();
  if (code >= 382 && code <= 385) probe();
  if (is_canned_cycle(code)) canned_cycle(motion_before);
}

AxisWords Interpreter::Machine::programmed_end() const {
  if (request().code(Group::g_non_modal) == 530) {
    if (request().has_polar()) {
      fail(request().of(Group::g_non_modal).column, "G53 is not allowed with polar coordinates");
    }
    return machine_end();
  }
  AxisWords end = state_.programmed();
  if (request().has_polar()) end.head<2>() = polar_end(end.head<2>());
  for (int i = 0; i < kAxisWords; ++i) {
    if (has_axis(i)) end[i] = axis_word(i) + (state_.is_incremental ? end[i] : 0.0);
  }
  return end;
}

// Distance @ and direction ^ from the origin; what is left out stays.
Eigen::Vector2d Interpreter::Machine::polar_end(const Eigen::Vector2d& begin) const {
  const char first = request().has('@') ? '@' : '^';
  if (state_.normal_axis != 2 || state_.is_uvw_plane) {
    fail_at(first, "polar coordinates require G17");
  }
  for (const char word : {'X', 'Y'}) {
    if (request().has(word))
      fail_at(word, fmt::format("{} word is not allowed with polar coordinates", word));
  }
  const double kept = state_.is_incremental ? 1.0 : 0.0;
  double radius = begin.norm();
  double angle = std::atan2(begin.y(), begin.x());
  if (request().has('@')) radius = kept * radius + request()['@'] * state_.unit;
  if (request().has('^')) angle = kept * angle + request()['^'] * deg;
  return radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
}

// X and Y turn together, so a G53 with one of them keeps the other in machine coordinates.
AxisWords Interpreter::Machine::machine_end() const {
  AxisWords target = state_.to_account(state_.position);
  for (int i = 0; i < kAxisWords; ++i) {
    if (has_axis(i)) target[i] = axis_word(i);
  }
  AxisWords end = state_.target_to_work(target);
  for (int i = kLinearJoints; i < kAxisWords; ++i) {
    if (!has_axis(i)) end[i] = state_.position[i];
  }
  return end;
}

std::string Interpreter::Machine::zero_feed(const std::string& code) const {
  return fmt::format("{} with zero feed rate; {}", code,
                     noted_.contains("F0") ? "F0 is active, F must be > 0" : "no F is active");
}

void Interpreter::Machine::require_feed(const Request::Chosen& chosen) const {
  const auto name = [&] { return code_name('G', chosen.code->tenths); };
  if (state_.feed_mode == FeedMode::inverse_time) {
    if (!request().has('F')) {
      fail(chosen.column, fmt::format("{} without F; G93 requires F in every block", name()));
    }
  } else if (state_.feed_linear == 0.0) {
    fail(chosen.column, zero_feed(name()));
  } else if (state_.feed_mode == FeedMode::units_per_revolution && state_.spindle_speed == 0.0) {
    fail(chosen.column,
         fmt::format("{} under G95 with zero spindle speed; no S is active", name()));
  }
}

// @param length  of the XYZ path, m
// @param angle   of a rotation, rad
double Interpreter::Machine::move_feed(double length, double angle) const {
  const bool is_linear_move = state_.controls_tip()
                                  ? length > kStandingTip
                                  : state_.s + length > state_.s;  // else it moves by rounding only
  if (state_.feed_mode != FeedMode::inverse_time) {
    return is_linear_move ? state_.feed_linear : state_.feed_rotary;
  }
  const double rate = request()['F'] / minute;
  if (is_linear_move) return std::max(rate * length, kSlowestInverse * state_.unit / minute);
  return std::max(rate * angle, kSlowestInverse * deg / minute);
}

// grbl begins with G21, LinuxCNC with the unit of its machine, here millimetres.
void Interpreter::Machine::note_unit_of_control() {
  const Reader reader = setup_.reader;
  if (reader == Reader::linuxcnc || reader == Reader::grbl || is_of_other_language()) return;
  for (int i = 0; i < kLinearJoints; ++i) {
    if (!has_axis(i) || axis_word(i) == 0.0) continue;
    if (!noted_.insert("unit").second) return;
    return warn(request().word(letter(axis_at(i))).column,
                "a length before G20 or G21: read in millimetres; controls use the unit set last; "
                "program G20 or G21");
  }
}

// B359 and then B1: forward by 2 degrees where the axis rolls over.
void Interpreter::Machine::note_of_long_turn(const AxisWords& begin, const AxisWords& end) {
  const bool is_of_other = setup_.reader != Reader::linuxcnc && setup_.reader != Reader::heidenhain;
  if (state_.is_incremental || !is_of_other) return;
  constexpr double kHalf = 180.0 * deg, kRounding = 1e-6 * deg;
  for (int i = kLinearJoints; i < kAxisWords; ++i) {
    const double angle = std::abs(end[i] - begin[i]);
    if (!has_axis(i) || angle < kHalf + kRounding) continue;
    const char axis = letter(axis_at(i));
    if (!noted_.insert(fmt::format("long turn of {}", axis)).second) return;
    return warn(
        request().word(axis).column,
        fmt::format(
            "{} rotates by {:.6g} degrees: read as the difference of the angles (LinuxCNC); a "
            "rollover axis (Fanuc, parameter 1008) takes the shorter direction",
            axis, angle / deg));
  }
}

void Interpreter::Machine::straight() {
  state_.compensation.refuses_arc = false;
  const bool is_rapid = request().motion_code() == 0;
  if (!is_rapid) require_feed(request().motion);
  const bool enters = state_.compensation.acts() && !state_.compensation.is_entered;
  const bool stands = !has_any_axis() && !request().has_polar() && !has_vector();
  if (stands && !enters && (state_.controls_tip() || state_.compensation.acts())) return;
  if (!is_rapid) warn_of_leaning_tool();
  const AxisWords begin = state_.programmed();
  AxisWords end = programmed_end();
  note_height();
  note_of_long_turn(begin, end);
  const double length = (end - begin).head<3>().norm();
  double angle = (end - begin).tail<3>().norm();
  const bool has_tool_axis = state_.tool_control == ToolControl::tool_axis;
  if (has_tool_axis) {
    const Eigen::Vector3d k = programmed_axis();
    angle = turn_towards(k, end);
    state_.tool_axis = k;
  }
  const MoveKind kind = is_rapid ? MoveKind::rapid : MoveKind::feed;
  const double feed = is_rapid ? 0.0 : move_feed(length, angle);
  if (state_.compensation.acts()) {
    return compensate(kind, {state_.in_plane(begin), state_.in_plane(end)}, end, length, feed);
  }
  move_to(kind, end, length, feed);
  if (has_tool_axis) out_.back().tool_axis = state_.tool_axis;
}

int Interpreter::Machine::arc_turns(bool clockwise) const {
  int turns = 1;
  if (request().has('P')) {
    turns = integer('P', kTurnsTol);
    if (turns < 1) fail_at('P', fmt::format("P{}; an arc has at least 1 turn", turns));
  }
  return clockwise ? -turns : turns;
}

ArcCentre Interpreter::Machine::arc_centre(const Eigen::Vector2d& start, const Eigen::Vector2d& end,
                                           bool clockwise) {
  const Request::Chosen& chosen = request().motion;
  const auto name = [&] { return code_name('G', chosen.code->tenths); };
  const int n = state_.normal_axis;
  const int first = (n + 1) % 3, second = (n + 2) % 3;
  const ArcTolerance& tolerance = state_.unit == mm ? kArcToleranceMm : kArcToleranceInch;
  const char letters[] = {"IJK"[first], "IJK"[second]};
  const char normal = "IJK"[n];
  const bool has_centre = request().has(letters[0]) || request().has(letters[1]);
  if (request().has('R')) {
    for (const char c : {'I', 'J', 'K'}) {
      if (request().has(c)) fail_at(c, fmt::format("{} and R in one {} block", c, name()));
    }
    if (!has_axis(first) && !has_axis(second) && !request().has_polar()) {
      fail(chosen.column,
           fmt::format("{} with R requires {} or {}", name(), "XYZ"[first], "XYZ"[second]));
    }
    return radius_format(start, end, request()['R'] * state_.unit, clockwise, tolerance);
  }
  if (request().has(normal)) {
    fail_at(normal,
            fmt::format("{} in an arc of the {}{} plane", normal, "XYZ"[first], "XYZ"[second]));
  }
  if (!has_centre) {
    fail(chosen.column, fmt::format("{} requires R, {} or {}", name(), letters[0], letters[1]));
  }
  Eigen::Vector2d centre(request()[letters[0]] * state_.unit, request()[letters[1]] * state_.unit);
  if (!state_.is_centre_absolute) return checked_centre(start, end, start + centre, tolerance);
  for (const char c : letters) {
    if (!request().has(c)) {
      fail(chosen.column,
           fmt::format("{} requires {}: with G90.1 the centre is absolute", name(), c));
    }
  }
  return checked_centre(start, end, centre, tolerance);
}

// Controls differ in how far the radii of an arc may be apart: the spiral between them is read as
// long as no reading of it can be farther from another than that.
ArcCentre Interpreter::Machine::checked_centre(const Eigen::Vector2d& start,
                                               const Eigen::Vector2d& end,
                                               const Eigen::Vector2d& centre,
                                               const ArcTolerance& tolerance) {
  ArcCentre found = centre_format(start, end, centre, tolerance);
  if (found.fault.empty() || setup_.reader == Reader::linuxcnc) return found;
  const double r_start = (start - centre).norm(), r_end = (end - centre).norm();
  const double difference = std::abs(r_start - r_end);
  const double least = std::min(r_start, r_end);
  const bool is_near =
      least > tolerance.radius && difference <= kSpiralLimit && difference <= kSpiralShare * least;
  if (!is_near) {
    // the other kind of I and J may be meant
    const double sign = state_.is_centre_absolute ? 1.0 : -1.0;
    if (centre_format(start, end, centre + sign * start, tolerance).fault.empty()) {
      found.fault += state_.is_centre_absolute
                         ? "; as distances from the start (G91.1) I, J and K fit"
                         : "; as absolute centre (G90.1) I, J and K fit: if intended, program "
                           "G90.1 at the start";
    } else if (!state_.is_centre_absolute &&
               centre_format(start, end, 2.0 * start - centre, tolerance).fault.empty()) {
      found.fault +=
          "; with opposite signs I, J and K fit: the post-processor outputs the vector from the "
          "centre to the start, but must output that from the start to the centre";
    }
    return found;
  }
  const std::string detail = fmt::format("; here by {:.4f} mm", difference / mm);
  if (tolerates(ReaderRule::arc_radii, request().motion.column, detail)) found.fault.clear();
  return found;
}

void Interpreter::Machine::arc() {
  require_feed(request().motion);
  if (state_.compensation.refuses_arc) {
    fail(request().motion.column, fmt::format("{} is the first move after G40; must be G0 or G1",
                                              code_name('G', request().motion_code())));
  }
  if (state_.tool_control == ToolControl::tool_axis) {
    fail(request().motion.column,
         fmt::format(
             "{} is not supported with G43.5, where I J K are the tool axis; use G1 or G43.4",
             code_name('G', request().motion_code())));
  }
  if (state_.is_uvw_plane) {
    fail(request().motion.column,
         fmt::format("{} is not supported in a plane of U, V and W (G17.1 G18.1 G19.1)",
                     code_name('G', request().motion_code())));
  }
  const bool clockwise = request().motion_code() == 20;
  const int turns = arc_turns(clockwise);
  const int n = state_.normal_axis;
  const AxisWords begin = state_.programmed();
  const AxisWords end = programmed_end();
  note_height();
  const Eigen::Vector2d a = state_.in_plane(begin), b = state_.in_plane(end);
  const ArcCentre found = arc_centre(a, b, clockwise);
  if (!found.fault.empty()) {
    fail(request().motion.column,
         fmt::format("{}: {}", code_name('G', request().motion_code()), found.fault));
  }
  AxisWords centre = state_.with_plane(AxisWords::Zero(), found.centre);
  centre[n] = end[n];
  const ArcSweep sweep(begin.head<3>(), end.head<3>(), centre.head<3>(), n, turns);
  const double length = sweep.length();
  const double angle = (end - begin).tail<3>().norm();
  warn_of_leaning_tool();
  // as LinuxCNC: the length that G93 speaks of is that of a circle with the radius at the start
  const double nominal = std::hypot(sweep.r_begin * sweep.sweep, end[n] - begin[n]);
  const double feed = move_feed(nominal, angle);
  if (state_.compensation.acts()) {
    return compensate(MoveKind::arc, {a, b, true, found.centre, turns}, end, length, feed);
  }
  move_to(MoveKind::arc, end, length, feed);
  describe_arc(out_.back(), centre, turns);
}

// ----------------------------------------------------------------------------------------- output

// While moves wait for the next one, everything but messages waits behind them.
Move& Interpreter::Machine::emit(MoveKind kind) {
  std::vector<Compensation::Waiting>& queue = state_.compensation.queue;
  const bool waits = !queue.empty() && kind != MoveKind::message;
  Move& move = waits ? queue.emplace_back().move : out_.emplace_back();
  describe(move, kind);
  // a message comes before what waits
  if (!waits && !queue.empty()) move.s_begin = move.s_end = queue.front().move.s_begin;
  return move;
}

void Interpreter::Machine::describe(Move& move, MoveKind kind) const {
  move.kind = kind;
  move.line = line();
  move.end = state_.position;
  move.end_machine = state_.to_machine(state_.position);
  move.path_mode = state_.path_mode;
  move.path_tolerance = state_.path_tolerance;
  move.feed_mode = state_.feed_mode;
  move.work_offset = state_.work_system;
  move.is_shifted = !state_.zero().is_at(zero_at_start_);
  move.tool_offset = state_.tool_offset_number;
  move.s_begin = move.s_end = state_.s;
  move.tool_control = state_.tool_control;
  if (state_.plane && move.tool_control == ToolControl::none) {
    move.tool_control = ToolControl::work_plane;
  }
  // neither is a number that anything may be computed from
  if (state_.is_height_unknown) move.end[2] = kUnknownValue;
  if (state_.is_height_unknown || state_.is_length_unknown) move.end_machine[2] = kUnknownValue;
}

void Interpreter::Machine::describe_arc(Move& move, const AxisWords& centre, int turns) const {
  move.arc = {state_.normal_axis, centre.head<3>(), turns};
  if (state_.plane) move.plane = std::make_shared<const WorkPlane>(state_.plane_in_workpiece());
  move.centre_machine = state_.to_machine(centre).head<3>();
  if (std::isnan(move.end_machine[2])) move.centre_machine.z() = kUnknownValue;
}

void Interpreter::Machine::move_to(MoveKind kind, const AxisWords& end, double length,
                                   double feed) {
  const double s_begin = state_.s;
  state_.s += length;
  state_.compensation.left_at.reset();
  state_.position = end;
  Move& move = emit(kind);
  set_feed(move, feed);
  if (move.feed_mode == FeedMode::inverse_time && kind != MoveKind::rapid) {
    const bool is_rotary = !(s_begin + length > s_begin);  // #<_feed> is what it came to
    state_.feed_linear = is_rotary ? feed / deg * state_.unit : feed;
  }
  move.s_begin = s_begin;
}

void Interpreter::Machine::set_feed(Move& move, double feed) const {
  move.feed = feed;
  if (move.feed_mode != FeedMode::units_per_revolution || move.kind == MoveKind::rapid) return;
  const bool turns = state_.spindle_direction != 0;
  move.value = feed;
  move.feed = turns ? feed * state_.spindle_speed / (2.0 * std::numbers::pi) : 0.0;
}

}  // namespace servomill::controllers
