/// Probing moves of a run, for files.
#pragma once

#include <span>
#include <string>

#include "plant/vocabulary/axes.h"
#include "sim/preparation/touch.h"
#include "sim/records/hdf5_group.h"

namespace servomill::sim::run {

/// Rows as `servomill calibrate` reads them for a group of kind `touch`: the positions latched, and
/// the section of the program as the name of the sphere. A move on which the probe has not switched
/// is a comment.
std::string touches_csv(std::span<const preparation::Touch> touches, const JointLayout& layout);

/// Lists `line`, `switched`, `section` and one of positions (mm, deg) for each axis, by touch.
void write_touches(records::Hdf5Group group, std::span<const preparation::Touch> touches,
                   const JointLayout& layout);

}  // namespace servomill::sim::run
