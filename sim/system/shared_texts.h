/// Long texts, each held once.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "plant/vocabulary/stored_text.h"

namespace servomill::sim::system {

/// Equal texts become one object, whose address then stands for the text (MemoKey::add_shared).
/// Holds none of them itself. For any number of threads.
class SharedTexts {
 public:
  using Text = std::shared_ptr<const StoredText>;

  /// The text that equals this one and is still held by somebody, or else this one.
  Text shared(const Text& text);

 private:
  std::mutex mutex_;
  std::vector<std::weak_ptr<const StoredText>> known_;
};

}  // namespace servomill::sim::system
