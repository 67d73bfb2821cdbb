// G5, G5.1, G5.2 and G5.3: Bezier curves and NURBS.
// Source: LinuxCNC 2.9, G-code reference, and what its stand-alone interpreter does.
#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "controllers/gcode/interpreter_machine.h"
#include "plant/vocabulary/spline_curve.h"

namespace servomill::controllers {
namespace {

using Eigen::Vector2d;

constexpr int kCubicCode = 50;
constexpr int kMinOrder = 3;  // LinuxCNC counts a smaller L as 3

}  // namespace

void Interpreter::Machine::require_spline_modes(const Request::Chosen& chosen) const {
  const std::string name = code_name('G', chosen.code->tenths);
  const auto refuse = [&](std::string_view why) {
    fail(chosen.column, fmt::format("{} {}", name, why));
  };
  if (state_.compensation.is_on)
    refuse("is not allowed with cutter compensation active; program G40 first");
  if (state_.plane) refuse("is not allowed in a tilted work plane; program G69 first");
  if (state_.controls_tip()) refuse("is not allowed under TCP control; program G49 first");
  if (state_.normal_axis != 2 || state_.is_uvw_plane) {
    refuse("requires G17; splines are in the XY plane");
  }
  for (const Axis axis : kAllAxes) {
    const bool is_in_plane = axis == Axis::X || axis == Axis::Y;
    if (is_in_plane || !has_axis(index_of(axis))) continue;
    fail_at(letter(axis), fmt::format("{} word is not allowed with {}; a spline moves X and Y only",
                                      letter(axis), name));
  }
}

// The control points that have been read would be lost.
void Interpreter::Machine::refuse_inside_nurbs(int column, std::string_view name) const {
  if (state_.nurbs.points.empty()) return;
  fail(column,
       fmt::format("{} is not allowed between G5.2 and G5.3; program only control points", name));
}

// G5: from the start towards I and J, to the end from P and Q; G5.1: by way of I and J. Neither is
// modal: the motion code that was in force stays. Numbers of P and Q are kept for the next G5,
// where those of G87 are, and not converted when the unit changes.
void Interpreter::Machine::bezier() {
  const Request::Chosen& chosen = request().motion;
  const std::string name = code_name('G', chosen.code->tenths);
  require_spline_modes(chosen);
  require_feed(chosen);
  if (!has_axis(0) && !has_axis(1) && !request().has_polar()) {
    fail(chosen.column, fmt::format("{} requires X or Y", name));
  }
  const bool is_cubic = chosen.code->tenths == kCubicCode;
  const bool has_begin = request().has('I') && request().has('J');
  const bool goes_on = is_cubic && !request().has('I') && !request().has('J');
  if (!has_begin && !goes_on) {
    fail(chosen.column,
         fmt::format("{} requires both I and J{}", name,
                     is_cubic ? ", or neither to continue from the previous G5" : ""));
  }
  const Vector2d begin = state_.position.head<2>();
  if (goes_on && begin != state_.spline_end) {
    warn(chosen.column, fmt::format("G5 without I and J, and no G5 ends here: read as I{:g} J{:g}, "
                                    "stored by LinuxCNC from the last G5 or G87",
                                    state_.cycle.i, state_.cycle.j));
  }
  const AxisWords end = programmed_end();
  const Vector2d first =
      goes_on ? Vector2d(state_.cycle.i, state_.cycle.j) : Vector2d(request()['I'], request()['J']);
  OpenNurbs curve;
  curve.points = {begin, begin + first * state_.unit};
  if (is_cubic) {
    if (!request().has('P') || !request().has('Q')) {
      fail(chosen.column, "G5 requires both P and Q");
    }
    const Vector2d second(request()['P'], request()['Q']);
    curve.points.emplace_back(end.head<2>() + second * state_.unit);
    state_.cycle.i = -second.x();
    state_.cycle.j = -second.y();
  }
  curve.points.emplace_back(end.head<2>());
  curve.order = static_cast<int>(curve.points.size());
  curve.weights.assign(curve.points.size(), 1.0);
  spline(curve, end, chosen);
  if (is_cubic) state_.spline_end = end.head<2>();
}

// G5.2: the weight P of the start, or a control point X Y with its weight.
void Interpreter::Machine::nurbs_point() {
  const Request::Chosen& chosen = request().motion;
  OpenNurbs& curve = state_.nurbs;
  require_spline_modes(chosen);
  require_feed(chosen);
  if (state_.feed_mode == FeedMode::inverse_time) {
    fail(chosen.column,
         "G5.2 is not allowed with G93, where F is the time of one block; program G94 first");
  }
  if (request().has_polar()) fail(chosen.column, "G5.2 is not allowed with polar coordinates");
  const bool has_point = has_axis(0);
  if (has_axis(0) != has_axis(1)) fail(chosen.column, "G5.2 requires both X and Y");
  const bool is_first = curve.points.empty();
  if (!is_first && !has_point) {
    fail(chosen.column,
         "G5.2 requires X and Y; only the first may define just the weight of the start point");
  }
  if (has_point && !request().has('P')) {
    fail(chosen.column, "G5.2 requires a weight P for each control point");
  }
  if (request().has('P') && !(request()['P'] > 0.0)) {
    fail_at('P', fmt::format("P{}; the weight must be > 0", request()['P']));
  }
  if (is_first) {
    curve.position = state_.position;
    curve.zero = state_.zero();
    curve.unit = state_.unit;
    curve.points = {state_.position.head<2>()};
    curve.weights = {has_point || !request().has('P') ? 1.0 : request()['P']};
  }
  if (request().has('L')) {
    const int L = integer('L');
    if (L < 0) fail_at('L', fmt::format("L{}; must be >= 0", L));
    if (L < kMinOrder) {
      warn(request().word('L').column, fmt::format("G5.2 L{}: read as L3, as in LinuxCNC", L));
    }
    if (L > kMinOrder) curve.order = L;
  }
  if (!has_point) return;
  curve.points.emplace_back(programmed_end().head<2>());
  curve.weights.push_back(request()['P']);
}

void Interpreter::Machine::end_nurbs() {
  const Request::Chosen& chosen = request().of(Group::g_non_modal);
  if (request().of(Group::g_motion).code != nullptr) {
    fail(chosen.column, fmt::format("{} and G5.3 are not allowed in one block",
                                    code_name('G', request().code(Group::g_motion))));
  }
  if (has_any_axis() || request().has_polar())
    fail(chosen.column, "axis words are not allowed with G5.3");
  const OpenNurbs curve = std::exchange(state_.nurbs, OpenNurbs{});
  if (curve.points.empty()) fail(chosen.column, "G5.3 requires a preceding G5.2");
  if (static_cast<int>(curve.points.size()) < curve.order) {
    fail(chosen.column,
         fmt::format(
             "{} control points including the start; a NURBS of order L{} requires at least {}",
             curve.points.size(), curve.order, curve.order));
  }
  const bool stays = curve.position == state_.position && curve.zero.is_at(state_.zero()) &&
                     curve.unit == state_.unit;
  if (!stays) {
    fail(chosen.column,
         "the unit, work coordinates or position change between G5.2 and G5.3; program the change "
         "before G5.2");
  }
  require_spline_modes(chosen);
  require_feed(chosen);
  AxisWords end = state_.position;
  end.head<2>() = curve.points.back();
  spline(curve, end, chosen);
  state_.motion = kNoMotion;
}

void Interpreter::Machine::spline(const OpenNurbs& given, const AxisWords& end,
                                  const Request::Chosen& chosen) {
  std::vector<Eigen::Vector3d> points, in_machine;
  for (const Vector2d& p : given.points) {
    AxisWords work = state_.position;
    work.head<2>() = p;
    points.emplace_back(work.head<3>());
    in_machine.emplace_back(state_.to_machine(work).head<3>());
  }
  const SplineCurve curve(given.order, std::move(in_machine), given.weights);
  const double length = curve.length();
  const bool is_timed = state_.feed_mode == FeedMode::inverse_time;
  if (is_timed && length == 0.0)
    fail(chosen.column, "a spline of zero length is not allowed with G93");
  move_to(MoveKind::spline, end, length, is_timed ? move_feed(length, 0.0) : state_.feed_linear);
  // behind a queue of cutter compensation there is none: that is off
  out_.back().spline = std::make_shared<const Spline>(Spline{curve, std::move(points)});
}

}  // namespace servomill::controllers
