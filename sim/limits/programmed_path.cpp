#include "sim/limits/programmed_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "controllers/gcode/readers/plane_frame.h"
#include "controllers/path/path_limits.h"
#include "plant/vocabulary/units.h"
#include "sim/preparation/case_program.h"
#include "sim/programs/compensate/program_corrector.h"
#include "sim/programs/known_positions.h"
#include "sim/programs/named_axes.h"
#include "sim/programs/placed_program.h"

namespace servomill::sim::limits {
namespace {

using controllers::ExecutedBlock;
using programs::AxisFlags;

constexpr AxisFlags kAllKnown = {true, true, true, true, true, true};

// Offsets that the program needs and that nobody has given. With the position before the program
// all others follow.
class OffsetKnowledge {
 public:
  OffsetKnowledge(programs::GivenPlaces given, JointLayout layout)
      : given_(std::move(given)), layout_(layout) {}

  /// @throws InputError at the first position that depends on one
  void check(const ExecutedBlock& block) {
    if (block.request == nullptr) return;
    given_.learn_G10(block, kAllKnown);
    const bool moves = std::any_of(block.moves.begin(), block.moves.end(),
                                   [](const Move& move) { return is_motion(move.kind); });
    if (!moves) return;
    refuse_unknown_radius(block);
    if (programs::is_place_of_machine(block)) return refuse_stored_place(block);
    if (block.state->is_incremental) return;
    for (const Axis axis : kAllAxes) {
      if (layout_.joint_of(axis) && programs::names_axis(block, axis)) check_axis(block, axis);
    }
  }

 private:
  static void refuse_unknown_radius(const ExecutedBlock& block) {
    const controllers::Compensation& compensation = block.state->compensation;
    if (!compensation.is_on || !compensation.is_radius_unknown) return;
    throw InputError(
        {*block.file, block.line},
        "the diameter of the tool of G41 or G42 is unknown; pass a tool table with --tools");
  }

  // G53 names machine coordinates; G28 and G30 go to places that the control has stored.
  void refuse_stored_place(const ExecutedBlock& block) const {
    constexpr int kG53 = 530;  // ten times
    if (programs::non_modal_code(block) == kG53 || given_.has_stored_places) return;
    throw InputError({*block.file, block.line},
                     "moves to a position stored in the control; pass it with --parameter-file");
  }

  void check_axis(const ExecutedBlock& block, Axis axis) const {
    const controllers::ModalState& state = *block.state;
    const AxisFlags& known = given_.work_offset[static_cast<std::size_t>(state.work_system - 1)];
    const int i = index_of(axis);
    const bool is_turned = i < 2 && state.sin_rotation != 0.0;
    const bool is_known = is_turned ? known[0] && known[1] : known[static_cast<std::size_t>(i)];
    if (block.frame->additional_system > 0 ? !block.frame->is_translation_known : !is_known) {
      const std::string system = programs::work_system_name(block.frame->additional_system > 0
                                                                ? programs::kAdditionalSystem +
                                                                      block.frame->additional_system
                                                                : state.work_system);
      throw InputError({*block.file, block.line},
                       fmt::format("the position of {} on {} is unknown; set it with "
                                   "--work-offset, --additional-offset or --parameter-file",
                                   system, letter(axis)));
    }
    const int tool = state.tool_offset_number;
    const bool needs_tool = axis == Axis::Z || state.controls_tip();
    if (!needs_tool || tool == 0 || tool == controllers::kOtherToolOffset ||
        given_.tool_lengths.contains(tool)) {
      return;
    }
    throw InputError(
        {*block.file, block.line},
        fmt::format("the length of tool {} is unknown; set it with --tools or --tool-length",
                    tool));
  }

  programs::GivenPlaces given_;
  JointLayout layout_;
};

// Collects the moves of a program, all of whose positions must be known.
class MoveCollector {
 public:
  explicit MoveCollector(const programs::PlacedProgram& program)
      : offsets_(program.given.given, program.machine.chain.layout) {}

  void add(const ExecutedBlock& block) {
    if (!block.unknown_moves.empty()) {
      throw InputError(
          {*block.file, block.line},
          fmt::format("the moves of {} are internal to the control: no path can be compared",
                      block.unknown_moves));
    }
    offsets_.check(block);
    for (const Move& move : block.moves) moves_.push_back(move);
  }

  MoveList take() { return std::move(moves_); }

 private:
  OffsetKnowledge offsets_;
  MoveList moves_;
};

bool takes_tolerance_of_machine(const Move& move, const ProgramRequest& request) {
  return !request.tolerance && move.path_mode == PathMode::continuous &&
         !(move.path_tolerance > 0.0);
}

// By which the path may leave the move.
double tolerance_of(const Move& move, const model::NcSettings& nc, const ProgramRequest& request) {
  if (request.tolerance) return *request.tolerance;
  if (move.path_mode != PathMode::continuous) return controllers::PathOptions{}.exact_tolerance;
  return move.path_tolerance > 0.0 ? move.path_tolerance : nc.path_tolerance;
}

}  // namespace

ProgrammedPath programmed_path(const ProgramRequest& request, const AxisWords& start) {
  programs::PlacedProgram program = programs::placed_program(request.placement);
  if (!program.is_start_known) program.begin_at(start);
  MoveCollector collector(program);
  std::vector<Fault> warnings =
      programs::read_blocks(request.placement.program_file, program.given.setup,
                            [&](const ExecutedBlock& block) { collector.add(block); });
  const MoveList moves = collector.take();
  const controllers::ProgramSetup& setup = program.given.setup;
  ProgrammedPath out{request.placement.program_file,
                     engine::ProgramPath(moves, setup.start, setup.machine,
                                         preparation::tips_of(moves, setup.tools)),
                     {},
                     setup.machine,
                     std::move(warnings)};
  bool is_said = false;
  for (const Move& move : moves) {
    if (!is_motion(move.kind)) continue;
    out.tolerance.push_back(tolerance_of(move, program.machine.nc, request));
    if (is_said || !takes_tolerance_of_machine(move, request)) continue;
    is_said = true;
    out.warnings.push_back({{request.placement.program_file, move.line},
                            fmt::format("no G64 P is active: compared with nc.path_tolerance_um = "
                                        "{:g} of the machine file; change it with --tolerance",
                                        program.machine.nc.path_tolerance / um)});
  }
  if (out.path.size() == 0) {
    throw InputError({request.placement.program_file},
                     "contains no motion: there is no path to compare");
  }
  return out;
}

}  // namespace servomill::sim::limits
