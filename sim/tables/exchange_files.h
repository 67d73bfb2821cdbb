/// Parameter files for the volumetric compensation of the ISG kernel (Beckhoff TF5280).
#pragma once

#include <vector>

#include "sim/tables/table_export.h"
#include "sim/tables/table_files.h"

namespace servomill::sim::tables {

/// volcomp.csv (ISG CSV) and notes.txt.
std::vector<TextFile> isg_files(const TableExport& tables);

/// volcomp.exc (Etalon exchange format, variant Vendor) and notes.txt.
std::vector<TextFile> etalon_files(const TableExport& tables);

}  // namespace servomill::sim::tables
