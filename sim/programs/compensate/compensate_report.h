/// Sentences about a corrected program: what its result relies on, what became of its loops and
/// cycles, and what the machine cannot reach or correct.
#pragma once

#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/programs/compensate/compensate.h"
#include "sim/programs/compensate/work_knowledge.h"

namespace servomill::sim::programs {

/// Assumptions that the result relies on: work offsets, tool lengths, the start of the machine.
std::vector<std::string> assumptions(const CompensateRequest& request, const WorkKnowledge& known,
                                     const Summary& summary, const JointLayout& layout);

/// Parts of the program that are written as plain moves and numbers.
std::vector<std::string> unrolled_parts(const Summary& summary);

/// Warnings of blocks outside the travel, and of errors that are not corrected.
std::vector<Fault> warnings_of(const CompensateRequest& request, const Summary& summary,
                               const JointLayout& layout);

}  // namespace servomill::sim::programs
