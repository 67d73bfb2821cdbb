#include "sim/programs/line_stage.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <vector>

namespace servomill::sim::programs {
namespace {

constexpr std::uintmax_t kMaxCounted = 500'000'000;  // bytes: counting more would take a second
constexpr std::size_t kAtOnce = 1U << 20;

// 0, not known, for a large file, and for one that cannot be read: that is reported where it is
// read.
double lines_of(const std::string& file) {
  std::error_code fault;
  const std::uintmax_t size = std::filesystem::file_size(file, fault);
  if (fault || size > kMaxCounted) return 0.0;
  std::ifstream in(file, std::ios::binary);
  std::vector<char> block(kAtOnce);
  double lines = 0.0;
  while (in) {
    in.read(block.data(), static_cast<std::streamsize>(block.size()));
    lines += static_cast<double>(std::count(block.begin(), block.begin() + in.gcount(), '\n'));
  }
  return lines;
}

}  // namespace

LineStage::LineStage(const std::string& file) : stage_("lines", lines_of(file)) {}

void LineStage::at(int line) {
  farthest_ = std::max(farthest_, line);
  stage_.reach(farthest_);
}

}  // namespace servomill::sim::programs
