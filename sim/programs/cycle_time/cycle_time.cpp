#include "sim/programs/cycle_time/cycle_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "controllers/gcode/interpreter.h"
#include "plant/vocabulary/interrupt.h"
#include "sim/input/implausible.h"
#include "sim/input/read_machine.h"
#include "sim/preparation/case_program.h"
#include "sim/programs/compensate/work_knowledge.h"
#include "sim/programs/cycle_time/motion_booking.h"
#include "sim/programs/given_setup.h"
#include "sim/programs/line_stage.h"
#include "sim/system/counted.h"

namespace servomill::sim::programs {
namespace {

using controllers::ExecutedBlock;

struct TimedProgram {
  model::MachineSettings machine;
  bool has_drives = false;
  GivenSetup given;
  bool is_start_known = false;
};

TimedProgram read_inputs(const CycleTimeRequest& request) {
  TimedProgram out;
  input::MachineDescription described =
      input::read_machine_description(request.inputs.machine, request.changes);
  out.machine = std::move(described.machine);
  out.has_drives = described.has_drives;
  const JointLayout& layout = out.machine.chain.layout;
  out.given = given_setup(request.program_file, request.inputs, request.work_offsets,
                          request.tool_lengths, &layout);
  controllers::ProgramSetup& setup = out.given.setup;
  setup.machine = preparation::tool_centre_point(out.machine);
  choose_reader(request.inputs, out.machine.nc, setup);
  out.is_start_known = !request.start.empty();
  if (out.is_start_known) {
    setup.start = axis_values("--start", request.start, &layout, false).words;
  } else {
    setup.start[index_of(Axis::Z)] = kSomeHeight;
    setup.accepts_unknown_positions = true;
  }
  if (setup.tools.empty()) setup.tools.take_any_number();
  setup.accepts_unknown_dwells = true;
  setup.probed = std::make_shared<controllers::AssumedContact>();
  return out;
}

// Reads a program line by line and plans its parts.
class ProgramReading {
 public:
  ProgramReading(const TimedProgram& program, MotionBooking& booking, CycleTimeReport& report)
      : program_(program),
        booking_(booking),
        report_(report),
        positions_(program.given.given, program.given.setup.start) {}

  void add(const ExecutedBlock& block) {
    const std::uint16_t file = number_of(*block.file);
    const bool all_is_known = program_.is_start_known;
    if (!all_is_known) positions_.begin_line(block);
    if (!block.unknown_moves.empty()) {
      booking_.duration().add_unknown_moves(block.unknown_moves, block.line);
    }
    const Move* last = nullptr;
    for (const Move& move : block.moves) {
      if (is_motion(move.kind)) last = &move;
    }
    for (const Move& move : block.moves) {
      if (!is_motion(move.kind)) {
        booking_.duration().add_other(move, file);
        continue;
      }
      const bool is_known =
          all_is_known || positions_.next(move, block, &move == last).distance_is_known;
      booking_.duration().add(move, is_known, file);
      refuse_unplannable();
    }
  }

 private:
  // Planning has given the program up.
  void refuse_unplannable() const {
    const std::string& why = booking_.duration().why_unknown();
    if (!why.empty()) throw InputError({report_.program}, "the cycle time is unknown: " + why);
  }

  std::uint16_t number_of(const std::string& file) {
    std::vector<std::string>& files = report_.files;
    if (!files.empty() && files[last_file_] == file) return last_file_;
    const auto known = std::find(files.begin(), files.end(), file);
    last_file_ = static_cast<std::uint16_t>(known - files.begin());
    if (known == files.end()) files.push_back(file);
    return last_file_;
  }

  const TimedProgram& program_;
  MotionBooking& booking_;
  CycleTimeReport& report_;
  KnownPositions positions_;
  std::uint16_t last_file_ = 0;
};

void read_program(const CycleTimeRequest& request, const TimedProgram& program,
                  MotionBooking& booking, CycleTimeReport& report) {
  const auto text = [&] { return controllers::ProgramText::of_file(request.program_file); };
  LineStage lines(request.program_file);
  ProgramReading reading(program, booking, report);
  controllers::Interpreter interpreter(text(), program.given.setup);
  try {
    while (const auto block = interpreter.next_block()) {
      throw_if_interrupted();
      lines.at(block->line);
      reading.add(*block);
    }
  } catch (const InputError&) {  // stopped at the first fault; the user wants all of them
    auto faults = controllers::check_program(text(), program.given.setup);
    if (faults.empty()) throw;
    throw InputError(std::move(faults));
  }
  report.warnings = interpreter.warnings();
}

}  // namespace

CycleTimeReport cycle_time(const CycleTimeRequest& request) {
  const TimedProgram program = read_inputs(request);
  CycleTimeReport report;
  report.program = request.program_file;
  report.files = {request.program_file};
  DurationSettings settings;
  settings.feed_override = request.feed_override;
  settings.start = program.machine.chain.layout.joints(program.given.setup.start);
  settings.tool_centre_point = program.given.setup.machine;
  settings.tools = &program.given.setup.tools;
  settings.file = request.program_file;
  MotionBooking booking(program.machine, settings, request.raise, request.threads);
  if (const std::string& why = booking.duration().why_unknown(); !why.empty()) {
    throw InputError({request.inputs.machine}, why);
  }
  read_program(request, program, booking, report);
  booking.finish(report, program.is_start_known);
  if (!program.has_drives) return report;
  for (const std::string& value : input::implausible_values(program.machine)) {
    report.warnings.push_back({{request.inputs.machine}, value});
  }
  return report;
}

}  // namespace servomill::sim::programs
