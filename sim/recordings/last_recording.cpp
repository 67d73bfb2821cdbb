#include "sim/recordings/last_recording.h"

#include "sim/recordings/read_recording.h"

namespace servomill::sim::recordings {

const Recording& LastRecording::read(const std::string& path, const std::string& time_unit) {
  if (!recording_ || path != path_ || time_unit != time_unit_) {
    recording_.reset();  // memory for one is enough
    recording_ = read_recording(path, time_unit);
    path_ = path;
    time_unit_ = time_unit;
  }
  return *recording_;
}

}  // namespace servomill::sim::recordings
