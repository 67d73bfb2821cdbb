#include "sim/system/memory_limit.h"

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

namespace servomill::sim::system {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

// The least limit of a group and those that hold it.
// @param name  of the files with the limits; one without a number ("max") sets none
double least_limit(const std::filesystem::path& mount, std::filesystem::path group,
                   const char* name) {
  double least = kNoLimit;
  for (;; group = group.parent_path()) {
    double most = 0.0;
    if (std::ifstream(mount / group.relative_path() / name) >> most) least = std::min(least, most);
    if (group == group.parent_path()) return least;
  }
}

}  // namespace

// Lines are NUMBER:CONTROLLERS:GROUP; version 2 has number 0 and names no controllers.
double memory_of_groups(const std::filesystem::path& groups, const std::filesystem::path& root) {
  double least = kNoLimit;
  std::ifstream lines(groups);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const std::filesystem::path group = line.substr(second + 1);
    if (controllers.empty()) {
      least = std::min(least, least_limit(root, group, "memory.max"));
    } else if (("," + controllers + ",").find(",memory,") != std::string::npos) {
      least = std::min(least, least_limit(root / "memory", group, "memory.limit_in_bytes"));
    }
  }
  return least;
}

// The second number is that of resident pages.
double resident_memory() {
  double all = 0.0, resident = 0.0;
  if (!(std::ifstream("/proc/self/statm") >> all >> resident)) return 0.0;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

void return_large_blocks() {
  constexpr int kLarge = 4 << 20, kKept = 64 << 20;
  mallopt(M_MMAP_THRESHOLD, kLarge);
  mallopt(M_TRIM_THRESHOLD, kKept);
}

double memory_of_process() {
  double memory =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
    memory = std::min(memory, static_cast<double>(limit.rlim_cur));
  }
  // asked for each point of a sweep; the files take longer to read than a tenth of a short run
  static const double groups = memory_of_groups("/proc/self/cgroup", "/sys/fs/cgroup");
  return std::min(memory, groups);
}

}  // namespace servomill::sim::system
