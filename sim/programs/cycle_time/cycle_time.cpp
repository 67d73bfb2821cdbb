#include "sim/programs/cycle_time/cycle_time.h"

#include <fmt/format.h>

#include <algorithm>

#include "controllers/gcode/interpreter.h"
#include "sim/input/implausible.h"
#include "sim/programs/cycle_time/motion_booking.h"
#include "sim/programs/known_positions.h"
#include "sim/programs/placed_program.h"
#include "sim/system/counted.h"

namespace servomill::sim::programs {
namespace {

using controllers::ExecutedBlock;

// Reads a program line by line and plans its parts.
class ProgramReading {
 public:
  ProgramReading(const PlacedProgram& program, MotionBooking& booking, CycleTimeReport& report)
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

  const PlacedProgram& program_;
  MotionBooking& booking_;
  CycleTimeReport& report_;
  KnownPositions positions_;
  std::uint16_t last_file_ = 0;
};

}  // namespace

CycleTimeReport cycle_time(const CycleTimeRequest& request) {
  const PlacedProgram program = placed_program(request.placement);
  CycleTimeReport report;
  report.program = request.placement.program_file;
  report.files = {request.placement.program_file};
  DurationSettings settings;
  settings.feed_override = request.feed_override;
  settings.start = program.machine.chain.layout.joints(program.given.setup.start);
  settings.tool_centre_point = program.given.setup.machine;
  settings.tools = &program.given.setup.tools;
  settings.file = request.placement.program_file;
  MotionBooking booking(program.machine, settings, request.raise, request.threads);
  if (const std::string& why = booking.duration().why_unknown(); !why.empty()) {
    throw InputError({request.placement.inputs.machine}, why);
  }
  ProgramReading reading(program, booking, report);
  report.warnings = read_blocks(request.placement.program_file, program.given.setup,
                                [&](const ExecutedBlock& block) { reading.add(block); });
  booking.finish(report, program.is_start_known);
  if (!program.has_drives) return report;
  for (const std::string& value : input::implausible_values(program.machine)) {
    report.warnings.push_back({{request.placement.inputs.machine}, value});
  }
  return report;
}

}  // namespace servomill::sim::programs
