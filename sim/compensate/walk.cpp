#include "sim/compensate/walk.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "controllers/gcode/modal_state.h"
#include "controllers/gcode/request.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::sim {
namespace {

using controllers::ExecutedBlock;
using controllers::Group;

// By how much of the tolerance the output may stand beside the corrected begin of a move.
constexpr double kBeside = 0.25;
constexpr double kLookForLeftover = 5e-3;  // m, between two looks, about
constexpr double kStill = 1e-12;           // m, rad: what rounding leaves of positions

bool is_named(const ExecutedBlock& block, int i) {
  return block.request != nullptr &&
         block.request->has(letter(kAllAxes[static_cast<std::size_t>(i)]));
}

bool names_any(const ExecutedBlock& block) {
  for (int i = 0; i < kAxisWords; ++i) {
    if (is_named(block, i)) return true;
  }
  return false;
}

int non_modal(const ExecutedBlock& block) {
  return block.request == nullptr ? -1 : block.request->code(Group::g_non_modal);
}

bool is_worse(const strategies::Leftover& a, const strategies::Leftover& b) {
  constexpr double kAxis = 1e-6;  // rad: of less nothing is said
  const bool by_axis = std::max(a.axis, b.axis) > kAxis;
  return by_axis ? a.axis > b.axis : a.tip > b.tip;
}

}  // namespace

bool is_skipped(const controllers::ExecutedBlock& block) {
  return block.block == nullptr && !controllers::is_blank(block.text);
}

bool is_place_of_machine(const ExecutedBlock& block) {
  const int code = non_modal(block);
  return code == 530 || code == 280 || code == 300;
}

Walk::Walk(const WalkOptions& options, const controllers::ToolTable& tools, Correction& correction,
           Summary& summary, PathRecord* record)
    : options_(options),
      tools_(tools),
      correction_(correction),
      summary_(summary),
      record_(record),
      programmed_(options.start),
      out_(options.start),
      known_(options.is_start_known) {
  // the other control retracts first
  if (options.is_for_other_control) known_[static_cast<std::size_t>(index_of(Axis::Z))] = false;
  know_missing_axes();
}

void Walk::know_missing_axes() {
  for (int i = 0; i < kAxisWords; ++i) {
    if (!correction_.layout().joint_of(kAllAxes[static_cast<std::size_t>(i)])) {
      known_[static_cast<std::size_t>(i)] = true;
    }
  }
}

void Walk::forget_positions() {
  known_.fill(false);
  know_missing_axes();
}

bool Walk::knows_all() const {
  return std::all_of(known_.begin(), known_.end(), [](bool one) { return one; });
}

// Which axes have a position that the program names. @return those of the move
AxisFlags Walk::learn(const Move& move, const ExecutedBlock& block) {
  const bool is_absolute = !block.state->is_incremental || is_place_of_machine(block);
  const bool goes_home = (non_modal(block) == 280 || non_modal(block) == 300) && !names_any(block);
  AxisFlags commanded{};
  for (int i = 0; i < kAxisWords; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const bool is_polar = i < 2 && block.request != nullptr && block.request->has_polar();
    const bool names = is_named(block, i) || is_polar;
    commanded[k] = goes_home || names || std::abs(move.end_machine[i] - programmed_[i]) > kStill;
    if (goes_home || (is_absolute && names)) known_[k] = true;
    const Axis axis = kAllAxes[k];
    if (is_named(block, i) && !correction_.layout().joint_of(axis)) {
      throw InputError({options_.file, move.line, block.request->word(letter(axis)).column},
                       fmt::format("moves {0}; the machine has no axis {0}", letter(axis)));
    }
  }
  return commanded;
}

// Blocks for another control name absolute positions in coordinates that are not turned.
void Walk::refuse_unknown_begin(const Move& move, const ExecutedBlock& block,
                                const AxisFlags& commanded) const {
  if (!options_.is_for_other_control || is_place_of_machine(block)) return;
  const bool is_turned = block.state->sin_rotation != 0.0;
  for (int i = 0; i < kAxisWords; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const bool is_mixed = is_turned && i < 2 && (commanded[0] || commanded[1]);
    if (known_[k] || !(commanded[k] || is_mixed)) continue;
    const char name = letter(kAllAxes[k]);
    throw InputError(
        {options_.file, move.line},
        is_mixed ? fmt::format("moves in a turned work system while the position of {0} is not "
                               "known; name X and Y together",
                               name)
                 : fmt::format("moves {0} by an increment from a position that nothing has named; "
                               "name {0} under G90 before",
                               name));
  }
}

