#include "sim/programs/compensate/highest_z.h"

#include <fmt/format.h>

#include "controllers/gcode/request.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/programs/compensate/program_corrector.h"

namespace servomill::sim::programs {

void HighestZ::look(const controllers::ExecutedBlock& block) {
  const bool names_Z = block.request != nullptr && block.request->has('Z');
  for (const Move& move : block.moves) {
    if (!is_motion(move.kind)) continue;
    const bool moves_Z = names_Z || (has_last_ && move.end_machine[2] != last_);
    has_last_ = has_last_ || names_Z;
    last_ = move.end_machine[2];
    if (!moves_Z || is_place_of_machine(block) || last_ <= Z_) continue;
    Z_ = last_;
    line_ = block.line;
  }
}

void HighestZ::refuse_above(double retract, const std::string& file) const {
  constexpr double kSame = 1e-6;  // m
  if (Z_ <= retract + kSame) return;
  throw InputError({file, line_},
                   fmt::format("moves to machine Z{:.3f}, above the retract height Z{:g}; raise "
                               "--retract, or check --work-offset and the tool length",
                               Z_ / mm, retract / mm));
}

}  // namespace servomill::sim::programs
