/// Faults of writers, made in written programs on purpose.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "sim/programs/compensate/compensate.h"
#include "tests/text.h"

namespace servomill::sim::programs {

using Lines = std::vector<std::string>;

std::string text_of(const Lines& lines, Dialect dialect);
bool is_comment(const std::string& line);

/// Applies one kind of fault to a line. False: it does not fit there.
using Mutation = bool (*)(Lines&, std::size_t);

struct MutationKind {
  const char* name;
  Mutation apply;
};

std::span<const MutationKind> mutation_kinds();

}  // namespace servomill::sim::programs