void Walk::refuse(const Move& move, const AxisFlags& was_known) const {
  if (move.tool_control != ToolControl::none) {
    throw InputError({options_.file, move.line},
                     "moves under tool-centre-point control or in a tilted work plane cannot be "
                     "compensated; post the program to moves of the axes");
  }
  std::string axes;
  for (const Axis axis : kAllAxes) {
    if (move.kind == MoveKind::rapid || was_known[static_cast<std::size_t>(index_of(axis))])
      continue;
    axes += fmt::format("{}{}", axes.empty() ? "" : ", ", letter(axis));
  }
  if (axes.empty()) return;
  throw InputError(
      {options_.file, move.line},
      options_.is_for_other_control
          ? fmt::format("feeds while the position of {0} is not known: no block since the start, "
                        "the last tool change or the last stop names it; name it in a rapid",
                        axes)
          : fmt::format("feeds while the position of {0} is not known, and with it the errors: no "
                        "block before this names it; --start {1}=... says where the machine stands",
                        axes, axes.front()));
}

// The tool whose length is in force, or else that in the spindle.
void Walk::choose_tool(const controllers::ModalState& state) {
  Eigen::Vector3d p_ST = state.p_ST();
  int number = state.tool_offset_number;
  if (state.tool_offset.isZero(0.0)) {
    number = state.tool;
    const controllers::ToolEntry* tool = tools_.find(number);
    if (tool != nullptr) p_ST = -tool->offset.head<3>();
  }
  correction_.set_tool(p_ST);
  summary_.tools[number] = -p_ST.z();
}

Step Walk::next(const Move& move, const ExecutedBlock& block) {
  return next(move, block, is_place_of_machine(block));
}

Step Walk::next(const Move& move, const ExecutedBlock& block, bool is_place) {
  Step step;
  step.move = &move;
  step.was_known = known_;
  step.is_commanded = learn(move, block);
  refuse_unknown_begin(move, block, step.is_commanded);
  refuse(move, step.was_known);
  WorkFrame& frame = step.programmed.frame;
  frame.cos = block.state->cos_rotation;
  frame.sin = block.state->sin_rotation;
  frame.offset = move.end_machine - frame.turned(move.end);
  step.programmed.begin = frame.work(programmed_);
  step.programmed.end = move.end;
  if (move.kind == MoveKind::arc) {
    step.programmed.arc = ArcSweep(step.programmed.begin.head<3>(), move.end.head<3>(),
                                   move.arc.centre, move.arc.normal_axis, move.arc.turns);
  }
  step.begin = frame.work(out_);
  step.is_place = is_place;
  step.is_corrected = !is_place && knows_all();
  if (!step.is_corrected) {
    AxisWords end = out_;
    for (int i = 0; i < kAxisWords; ++i) {
      if (step.is_commanded[static_cast<std::size_t>(i)]) end[i] = move.end_machine[i];
    }
    step.blocks = {{0.0, 1.0, frame.work(end), {}}};
    return step;
  }
  choose_tool(*block.state);
  if (move.kind == MoveKind::rapid && !options_.splits_rapids) {
    step.blocks = {{0.0, 1.0, corrected(step.programmed, correction_, 1.0), {}}};
  } else {
    fit_feed(step, options_.fit);
  }
  if (move.kind == MoveKind::rapid) hold_axes(step);
  return step;
}

void Walk::fit_feed(Step& step, const FitOptions& options) const {
  step.blocks.clear();
  const AxisWords c_begin = corrected(step.programmed, correction_, 0.0);
  const AxisWords off = c_begin - step.begin;
  if (off.head<3>().norm() > kBeside * options.tolerance ||
      off.tail<3>().norm() > kBeside * options.tolerance_turn) {
    step.blocks.push_back({0.0, 0.0, c_begin, {}});
  }
  const AxisWords& from = step.blocks.empty() ? step.begin : c_begin;
  const auto fitted = fit(step.programmed, correction_, from, options);
  step.blocks.insert(step.blocks.end(), fitted.begin(), fitted.end());
}

Step Walk::without_arcs(Step step) const {
  FitOptions options = options_.fit;
  options.allow_arcs = false;
  fit_feed(step, options);
  return step;
}

// What the original leaves where it is stays.
void Walk::hold_axes(Step& step) const {
  const WorkFrame& frame = step.programmed.frame;
  AxisFlags holds{};
  for (int i = 0; i < kAxisWords; ++i) {
    const auto k = static_cast<std::size_t>(i);
    holds[k] = step.was_known[k] && std::abs(step.move->end_machine[i] - programmed_[i]) <= kStill;
  }
  const bool is_turned = frame.sin != 0.0 && holds[0] != holds[1];
  for (FittedBlock& block : step.blocks) {
    AxisWords end = is_turned ? frame.machine(block.end) : block.end;
    for (int i = 0; i < kAxisWords; ++i) {
      if (holds[static_cast<std::size_t>(i)]) end[i] = is_turned ? out_[i] : step.begin[i];
    }
    block.end = is_turned ? frame.work(end) : end;
  }
}

