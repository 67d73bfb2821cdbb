/// The system failed: a disk is full, a folder cannot be written. Nobody wrote anything wrong.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace servomill::sim {

/// what() is "PATH: ACTION: REASON", such as "out.h5.partial: cannot be written: No space left on
/// device".
class SystemError : public std::runtime_error {
 public:
  SystemError(std::string_view path, std::string_view action, std::string_view reason)
      : std::runtime_error(
            std::string(path).append(": ").append(action).append(": ").append(reason)) {}
};

}  // namespace servomill::sim
