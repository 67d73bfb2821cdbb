/// Rows of a group from its file.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "sim/readings/readings.h"

namespace servomill::sim::readings {

/// Reads the rows of a group whose keys have been read.
/// @param lower, upper  travel (5; m, rad)
/// @param faults        receives what is wrong with rows
void read_rows(Group& group, const plant::MachineChain& chain, const Joints& lower,
               const Joints& upper, Numbers numbers, std::vector<Fault>& faults);

/// 1 of "forward", "up", "+", "ccw", ...; -1 of their opposites; upper and lower case.
std::optional<int> direction_of(std::string_view word);

/// Directions of the joints from those of the rows: of the axis; along a diagonal those of the
/// joints that move; on a circle those of the tangent, counter-clockwise upwards, 0 of the joint
/// that turns round; of R-tests and ball bars with one rotary axis that moves, those of this axis
/// and of what follows it. Of all others they say nothing.
/// @param travel  1, -1, of each row; 0: not known
void set_directions(Group& group, const JointLayout& layout, const std::vector<int>& travel);

/// Rows at the same target in the same run and direction are faults, where runs are numbered.
void require_distinct_rows(const Group& group, std::vector<Fault>& faults);

/// Reads the file of an artefact's centres; faults are added to `faults`.
/// @throws InputError if it is no table
void read_balls(Artefact& artefact, std::vector<Fault>& faults);
/// Spheres of a group that the artefact does not have are faults.
void require_balls(const Artefact& artefact, const Group& group, std::vector<Fault>& faults);

}  // namespace servomill::sim::readings
