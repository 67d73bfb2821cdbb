#include "sim/programs/compensate/program_corrector.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "controllers/gcode/canned_cycles.h"
#include "controllers/gcode/modal_state.h"
#include "controllers/gcode/request.h"
#include "plant/vocabulary/input_error.h"
#include "sim/programs/named_axes.h"

namespace servomill::sim::programs {
namespace {

using controllers::ExecutedBlock;

// By how much of the tolerance the output may stand beside the corrected begin of a move.
constexpr double kBeside = 0.25;
constexpr double kStill = 1e-12;  // m, rad: what rounding leaves of positions

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

}  // namespace

bool is_skipped(const controllers::ExecutedBlock& block) {
  return block.block == nullptr && !controllers::is_blank(block.text);
}

bool is_place_of_machine(const ExecutedBlock& block) {
  const int code = non_modal_code(block);
  return code == 530 || code == 280 || code == 300;
}

ProgramCorrector::ProgramCorrector(const WalkOptions& options, const controllers::ToolTable& tools,
                                   Correction& correction, Summary& summary, PathRecord* record,
                                   SmoothedFeeds* feeds, PointUncertainty* uncertainty)
    : options_(options),
      tools_(tools),
      correction_(correction),
      summary_(summary),
      record_(record),
      feeds_(feeds),
      uncertainty_(uncertainty),
      programmed_(options.start),
      out_(options.start),
      known_(options.is_start_known),
      named_(options.is_start_known) {
  know_missing_axes();
}

void ProgramCorrector::know_missing_axes() {
  for (int i = 0; i < kAxisWords; ++i) {
    if (!correction_.layout().joint_of(kAllAxes[static_cast<std::size_t>(i)])) {
      known_[static_cast<std::size_t>(i)] = true;
    }
  }
}

void ProgramCorrector::forget_positions() {
  known_.fill(false);
  know_missing_axes();
  directions_.fill(0);
}

std::optional<double> ProgramCorrector::programmed(Axis axis) const {
  if (!named_[static_cast<std::size_t>(index_of(axis))]) return std::nullopt;
  return programmed_[index_of(axis)];
}

void ProgramCorrector::restate(Axis axis, double machine) {
  known_[static_cast<std::size_t>(index_of(axis))] = true;
  out_[index_of(axis)] = machine;
}

bool ProgramCorrector::knows_all() const {
  return std::all_of(known_.begin(), known_.end(), [](bool one) { return one; });
}

// Which axes have a position that the program names. @return those of the move
AxisFlags ProgramCorrector::learn(const Move& move, const ExecutedBlock& block) {
  const bool is_absolute = !block.state->is_incremental || is_place_of_machine(block);
  const bool goes_home =
      (non_modal_code(block) == 280 || non_modal_code(block) == 300) && !names_any(block);
  AxisFlags commanded{};
  for (int i = 0; i < kAxisWords; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const bool names = names_axis(block, kAllAxes[k]);
    commanded[k] = goes_home || names || std::abs(move.end_machine[i] - programmed_[i]) > kStill;
    if (goes_home || (is_absolute && names)) known_[k] = named_[k] = true;
    const Axis axis = kAllAxes[k];
    if (is_named(block, i) && !correction_.layout().joint_of(axis)) {
      throw InputError({options_.file, move.line, block.request->word(letter(axis)).column},
                       fmt::format("moves {0}; the machine has no axis {0}", letter(axis)));
    }
  }
  return commanded;
}

// Blocks for another control name absolute positions in coordinates that are not turned.
void ProgramCorrector::refuse_unknown_begin(const Move& move, const ExecutedBlock& block,
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
        is_mixed
            ? fmt::format("moves with a rotated work offset while the position of {0} is unknown; "
                          "program X and Y together",
                          name)
            : fmt::format(
                  "incremental move of {0} from an unknown position; program {0} with G90 first",
                  name));
  }
}

// A canned cycle goes back to the height that it comes from.
void ProgramCorrector::refuse_unknown_height(const ExecutedBlock& block,
                                             const AxisFlags& was_known) const {
  if (block.request == nullptr || !controllers::is_canned_cycle(block.request->motion_code()))
    return;
  const auto k = static_cast<std::size_t>(block.state->normal_axis);
  if (was_known[k]) return;
  throw InputError(
      {options_.file, block.line, block.request->motion.column},
      fmt::format("a canned cycle returns to an unknown initial {0}; program {0} in a rapid first",
                  letter(kAllAxes[k])));
}

