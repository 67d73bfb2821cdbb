/// The system failed: a disk is full, a folder cannot be written. Nobody wrote anything wrong.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace servomill {

/// what() is "PATH: error: ACTION: REASON", such as "out.h5.partial: error: cannot be written: No
/// space left on device".
class SystemError : public std::runtime_error {
 public:
  SystemError(std::string_view path, std::string_view action, std::string_view reason)
      : std::runtime_error(
            std::string(path).append(": error: ").append(action).append(": ").append(reason)) {}
};

}  // namespace servomill
