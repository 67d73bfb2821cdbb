#include "sim/model/unit_error.h"

namespace servomill::sim::model {

plant::ErrorModel unit_error(const plant::ErrorName& name) {
  plant::ErrorModel out;
  if (name.is_location) {
    out.location(name) = kUnitError;
  } else {
    out.component(name) = plant::constant(kUnitError);
  }
  return out;
}

}  // namespace servomill::sim::model