void Walk::look_for_leftover(const Step& step) {
  if (step.move->kind == MoveKind::rapid) return;
  const double length = step.programmed.length();
  const int looks = std::max(1, static_cast<int>(length / kLookForLeftover));
  for (int i = 1; i <= looks; ++i) {
    const AxisWords at =
        step.programmed.frame.machine(step.programmed.at(static_cast<double>(i) / looks));
    const strategies::Leftover left = correction_.leftover(at);
    if (summary_.most_left && !is_worse(left, summary_.left)) continue;
    summary_.left = left;
    summary_.most_left = Summary::At{step.move->line, at, AxisWords::Zero()};
  }
}

void Walk::warn_of_travel(const Step& step) {
  const JointLayout& layout = correction_.layout();
  for (const FittedBlock& block : step.blocks) {
    const AxisWords at = step.programmed.frame.machine(block.end);
    const Joints Q = layout.joints(at);
    bool is_outside = false;
    for (int j = 0; j < kJoints; ++j) {
      if (!layout.has(j) || !is_known(*layout.axis[static_cast<std::size_t>(j)])) continue;
      is_outside |= Q[j] < options_.lower[j] || Q[j] > options_.upper[j];
    }
    if (!is_outside) continue;
    ++summary_.outside_count;
    if (!summary_.outside) summary_.outside = Summary::At{step.move->line, at, AxisWords::Zero()};
  }
}

void Walk::count(const Step& step) {
  const Move& move = *step.move;
  ++summary_.blocks_before;
  summary_.blocks_after += step.blocks.size();
  summary_.points_added += step.blocks.size() - 1;
  if (move.kind == MoveKind::arc) {
    ++summary_.arcs_before;
    std::size_t arcs = 0;
    for (const FittedBlock& block : step.blocks) arcs += block.arc ? 1 : 0;
    ++(arcs == 0 ? summary_.arcs_to_lines : arcs == 1 ? summary_.arcs_kept : summary_.arcs_split);
  }
  const WorkFrame& frame = step.programmed.frame;
  for (const FittedBlock& block : step.blocks) {
    const AxisWords at = step.programmed.at(block.t_end);
    const AxisWords d = frame.turned(block.end - at);
    summary_.largest_turn = std::max(summary_.largest_turn, d.tail<3>().cwiseAbs().maxCoeff());
    const double most = std::max(kStill, summary_.largest.correction.head<3>().norm());
    if (d.head<3>().norm() <= most) continue;
    summary_.largest = {move.line, frame.machine(at), d};
  }
  if (move.kind == MoveKind::rapid) return;
  const double length = step.programmed.length();
  double after = 0.0;
  AxisWords from = step.begin;
  for (const FittedBlock& block : step.blocks) {
    after += block.arc ? ArcSweep(from.head<3>(), block.end.head<3>(), block.arc->centre,
                                  block.arc->normal_axis, block.arc->turns)
                             .length()
                       : (block.end - from).head<3>().norm();
    from = block.end;
  }
  summary_.length += length;
  summary_.corrected_length += after;
  const double turned = (step.programmed.end - step.programmed.begin).tail<3>().norm();
  const double way = length > 0.0 ? length : turned;
  const double time = move.feed > 0.0 ? way / move.feed : 0.0;
  summary_.time += time;
  const bool is_inverse = move.feed_mode == FeedMode::inverse_time;
  summary_.corrected_time += length > 0.0 && !is_inverse ? time * after / length : time;
}

void Walk::arrive(const Step& step, const AxisWords& machine) {
  if (step.is_corrected) {
    count(step);
    look_for_leftover(step);
    if (record_ != nullptr) record_->add(step, correction_);
  } else {
    ++summary_.blocks_before;
    ++summary_.blocks_after;
  }
  warn_of_travel(step);
  programmed_ = step.move->end_machine;
  out_ = machine;
}

void Walk::arrive_elsewhere(const Move& move) {
  ++summary_.blocks_before;
  ++summary_.blocks_after;
  const int Z = index_of(Axis::Z);
  known_[static_cast<std::size_t>(Z)] = false;
  programmed_[Z] = out_[Z] = move.end_machine[Z];
}

}  // namespace servomill::sim
