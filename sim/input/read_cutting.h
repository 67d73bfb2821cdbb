/// Reads the stock and what cutting it costs.
#pragma once

#include <optional>

#include "plant/cutting/stock.h"
#include "sim/config/reader.h"
#include "sim/model/forward.h"

namespace servomill::sim::input {

/// Tables [[part.stock]], each a box or a cylinder.
plant::Stock read_stock(config::Reader& part);

/// Keys of [cutting]: material, Ktc to Kae, wear, wear_per_m, force, steps_per_tooth,
/// regeneration, depth_of_cut.
model::CuttingSpec read_cutting(config::Reader& table);

/// Keys cutting and wear of a case.
/// @param common  of the scenario; without it a case has neither
void read_case_cutting(config::Reader& table, const std::optional<model::CuttingSpec>& common,
                       model::CaseSpec& spec);

}  // namespace servomill::sim::input
