// The reader of parameter files. Laws: faults have their places; numbers and values are those that
// a program may hold; the work system is one that there is.
#include <cmath>

#include "controllers/gcode/modal_state.h"
#include "controllers/gcode/parameter_file.h"
#include "controllers/gcode/parameters.h"
#include "tests/fuzz/fuzz.h"

namespace servomill::fuzz {

void run(std::string_view text) {
  try {
    const auto stored = controllers::parse_parameter_file(text, "p.var");
    for (const auto& [number, value] : stored) {
      require(number >= 1 && number <= controllers::parameter::kLast, "numbers are in range");
      require(std::isfinite(value), "values are finite");
    }
    const int system = controllers::work_system_of(stored);
    require(system >= 1 && system <= controllers::kWorkSystems, "the work system exists");
  } catch (const InputError& error) {
    require_places(error.faults(), text, "p.var");
  }
}

}  // namespace servomill::fuzz
