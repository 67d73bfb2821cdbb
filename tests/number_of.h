/// Counts that the environment can change: fewer under sanitizers, more for a long search.
#pragma once

#include <cstdlib>

namespace servomill {

inline int number_of(const char* variable, int otherwise) {
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : std::atoi(text);
}

}  // namespace servomill