void ProgramCorrector::refuse(const Move& move, const AxisFlags& was_known) const {
  if (move.tool_control != ToolControl::none) {
    throw InputError(
        {options_.file, move.line},
        fmt::format("moves under TCP control or in a tilted work plane cannot be compensated; {}",
                    kWriteAxes));
  }
  if (move.synchronised != Synchronised::no) {
    throw InputError({options_.file, move.line},
                     "spindle-synchronised motion (G33, G33.1) cannot be compensated");
  }
  if (move.kind == MoveKind::spline) {
    throw InputError({options_.file, move.line},
                     "splines (G5, G5.1, G5.2) cannot be compensated; post-process them to short "
                     "lines or arcs");
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
          ? fmt::format(
                "feeds while the position of {0} is unknown: no block since the start, the last "
                "tool change or the last stop programs it; program it in a rapid first",
                axes)
          : fmt::format("feeds while the position of {0} is unknown, so the errors are unknown: no "
                        "earlier block programs it; set the start position with --start {1}=...",
                        axes, axes.front()));
}

// The tool whose length is in force, or else that in the spindle.
void ProgramCorrector::choose_tool(const controllers::ModalState& state) {
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

Step ProgramCorrector::next(const Move& move, const ExecutedBlock& block) {
  return next(move, block, is_place_of_machine(block));
}

Step ProgramCorrector::next(const Move& move, const ExecutedBlock& block, bool is_place) {
  Step step;
  step.move = &move;
  step.was_known = known_;
  step.is_commanded = learn(move, block);
  refuse_unknown_begin(move, block, step.is_commanded);
  refuse_unknown_height(block, step.was_known);
  refuse(move, step.was_known);
  WorkFrame& frame = step.programmed.frame;
  frame.cos = block.state->cos_rotation;
  frame.sin = block.state->sin_rotation;
  frame.offset = move.end_machine - frame.turned(move.end);
  step.programmed.begin = frame.work(programmed_);
  step.programmed.end = move.end;
  step.programmed.s_begin = move.s_begin;
  step.programmed.s_end = move.s_end;
  if (move.kind == MoveKind::arc) {
    step.programmed.arc = ArcSweep(step.programmed.begin.head<3>(), move.end.head<3>(),
                                   move.arc.centre, move.arc.normal_axis, move.arc.turns);
  }
  step.begin = frame.work(out_);
  step.is_place = is_place;
  step.is_corrected = !is_place && knows_all();
  if (!step.is_corrected) {
    turn_directions(move.end_machine - programmed_, step.was_known);
    step.blocks = {{0.0, 1.0, frame.work(uncorrected_end(step)), {}}};
    return step;
  }
  choose_tool(*block.state);
  // the way from an unknown position is unknown, too
  const bool is_way_known = std::all_of(kAllAxes.begin(), kAllAxes.end(), [&](Axis axis) {
    return !has(axis) || step.was_known[static_cast<std::size_t>(index_of(axis))];
  });
  if (move.kind == MoveKind::rapid && !(options_.corrects_rapids && is_way_known)) {
    turn_directions(move.end_machine - programmed_, step.was_known);
    step.blocks = {{0.0, 1.0, corrected(step.programmed, correction_, 1.0), {}}};
  } else {
    fit_feed(step, options_.fit);
  }
  if (move.kind == MoveKind::rapid) hold_axes(step);
  return step;
}

// Piece by piece where an arc turns the direction of travel of an axis whose errors depend on it.
void ProgramCorrector::fit_feed(Step& step, const FitOptions& options) {
  step.blocks.clear();
  const ProgrammedMove& whole = step.programmed;
  std::vector<double> shares = {0.0, 1.0};
  if (whole.arc && correction_.has_reversals()) {
    const ArcSweep& arc = *whole.arc;
    AxisWords x = AxisWords::Zero(), y = AxisWords::Zero();
    x[arc.a] = y[arc.b] = 1.0;
    shares =
        shares_between_reversals(whole.frame.turned(x).head<3>(), whole.frame.turned(y).head<3>(),
                                 arc.angle, arc.sweep, correction_.reverses());
  }
  for (std::size_t i = 0; i + 1 < shares.size(); ++i) {
    fit_piece(step, shares[i], shares[i + 1], options);
  }
}

void ProgramCorrector::fit_piece(Step& step, double t_begin, double t_end,
                                 const FitOptions& options) {
  const ProgrammedMove& whole = step.programmed;
  ProgrammedMove piece = whole;
  piece.begin = whole.at(t_begin);
  piece.end = whole.at(t_end);
  piece.s_begin = whole.s(t_begin);
  piece.s_end = whole.s(t_end);
  if (whole.arc && t_end - t_begin < 1.0) {
    ArcSweep& arc = *piece.arc;
    arc.angle += t_begin * arc.sweep;
    arc.sweep *= t_end - t_begin;
    arc.along_begin = piece.begin[arc.c];
    arc.along_end = piece.end[arc.c];
    arc.r_begin = whole.arc->r_begin + t_begin * (whole.arc->r_end - whole.arc->r_begin);
    arc.r_end = whole.arc->r_begin + t_end * (whole.arc->r_end - whole.arc->r_begin);
  }
  const Directions before = directions_;
  AxisWords way = whole.frame.turned(piece.end - piece.begin);
  if (piece.arc) {
    AxisWords along = AxisWords::Zero();
    along.head<3>() = piece.arc->derivative(0.5);
    way.head<3>() = whole.frame.turned(along).head<3>();
  }
  turn_directions(way, step.was_known);
  note_reversals(step, before);
  const AxisWords c_begin = corrected(piece, correction_, 0.0);
  const AxisWords at = step.blocks.empty() ? step.begin : step.blocks.back().end;
  const AxisWords off = c_begin - at;
  const bool leads = off.head<3>().norm() > kBeside * options.tolerance ||
                     off.tail<3>().norm() > kBeside * options.tolerance_turn;
  if (leads) step.blocks.push_back({t_begin, t_begin, c_begin, {}});
  for (FittedBlock block : fit(piece, correction_, leads ? c_begin : at, options)) {
    block.t_begin = t_begin + block.t_begin * (t_end - t_begin);
    block.t_end = block.t_end >= 1.0 ? t_end : t_begin + block.t_end * (t_end - t_begin);
    step.blocks.push_back(block);
  }
}

// @param way  of the machine, or its derivative
void ProgramCorrector::turn_directions(const AxisWords& way, const AxisFlags& was_known) {
  if (!correction_.has_reversals()) return;
  for (int i = 0; i < kAxisWords; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!was_known[k]) directions_[k] = 0;
    if (was_known[k] && std::abs(way[i]) > kStill) directions_[k] = way[i] > 0.0 ? 1 : -1;
  }
  correction_.set_directions(directions_);
}

