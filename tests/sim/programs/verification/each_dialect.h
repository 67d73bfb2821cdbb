/// All dialects as the parameters of a test, and their names.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "sim/programs/compensate/compensate.h"

namespace servomill::sim::programs {

inline auto each_dialect() {
  return testing::Values(Dialect::linuxcnc, Dialect::heidenhain, Dialect::fanuc, Dialect::siemens);
}

inline std::string name_of_dialect(const testing::TestParamInfo<Dialect>& info) {
  return std::string(kDialects[static_cast<std::size_t>(info.param)]);
}

}  // namespace servomill::sim::programs
