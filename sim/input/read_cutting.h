/// Reads the raw part and what cutting it costs.
#pragma once

#include <optional>

#include "sim/config/reader.h"
#include "sim/model/scenario.h"

namespace servomill::sim {

/// Tables [[part.stock]], each a box or a cylinder.
plant::Stock read_stock(Reader& part);

/// Keys of [cutting]: material, Ktc to Kae, wear, wear_per_m.
CuttingSpec read_cutting(Reader& table);

/// Keys cutting and wear of a case.
/// @param common  of the scenario; without it a case has neither
void read_case_cutting(Reader& table, const std::optional<CuttingSpec>& common, CaseSpec& spec);

}  // namespace servomill::sim
