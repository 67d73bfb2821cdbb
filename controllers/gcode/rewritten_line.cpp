#include "controllers/gcode/rewritten_line.h"

namespace servomill::controllers {

void RewrittenLine::set(std::string_view text) {
  clear();
  text_ = text;
}

void RewrittenLine::clear() {
  text_.clear();
  runs_.clear();
}

void RewrittenLine::put(std::string_view text, int column, bool is_copied) {
  if (text.empty()) return;
  runs_.push_back({static_cast<int>(text_.size()) + 1, column, is_copied});
  text_ += text;
}

void RewrittenLine::trim_end(std::string_view blanks) {
  text_.erase(text_.find_last_not_of(blanks) + 1);
}

int RewrittenLine::original_column(int column) const {
  if (column <= 0) return column;
  int out = column;
  for (const Run& run : runs_) {
    if (run.begin > column) break;
    out = run.column + (run.is_copied ? column - run.begin : 0);
  }
  return out;
}

}  // namespace servomill::controllers
