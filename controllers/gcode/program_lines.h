/// The lines of a program, and what a '%' among them means.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace servomill::controllers {

inline bool is_blank(std::string_view line) {
  return line.find_first_not_of(" \t\r") == std::string_view::npos;
}

/// Hands out the lines of a text.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  bool next(std::string_view& line) {
    if (rest_.empty()) return false;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++number_;
    return true;
  }
  int number() const { return number_; }
  /// How many are left.
  std::size_t count() const {
    const auto ends = std::count(rest_.begin(), rest_.end(), '\n');
    return static_cast<std::size_t>(ends) + (rest_.empty() || rest_.back() == '\n' ? 0 : 1);
  }

 private:
  std::string_view rest_;
  int number_ = 0;
};

/// What a '%' means where it stands.
enum class Percent { start, end, misplaced };

class PercentRule {
 public:
  void saw_line() { first_ = false; }
  Percent saw_percent() {
    const Percent meaning = first_ ? Percent::start : open_ ? Percent::end : Percent::misplaced;
    if (meaning == Percent::start) open_ = true;
    first_ = false;
    return meaning;
  }

 private:
  bool first_ = true;
  bool open_ = false;
};

}  // namespace servomill::controllers
