#include "sim/system/shared_texts.h"

namespace servomill::sim::system {

SharedTexts::Text SharedTexts::shared(const Text& text) {
  const std::scoped_lock lock(mutex_);
  std::erase_if(known_, [](const auto& known) { return known.expired(); });
  for (const auto& known : known_) {
    if (Text held = known.lock(); held && (held == text || *held == *text)) return held;
  }
  known_.push_back(text);
  return text;
}

}  // namespace servomill::sim::system
