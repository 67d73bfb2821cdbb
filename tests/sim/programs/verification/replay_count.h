/// Outcomes of many compensated programs.
#pragma once

#include <map>
#include <string>

#include "sim/programs/compensate/compensate.h"

namespace servomill::sim::programs {

/// Refusals by the writer's own words are counted apart from those by the verification: a user can
/// act on the first, the second are faults of the writer or the reader.
struct ReplayCount {
  int verified = 0, refused = 0, differing = 0;
  std::map<std::string, int> reasons;  // of refusals, without numbers

  /// Compensates one program. @return the message, where the verification refuses it
  std::string add(const CompensateRequest& request);
  /// One line, and the reasons that are given at least `often` times.
  void print(Dialect dialect, int often = 1) const;
};

}  // namespace servomill::sim::programs
