/// Files of readings in tests: a folder that goes with them.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "plant/kinematics/structure.h"
#include "sim/readings/readings.h"

namespace servomill::sim::readings {

class ReadingFiles {
 public:
  ReadingFiles() {
    std::string name = (std::filesystem::temp_directory_path() / "readings_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~ReadingFiles() { std::filesystem::remove_all(folder_); }
  ReadingFiles(const ReadingFiles&) = delete;
  ReadingFiles& operator=(const ReadingFiles&) = delete;

  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
    return path(name);
  }

 private:
  std::string folder_;
};

/// Three axes whose table stands, 0 to 1 m each.
inline plant::MachineChain gantry() {
  return plant::make_chain(plant::parse_structure("[w b X Y Z (C1) t]"));
}

inline Readings read_three_axis(const std::string& path) {
  return read_readings(path, gantry(), Joints::Zero(), Joints::Ones());
}

}  // namespace servomill::sim::readings
