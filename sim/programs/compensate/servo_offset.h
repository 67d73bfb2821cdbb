/// Precompensation of a program for what an identified model of servo, friction, structure and
/// geometry predicts: the offset along its path.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "plant/geometry/error_model.h"
#include "plant/vocabulary/put_move.h"
#include "sim/programs/compensate/compensate.h"
#include "sim/programs/compensate/servo_prediction.h"
#include "strategies/path_offset.h"

namespace servomill::controllers {
struct ProgramSetup;
}  // namespace servomill::controllers
namespace servomill::sim::model {
struct MachineSettings;
}  // namespace servomill::sim::model

namespace servomill::sim::programs {

using SharedOffset = std::shared_ptr<const strategies::PathOffset>;

/// Hands out the blocks of the program that is written with an offset.
using WrittenMoves = std::function<void(const SharedOffset&, const PutMove&)>;

/// Runs of the model, with the blocks that are written, until the largest deviation is below the
/// tolerance or no longer falls (strategies/iterative_learning.h); the best one counts.
/// @param machine  that is compensated; the model must be one of it
/// @param setup    with which its program is read
/// @throws InputError, also where no offset makes the program better
ServoPrediction predict_servo(const CompensateRequest& request,
                              const model::MachineSettings& machine,
                              const plant::ErrorModel& errors,
                              const controllers::ProgramSetup& setup, const WrittenMoves& written,
                              SharedOffset& offset);

}  // namespace servomill::sim::programs
