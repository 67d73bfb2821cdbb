/// Compensation tables of the NC: points over one axis, linear between them, added to the set
/// point. They enter where the NC lets them in, which is what paper [G] could not find out for its
/// control.
#pragma once

#include "strategies/registry.h"

namespace servomill::strategies {

Entry table_entry();

}  // namespace servomill::strategies
