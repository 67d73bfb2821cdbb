/// Demands of a case on its axes, in the result file.
#pragma once

#include <string>
#include <vector>

#include "sim/evaluation/comparison.h"
#include "sim/records/hdf5_group.h"
#include "sim/records/input_file.h"

namespace servomill::sim::run {

void write_demands(records::Hdf5Group group, const std::vector<evaluation::AxisDemand>& demands);

/// As they were written; empty: the file has none.
std::vector<evaluation::AxisDemand> read_demands(const records::InputFile& file,
                                                 const std::string& group);

}  // namespace servomill::sim::run
