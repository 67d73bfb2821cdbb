/// Results of cases on the way from a child process to its parent.
#pragma once

#include "sim/engine/simulate.h"
#include "sim/records/row_keeper.h"
#include "strategies/plugin_child.h"

namespace servomill::sim::run {

/// Writes all of a result but its wall time.
void write_result(const engine::CaseResult& result, strategies::ProcessPipe& to);

/// Reads what write_result() has written, bit for bit.
/// @param keeping  where its rows are kept; they are thinned already
/// @throws as PluginChild::read does; SystemError
engine::CaseResult read_result(strategies::PluginChild& from, records::RowKeeping keeping);

}  // namespace servomill::sim::run
