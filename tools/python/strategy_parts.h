/// The parts of a strategy that is a class of Python.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "plant/vocabulary/move_list.h"
#include "plant/vocabulary/put_move.h"
#include "strategies/strategy.h"
#include "tools/python/strategy_setup.h"

namespace servomill::python {

/// offset(Q_ref): one object for each run, made when its setpoints settle.
std::unique_ptr<strategies::SetpointPart> offset_part(const Made& made);

/// step(Q_meas): one object for each run, made when it settles, which is called with successive
/// readings of this run, up to eight at once. A class that keeps no state has one object for all,
/// which is called with the readings of several runs.
std::unique_ptr<strategies::FeedbackPart> feedback_part(const Made& made, double model_period);

/// rewrite(program): hands out the moves with the blocks that it returns in their place.
/// @throws PluginFailed with what it has thrown
void put_rewritten(const Made& made, const MoveRange& moves, const PutMove& put);

void bind_program_view(pybind11::module_& module);

}  // namespace servomill::python
