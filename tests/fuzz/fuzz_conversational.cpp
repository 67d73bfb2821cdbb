// Conversational programs, read and run.
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/translated.h"

namespace servomill::fuzz {

void run(std::string_view text) { run_translated(text, "p.h", controllers::Reader::heidenhain); }

}  // namespace servomill::fuzz
