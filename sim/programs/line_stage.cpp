#include "sim/programs/line_stage.h"

#include <algorithm>
#include <fstream>
#include <iterator>

namespace servomill::sim::programs {
namespace {

// 0, not known, for a file that cannot be read: that is reported where it is read.
double lines_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  using Bytes = std::istreambuf_iterator<char>;
  return static_cast<double>(std::count(Bytes(in), Bytes(), '\n'));
}

}  // namespace

LineStage::LineStage(const std::string& file) : stage_("lines", lines_of(file)) {}

void LineStage::at(int line) {
  farthest_ = std::max(farthest_, line);
  stage_.reach(farthest_);
}

}  // namespace servomill::sim::programs
