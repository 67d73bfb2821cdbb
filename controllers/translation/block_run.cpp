#include "controllers/translation/block_run.h"

#include <fmt/format.h>

#include <utility>

namespace servomill::controllers::translation {

std::optional<GcodeLine> BlockRun::next(const std::function<void()>& run_block) {
  while (lines_.is_empty()) {
    if (error_) throw InputError(*std::exchange(error_, std::nullopt));
    if (has_ended_) return std::nullopt;
    try {
      run_block();
    } catch (const InputError& error) {
      hold_back(error);
    }
  }
  return lines_.take();
}

void BlockRun::hold_back(const InputError& error) {
  error_ = error;
  has_ended_ = true;
  try {
    path_.flush();
  } catch (const InputError&) {  // caused by the first fault
  }
}

void BlockRun::count_block(const Place& place) {
  constexpr long kBlocksOfJump = 10;
  if (jumps_ == 0 || ++blocks_ / kBlocksOfJump <= most_jumps_) return;
  jumps_ = most_jumps_;
  count_jump(place);
}

void BlockRun::count_jump(const Place& place) {
  if (++jumps_ <= most_jumps_) return;
  throw InputError(
      place,
      fmt::format("{} jumps: the program appears to loop endlessly; raise --max-jumps if intended",
                  most_jumps_));
}

}  // namespace servomill::controllers::translation
