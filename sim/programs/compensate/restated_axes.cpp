// Axes that a tool change or a stop may have moved: named again before Z comes down.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "controllers/gcode/canned_cycles.h"
#include "controllers/gcode/modal_state.h"
#include "controllers/gcode/request.h"
#include "plant/vocabulary/input_error.h"
#include "sim/programs/compensate/dialect_writer.h"
#include "sim/programs/named_axes.h"

namespace servomill::sim::programs {
namespace {

constexpr double kSamePlace = 1e-9;  // m: the same digits

std::string names_of(const std::vector<Axis>& axes) {
  std::string out;
  for (const Axis axis : axes) out += fmt::format("{}{}", out.empty() ? "" : ", ", letter(axis));
  return out;
}

}  // namespace

// Lost ones that the move does not bring to a position of its own; rotary axes first.
std::vector<Axis> DialectWriter::unnamed_lost(const AxisFlags& is_lost, const Block& block) const {
  std::vector<Axis> out;
  for (const bool is_of_linear : {false, true}) {
    for (const Axis axis : kAllAxes) {
      if (axis == Axis::Z || is_linear(axis) != is_of_linear || !corrector_.has(axis)) continue;
      const bool is_given = names_axis(block, axis) && !block.state->is_incremental;
      if (is_lost[static_cast<std::size_t>(index_of(axis))] && !is_given) out.push_back(axis);
    }
  }
  return out;
}

// @throws InputError where the program has never named one of them
std::vector<Axis> DialectWriter::lost_axes(const Move& move, const Block& block) const {
  const std::vector<Axis> lost = unnamed_lost(is_lost_, block);
  std::vector<Axis> unnamed;
  std::copy_if(lost.begin(), lost.end(), std::back_inserter(unnamed),
               [&](Axis axis) { return !corrector_.programmed(axis); });
  if (unnamed.empty()) return lost;
  const std::string axes = names_of(unnamed);
  throw InputError(
      {file_, move.line},
      fmt::format("moves Z while the position of {0} is unknown: the tool change or stop may have "
                  "moved it, and no block programs it; program {0} in a rapid between it and this "
                  "line, or set the start position with --start",
                  axes));
}

// Blocks with '/' may have named these axes since they were lost, or left them out, and Z comes
// down for one position of the switch and goes up for the other.
void DialectWriter::refuse_doubtful_axes(double height, const Block& block) const {
  if (writes_optional_) return;
  const bool is_up = height_ && height > *height_ + kSamePlace;
  const bool is_up_if_skipped =
      has_optional_height_ ? skipped_height_ && height > *skipped_height_ + kSamePlace : is_up;
  if (is_up && is_up_if_skipped) return;
  AxisFlags doubtful{};
  for (std::size_t i = 0; i < doubtful.size(); ++i) {
    const bool is_any = is_lost_[i] || skipped_lost_[i];
    doubtful[i] = is_up != is_up_if_skipped ? is_any : skipped_lost_[i] && !is_lost_[i];
  }
  const std::vector<Axis> axes = unnamed_lost(doubtful, block);
  if (axes.empty()) return;
  throw Unsayable{fmt::format(
      "moves Z after a tool change or stop that may have moved {0}, and the blocks between them "
      "depend on '/'; program {0} in a rapid without '/' between it and this line",
      names_of(axes))};
}

// A tool change or a stop leaves axes wherever macro or operator takes them: Z goes down where the
// program has them.
void DialectWriter::restate_axes(const Move& move, const Block& block) {
  const bool is_cycle =
      block.request != nullptr && controllers::is_canned_cycle(block.request->motion_code());
  const bool names_Z = block.request != nullptr && block.request->has('Z') && !is_cycle;
  const std::optional<double> before = corrector_.programmed(Axis::Z);
  const double end = move.end_machine[index_of(Axis::Z)];
  const bool changes_Z = before && std::abs(end - *before) > kSamePlace;
  if (!names_Z && !changes_Z) return;
  refuse_doubtful_axes(end, block);
  // behind a stop, out of the workpiece first
  if (height_ && end > *height_ + kSamePlace) return;
  const std::vector<Axis> lost = lost_axes(move, block);
  if (lost.empty()) return;
  restate_spindle_and_coolant();
  for (auto first = lost.begin(); first != lost.end();) {
    const auto last = std::find_if_not(first, lost.end(),
                                       [&](Axis axis) { return is_restated_with(axis, *first); });
    write_restated({first, last});
    first = last;
  }
}

// In one block: written last in the same coordinates, lost by the same stop.
bool DialectWriter::is_restated_with(Axis one, Axis other) const {
  const auto i = static_cast<std::size_t>(index_of(one)),
             k = static_cast<std::size_t>(index_of(other));
  return is_linear(one) == is_linear(other) && system_[i] == system_[k] &&
         skipped_lost_[i] == skipped_lost_[k];
}

// Axes that only a stop behind '/' has lost are brought back behind '/', too.
void DialectWriter::write_restated(const std::vector<Axis>& axes) {
  const bool is_lost_if_skipped = skipped_lost_[static_cast<std::size_t>(index_of(axes.front()))];
  if (writes_optional_ || is_lost_if_skipped) return write_rapid_back(axes);
  const AxisFlags known = out_known_;
  printer_->begin_optional();
  writes_optional_ = true;
  write_rapid_back(axes);
  writes_optional_ = false;
  printer_->end_optional();
  out_known_ = known;
  for (const Axis axis : axes) is_optional_[static_cast<std::size_t>(index_of(axis))] = true;
}

// @param axes  written last in the same coordinates
void DialectWriter::write_rapid_back(const std::vector<Axis>& axes) {
  const int system = system_[static_cast<std::size_t>(index_of(axes.front()))];
  DialectMotion motion;
  motion.is_rapid = true;
  motion.is_place = system == 0;
  motion.work_system = std::max(system, 1);
  motion.tool = tool_;
  AxisWords origin = AxisWords::Zero(), target = AxisWords::Zero();
  if (!motion.is_place) origin = settings_.work_offset[static_cast<std::size_t>(system - 1)];
  for (const Axis axis : axes) target[index_of(axis)] = *corrector_.programmed(axis);
  target = on_grid(target - origin);
  for (const Axis axis : axes) {
    const int i = index_of(axis);
    motion.words.emplace_back(axis, target[i] / printer_->unit(axis));
    corrector_.restate(axis, target[i] + origin[i]);
    find_axis(static_cast<std::size_t>(i));
  }
  printer_->motion(motion);
}

}  // namespace servomill::sim::programs