// Notes errors that stay behind a change of direction, and where no direction is known.
void ProgramCorrector::note_reversals(const Step& step, const Directions& before) {
  if (!correction_.has_reversals()) return;
  for (const Axis axis : kAllAxes) {
    const auto k = static_cast<std::size_t>(index_of(axis));
    if (directions_[k] == before[k] && directions_[k] != 0) continue;
    const double width = correction_.reversal_at(programmed_, axis);
    if (width == 0.0) continue;
    if (directions_[k] == 0) {
      if (!summary_.undirected) summary_.undirected = Summary::At{step.move->line, programmed_, {}};
      summary_.undirected_width = std::max(summary_.undirected_width, 0.5 * width);
    } else {
      ++summary_.reversals;
      summary_.reversal_width = std::max(summary_.reversal_width, width);
    }
  }
}

Step ProgramCorrector::without_arcs(Step step) {
  FitOptions options = options_.fit;
  options.allow_arcs = false;
  fit_feed(step, options);
  return step;
}

// A place of the machine is exact; where errors are not known yet, axes that the original leaves
// where they are stay.
AxisWords ProgramCorrector::uncorrected_end(const Step& step) const {
  AxisWords end = out_;
  for (int i = 0; i < kAxisWords; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double target = step.move->end_machine[i];
    const bool stays =
        !step.is_place && step.was_known[k] && std::abs(target - programmed_[i]) <= kStill;
    if (step.is_commanded[k] && !stays) end[i] = target;
  }
  return end;
}

// Axes that the original leaves where they are stay.
void ProgramCorrector::hold_axes(Step& step) const {
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

void ProgramCorrector::arrive_elsewhere(const Move& move) {
  ++summary_.blocks_before;
  ++summary_.blocks_after;
  const int Z = index_of(Axis::Z);
  known_[static_cast<std::size_t>(Z)] = named_[static_cast<std::size_t>(Z)] = false;
  programmed_[Z] = out_[Z] = move.end_machine[Z];
}

}  // namespace servomill::sim::programs
