// A fuzz target as libFuzzer calls it.
#include <cstdint>

#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  servomill::fuzz::run_in_time({reinterpret_cast<const char*>(data), size});
  return 0;
}
