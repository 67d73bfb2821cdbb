/// One file read for several uses.
#pragma once

#include <optional>
#include <string>

#include "sim/recordings/recording.h"

namespace servomill::sim::recordings {

/// Reads recordings and keeps the last one: the recordings of several axes are often parts of one
/// file.
class LastRecording {
 public:
  /// As read_recording(). The result is valid until another file is read.
  const Recording& read(const std::string& path, const std::string& time_unit = "");

 private:
  std::string path_, time_unit_;
  std::optional<Recording> recording_;
};

}  // namespace servomill::sim::recordings
