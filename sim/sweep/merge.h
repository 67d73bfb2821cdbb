/// Joins the tables of a sweep's shards.
#pragma once

#include <string>
#include <vector>

#include "sim/sweep/table.h"

namespace servomill::sim::sweep {

/// Result of a merge.
struct Merged {
  StatusCounts counts{};
  std::vector<std::string> missing;    // what the table lacks, one reason an entry
  std::vector<SimdLevel> simd_levels;  // that points were computed with
};

/// Writes the table that one process would have written for all points of the shards' selection.
/// Files may be given in any order, partial ones of shards that did not end among them.
/// @param partial  lacking points are rows that were not run; else they are refused
/// @throws InputError for files of different sweeps or versions, for points that stand in two
/// files, for points that are missing, named with their shards
Merged merge_sweeps(const std::vector<std::string>& shards, const std::string& out, bool force,
                    bool partial);

}  // namespace servomill::sim::sweep
