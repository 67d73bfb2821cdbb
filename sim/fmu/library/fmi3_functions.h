/// Names and types of FMI 3.0.2, as its chapters 2.2, 2.3 and 4.2 define them.
#pragma once

#include <cstddef>
#include <cstdint>

namespace servomill::sim::fmu {

// NOLINTBEGIN(readability-identifier-naming): names of the standard
extern "C" {

using fmi3Instance = void*;
using fmi3InstanceEnvironment = void*;
using fmi3FMUState = void*;
using fmi3ValueReference = std::uint32_t;
using fmi3Float64 = double;
using fmi3Boolean = bool;
using fmi3String = const char*;
using fmi3Byte = std::uint8_t;

enum fmi3Status { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal };

using fmi3LogMessageCallback = void (*)(fmi3InstanceEnvironment, fmi3Status, fmi3String category,
                                        fmi3String message);

}  // extern "C"
// NOLINTEND(readability-identifier-naming)

}  // namespace servomill::sim::fmu
