/// Memory of mapped files, for tests of what gives it back.
#pragma once

#include <cstdio>
#include <fstream>
#include <string>

namespace servomill {

/// Bytes of mapped files that are in memory (Linux: proc(5), "RssFile").
inline double mapped_bytes_in_memory() {
  std::ifstream status("/proc/self/status");
  std::size_t kilobytes = 0;
  for (std::string line; std::getline(status, line);) {
    if (std::sscanf(line.c_str(), "RssFile: %zu", &kilobytes) == 1) break;
  }
  return 1024.0 * static_cast<double>(kilobytes);
}

}  // namespace servomill
