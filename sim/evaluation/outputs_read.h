/// Outputs of a run that the quantities of a scenario read.
#pragma once

#include <span>

#include "sim/engine/run_outputs.h"

namespace servomill::sim::model {
struct QuantitySpec;
}  // namespace servomill::sim::model

namespace servomill::sim::evaluation {

/// Outputs of which all quantities have the values that they have of a whole run. Every signal,
/// where a quantity does not say which it reads.
engine::RunOutputs outputs_read_by(std::span<const model::QuantitySpec> quantities);

}  // namespace servomill::sim::evaluation
