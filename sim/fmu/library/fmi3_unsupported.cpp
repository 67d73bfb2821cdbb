/// Functions of FMI 3.0 for what an axis does not have: other types, intervals of clocks, model
/// exchange. They refuse; arguments that the importer passes beyond the declared ones are not
/// looked at.
#include "sim/fmu/library/fmi3_status.h"

namespace servomill::sim::fmu {

#define SERVOMILL_UNSUPPORTED(name, what) \
  SERVOMILL_FMI fmi3Status name(fmi3Instance c) { return unsupported(c, what); }
#define SERVOMILL_NONE_OF(type)                                                      \
  SERVOMILL_FMI fmi3Status fmi3Get##type(fmi3Instance c, const fmi3ValueReference[], \
                                         std::size_t count) {                        \
    return count == 0 ? fmi3OK : unsupported(c, "a variable of type " #type);        \
  }                                                                                  \
  SERVOMILL_FMI fmi3Status fmi3Set##type(fmi3Instance c, const fmi3ValueReference[], \
                                         std::size_t count) {                        \
    return count == 0 ? fmi3OK : unsupported(c, "a variable of type " #type);        \
  }

SERVOMILL_NONE_OF(Float32)
SERVOMILL_NONE_OF(Int8)
SERVOMILL_NONE_OF(UInt8)
SERVOMILL_NONE_OF(Int16)
SERVOMILL_NONE_OF(UInt16)
SERVOMILL_NONE_OF(Int32)
SERVOMILL_NONE_OF(UInt32)
SERVOMILL_NONE_OF(Int64)
SERVOMILL_NONE_OF(UInt64)
SERVOMILL_NONE_OF(Boolean)
SERVOMILL_NONE_OF(String)
SERVOMILL_NONE_OF(Binary)
SERVOMILL_UNSUPPORTED(fmi3GetNumberOfVariableDependencies, "the query of dependencies")
SERVOMILL_UNSUPPORTED(fmi3GetVariableDependencies, "the query of dependencies")
SERVOMILL_UNSUPPORTED(fmi3GetDirectionalDerivative, "a directional derivative")
SERVOMILL_UNSUPPORTED(fmi3GetAdjointDerivative, "an adjoint derivative")
SERVOMILL_UNSUPPORTED(fmi3GetOutputDerivatives, "a derivative of an output")
SERVOMILL_UNSUPPORTED(fmi3EnterConfigurationMode, "configuration mode")
SERVOMILL_UNSUPPORTED(fmi3ExitConfigurationMode, "configuration mode")
SERVOMILL_UNSUPPORTED(fmi3GetIntervalDecimal, "the interval of a triggered clock")
SERVOMILL_UNSUPPORTED(fmi3GetIntervalFraction, "the interval of a triggered clock")
SERVOMILL_UNSUPPORTED(fmi3GetShiftDecimal, "the interval of a triggered clock")
SERVOMILL_UNSUPPORTED(fmi3GetShiftFraction, "the interval of a triggered clock")
SERVOMILL_UNSUPPORTED(fmi3SetIntervalDecimal, "the interval of a triggered clock")
SERVOMILL_UNSUPPORTED(fmi3SetIntervalFraction, "the interval of a triggered clock")
SERVOMILL_UNSUPPORTED(fmi3SetShiftDecimal, "the interval of a triggered clock")
SERVOMILL_UNSUPPORTED(fmi3SetShiftFraction, "the interval of a triggered clock")
SERVOMILL_UNSUPPORTED(fmi3EnterContinuousTimeMode, "model exchange")
SERVOMILL_UNSUPPORTED(fmi3CompletedIntegratorStep, "model exchange")
SERVOMILL_UNSUPPORTED(fmi3SetTime, "model exchange")
SERVOMILL_UNSUPPORTED(fmi3SetContinuousStates, "model exchange")
SERVOMILL_UNSUPPORTED(fmi3GetContinuousStateDerivatives, "model exchange")
SERVOMILL_UNSUPPORTED(fmi3GetEventIndicators, "model exchange")
SERVOMILL_UNSUPPORTED(fmi3GetContinuousStates, "model exchange")
SERVOMILL_UNSUPPORTED(fmi3GetNominalsOfContinuousStates, "model exchange")
SERVOMILL_UNSUPPORTED(fmi3GetNumberOfEventIndicators, "model exchange")
SERVOMILL_UNSUPPORTED(fmi3GetNumberOfContinuousStates, "model exchange")
SERVOMILL_UNSUPPORTED(fmi3ActivateModelPartition, "scheduled execution")

}  // namespace servomill::sim::fmu
