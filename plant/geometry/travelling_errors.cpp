#include "plant/geometry/travelling_errors.h"

namespace servomill::plant {

ErrorModel travelling(const ErrorModel& errors, Axis axis, double direction) {
  ErrorModel out = errors;
  for (const Axis of : kAllAxes) {
    ErrorFunction& error = out.component({of, axis, false});
    error = travelling(error, direction);
  }
  return out;
}

}  // namespace servomill::plant
