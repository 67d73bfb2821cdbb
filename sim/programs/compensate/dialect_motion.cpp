// Moves of a corrected program in the words of another control.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "controllers/gcode/canned_cycles.h"
#include "controllers/gcode/modal_state.h"
#include "controllers/gcode/request.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/programs/compensate/dialect_writer.h"

namespace servomill::sim::programs {

using controllers::Group;

namespace {

constexpr double kShortestShare = 1e-4;   // of a move, for the time of blocks that lead to it
constexpr double kMinSweep = 1e-3 * deg;  // of an arc, and of what it lacks of a full circle
constexpr double kSamePlace = 1e-9;       // m: the same digits
constexpr double kStill = 1e-12;          // m, rad: the same number
constexpr double kMaxRadiusError = 5e-6;  // m, between begin and end of an arc
constexpr double kMaxTurnOff = 0.25 * std::numbers::pi;  // rad: farther off, an arc goes round

}  // namespace

// G28 and G30 go to places that LinuxCNC has stored: on another control only "up" is meant.
void DialectWriter::write_reference(const Move& move, const Block& block, bool is_last) {
  const controllers::Request& request = *block.request;
  const bool is_G28 = request.code(Group::g_non_modal) == 280;
  for (const Axis axis : kAllAxes) {
    if (axis != Axis::Z && !request.has(letter(axis))) continue;
    if (axis == Axis::Z && request.has('Z')) continue;
    throw Unsayable{
        fmt::format("{} of axes other than Z moves to positions stored in LinuxCNC; program G53 G0 "
                    "X... Y... with the positions of this machine",
                    is_G28 ? "G28" : "G30")};
  }
  if (block.state->is_incremental && request['Z'] != 0.0) {
    throw Unsayable{"returns to the reference point with an incremental move; program Z0 with G91"};
  }
  if (!is_last) {
    if (block.state->is_incremental) return;
    restate_axes(move, block);
    return write_step(block, corrector_.next(move, block, false));
  }
  restate_spindle_and_coolant();
  printer_->end_smoothing();
  bool is_at_reference = false;
  if (is_G28) {
    is_at_reference = printer_->reference_Z();
  } else {
    printer_->retract();
    printer_->assume(
        fmt::format("machine Z{:g} replaces the second reference position (G30) of the original",
                    settings_.retract_Z / mm));
  }
  height_.reset();
  has_optional_height_ = false;
  is_optional_[static_cast<std::size_t>(index_of(Axis::Z))] = writes_optional_;
  if (!is_at_reference) height_ = settings_.retract_Z;
  out_known_[static_cast<std::size_t>(index_of(Axis::Z))] = false;
  corrector_.arrive_elsewhere(move);
}

void DialectWriter::write_path_mode(const Block& block, const Move& move) {
  const std::string path =
      fmt::format("{} {}", static_cast<int>(move.path_mode), move.path_tolerance);
  // a canned cycle follows its path exactly, whatever is in force
  const bool is_of_cycle =
      block.request != nullptr && controllers::is_canned_cycle(block.request->motion_code());
  const bool is_exact = says_path_ && !is_of_cycle && move.path_mode != PathMode::continuous;
  if (is_exact) printer_->end_smoothing();
  if (path != path_ && says_path_ && !is_of_cycle) {
    // the tolerance of smoothing takes the place of G64's
    const double tolerance = settings_.smoothing > 0.0 ? 0.0 : move.path_tolerance;
    printer_->path_mode(move.path_mode, tolerance);
    path_ = path;
  }
  if (!is_exact && move.kind != MoveKind::rapid) printer_->begin_smoothing();
}

DialectMotion DialectWriter::motion_of(const Block& block, const Step& step) const {
  const Move& move = *step.move;
  DialectMotion motion;
  motion.is_rapid = move.kind == MoveKind::rapid;
  motion.is_place = step.is_place;
  motion.work_system = move.work_offset;
  motion.length = move.tool_offset;
  motion.tool = tool_;
  motion.is_Z_known = out_known_[static_cast<std::size_t>(index_of(Axis::Z))];
  AxisWords across = block.state->tool_offset;
  across[index_of(Axis::Z)] = 0.0;
  if (!motion.is_place && !across.isZero(0.0)) {
    throw Unsayable{
        fmt::format("moves with offsets of tool {0} in axes other than Z; remove X, Y, ... of tool "
                    "{0} from the tool table",
                    move.tool_offset)};
  }
  return motion;
}

void DialectWriter::set_feed(DialectMotion& motion, const Step& step,
                             const FittedBlock& fitted) const {
  const Move& move = *step.move;
  motion.feed_mode = FeedMode::units_per_minute;
  if (motion.is_rapid) return;
  const double turned = step.programmed.turns_axes()
                            ? (step.programmed.end - step.programmed.begin).tail<3>().norm()
                            : 0.0;
  const double length = step.programmed.length();
  const auto is_of_linear = [](const auto& word) { return is_linear(word.first); };
  const bool has_linear = std::any_of(motion.words.begin(), motion.words.end(), is_of_linear);
  const bool has_rotary = !std::all_of(motion.words.begin(), motion.words.end(), is_of_linear);
  const bool by_time = turned > 0.0 && (has_linear || move.feed_mode == FeedMode::inverse_time);
  // rotary axes that carry the correction of a straight move have no feed of their own
  if (by_time || (has_linear && has_rotary && length > 0.0)) {
    if (move.feed_mode == FeedMode::units_per_revolution) {
      throw Unsayable{"feeds rotary axes per revolution of the spindle (G95); use G94 or G93"};
    }
    const double share = std::max(fitted.t_end - fitted.t_begin, kShortestShare);
    motion.feed_mode = FeedMode::inverse_time;
    motion.feed = move.feed * minute / ((length > 0.0 ? length : turned) * share);
    return;
  }
  const Axis axis = length > 0.0 ? Axis::X : Axis::C;
  if (move.feed_mode == FeedMode::units_per_revolution) {
    motion.feed_mode = move.feed_mode;
    motion.feed = move.value / printer_->unit(axis);
  } else {
    motion.feed = move.feed * minute / printer_->unit(axis);
  }
}

// As the control reads it.
AxisWords DialectWriter::on_grid(const AxisWords& target) const {
  AxisWords out = target;
  for (const Axis axis : kAllAxes) {
    const int i = index_of(axis);
    const double grid = std::pow(10.0, -printer_->decimals(axis)), unit = printer_->unit(axis);
    out[i] = std::round(target[i] / unit / grid) * grid * unit;
  }
  return out;
}

// Places of the machine have to be there to the digit.
void DialectWriter::check_place(const Step& step, const AxisWords& on_grid) const {
  constexpr double kExact = 1e-12;  // m, rad
  for (const Axis axis : kAllAxes) {
    const int i = index_of(axis);
    const double target = step.move->end_machine[i];
    if (!step.is_commanded[static_cast<std::size_t>(i)] || std::abs(on_grid[i] - target) < kExact) {
      continue;
    }
    throw Unsayable{
        fmt::format("moves to {}{:.7g} in machine coordinates, which has more digits than the "
                    "resolution of {:g} um (--resolution)",
                    letter(axis), target / printer_->unit(axis), settings_.resolution / um)};
  }
}

// Words of the axes that change, and of all named axes without a known position. A feed brings
// back what a helix of Heidenhain's has left beside the grid; a rapid leaves it there.
DialectWriter::Words DialectWriter::words_of(const Step& step, const AxisWords& target,
                                             const AxisWords& at) const {
  Words out;
  for (const Axis axis : kAllAxes) {
    const int i = index_of(axis);
    const auto k = static_cast<std::size_t>(i);
    const double unit = printer_->unit(axis), grid = std::pow(10.0, -printer_->decimals(axis));
    const bool is_feed = step.move->kind != MoveKind::rapid;
    const double still = is_feed && !step.is_place ? kStill : 0.5 * grid * unit;
    const bool differs = std::abs(target[i] - at[i]) > still;
    const bool moves = !out_known_[k]                            ? step.is_commanded[k] || is_feed
                       : is_optional_[k] && step.is_commanded[k] ? true
                                                                 : differs;
    if (moves && corrector_.has(axis)) out.emplace_back(axis, target[i] / unit);
  }
  return out;
}

std::optional<DialectArc> DialectWriter::arc_of(const Step& step, const FittedBlock& fitted,
                                                const AxisWords& origin, const AxisWords& from,
                                                const AxisWords& to) const {
  if (std::abs(fitted.arc->turns) != 1) return std::nullopt;
  const ArcSweep& programmed = *step.programmed.arc;
  // a rotated work system takes a plane with Z out of those of two axes
  if (programmed.c != 2 && step.programmed.frame.sin != 0.0) return std::nullopt;
  AxisWords centre = AxisWords::Zero();
  centre.head<3>() = fitted.arc->centre;
  centre = step.programmed.frame.machine(centre) - origin;
  const double unit = printer_->unit(Axis::X), grid = std::pow(10.0, -printer_->decimals(Axis::X));
  const auto in_plane = [&](const AxisWords& p) {
    return Eigen::Vector2d(p[programmed.a], p[programmed.b]);
  };
  const Eigen::Vector2d begin = in_plane(from), end = in_plane(to);
  const Eigen::Vector2d d = (((in_plane(centre) - begin) / unit / grid).array().round()) * grid;
  const Eigen::Vector2d a = -d * unit, b = end - begin + a;  // from the centre
  if (std::abs(a.norm() - b.norm()) > kMaxRadiusError) return std::nullopt;
  // start = end is a full circle: the digits must not make one, nor miss one
  const double wanted = programmed.sweep * (fitted.t_end - fitted.t_begin);
  const double full = 2.0 * std::numbers::pi, sign = wanted > 0.0 ? 1.0 : -1.0;
  double sweep = sign * std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  if (sweep < 0.0) sweep += full;
  // a helix of Heidenhain's ends off the grid: a circle after it would not be closed
  const bool is_closed = (end - begin).cwiseAbs().maxCoeff() < kSamePlace;
  if (is_closed) sweep = full;
  if (!is_closed && (sweep < kMinSweep || sweep > full - kMinSweep)) return std::nullopt;
  if (std::abs(sweep - std::abs(wanted)) > kMaxTurnOff) return std::nullopt;
  DialectArc arc;
  arc.is_counter_clockwise = sign > 0.0;
  arc.from_begin[programmed.a] = d.x();
  arc.from_begin[programmed.b] = d.y();
  arc.centre = from.head<3>() / unit + arc.from_begin;
  arc.path = ArcSweep(from.head<3>() / unit, to.head<3>() / unit, arc.centre, programmed.c,
                      sign > 0.0 ? 1 : -1);
  arc.sweep = sign * sweep;
  const double round = a.norm() * sweep, rise = to[programmed.c] - from[programmed.c];
  arc.share = rise == 0.0 ? 1.0 : round / std::hypot(round, rise);
  return arc;
}

// True if every arc of the step can be written as one.
bool DialectWriter::takes_arcs(const DialectMotion& motion, const Step& step,
                               const AxisWords& origin) const {
  AxisWords at = corrector_.out() - origin;
  for (const FittedBlock& fitted : step.blocks) {
    const AxisWords target = on_grid(step.programmed.frame.machine(fitted.end) - origin);
    DialectMotion one = motion;
    one.words = words_of(step, target, at);
    if (fitted.arc) {
      one.arc = arc_of(step, fitted, origin, at, target);
      if (!one.arc || !printer_->takes_arc(one)) return false;
      name_end(one, target);
    }
    const AxisWords begin = at;
    for (const auto& [axis, value] : one.words) at[index_of(axis)] = target[index_of(axis)];
    if (!fitted.arc) continue;
    printer_->turn_by_angle(one, begin, at);
    if ((at - target).head<3>().norm() > settings_.resolution) return false;
  }
  return true;
}

// @param height  of the end, machine coordinate (m)
void DialectWriter::write_rapid(DialectMotion motion, double height) {
  const auto Z = std::find_if(motion.words.begin(), motion.words.end(),
                              [](const auto& word) { return word.first == Axis::Z; });
  if (Z == motion.words.end() || motion.words.size() == 1) return printer_->motion(motion);
  DialectMotion up = motion;
  up.words = {*Z};
  motion.words.erase(Z);
  const bool is_up = rises(height);
  printer_->motion(is_up ? up : motion);
  printer_->motion(is_up ? motion : up);
}

// Both words of the plane, so that a circle has an end, too.
void DialectWriter::name_end(DialectMotion& motion, const AxisWords& target) const {
  const bool rises = motion.rises();
  motion.words.clear();
  for (const Axis axis : {Axis::X, Axis::Y, Axis::Z}) {
    if (index_of(axis) == motion.arc->path.c && !rises) continue;
    motion.words.emplace_back(axis, target[index_of(axis)] / printer_->unit(axis));
  }
}

void DialectWriter::write_step(const Block& block, const Step& given) {
  restate_spindle_and_coolant();
  DialectMotion motion = motion_of(block, given);
  AxisWords origin = AxisWords::Zero();  // of work coordinates without rotation and shift
  if (!motion.is_place) {
    // what the program has made of the offset is in the numbers
    origin = settings_.work_offset[static_cast<std::size_t>(motion.work_system - 1)] +
             block.state->tool_offset;
  }
  if (motion.is_place) printer_->end_smoothing();
  if (!motion.is_place) write_path_mode(block, *given.move);
  const bool keeps_arcs = takes_arcs(motion, given, origin);
  if (!keeps_arcs && given.programmed.arc && given.programmed.arc->c != 2) ++arcs_to_lines_;
  const Step step = keeps_arcs ? given : corrector_.without_arcs(given);
  AxisWords at = corrector_.out() - origin;
  for (const FittedBlock& fitted : step.blocks) {
    const AxisWords target = on_grid(step.programmed.frame.machine(fitted.end) - origin);
    motion.words = words_of(step, target, at);
    motion.arc.reset();
    if (fitted.arc) {
      motion.arc = arc_of(step, fitted, origin, at, target);
      name_end(motion, target);
    }
    if (motion.is_place) check_place(step, target);
    if (motion.words.empty()) continue;
    set_feed(motion, step, fitted);
    if (motion.is_rapid) {
      write_rapid(motion, target[index_of(Axis::Z)] + origin[index_of(Axis::Z)]);
    } else {
      printer_->motion(motion);
    }
    const AxisWords begin = at;
    for (const auto& [axis, value] : motion.words) {
      at[index_of(axis)] = target[index_of(axis)];
      const auto k = static_cast<std::size_t>(index_of(axis));
      find_axis(k);
      is_optional_[k] = writes_optional_;
      system_[k] = motion.is_place ? 0 : motion.work_system;
      if (axis == Axis::Z) has_optional_height_ = false;
      if (axis == Axis::Z) height_ = target[index_of(Axis::Z)] + origin[index_of(Axis::Z)];
    }
    if (motion.arc) printer_->turn_by_angle(motion, begin, at);
  }
  corrector_.arrive(step, at + origin);
}

}  // namespace servomill::sim::programs
