/// A line of a program as a rule of a control rewrites it, and the column of the line as written
/// that each of its columns comes from.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace servomill::controllers {

class RewrittenLine {
 public:
  /// A line that says what the written one says, column by column.
  void set(std::string_view text);
  void clear();

  /// Appends a part of the written line.
  /// @param column  in it, from 1
  void copy(std::string_view text, int column) { put(text, column, true); }
  /// Appends text that stands for the word at that column of the written line.
  void replace(std::string_view text, int column) { put(text, column, false); }
  /// Removes such characters from the end.
  void trim_end(std::string_view blanks);

  const std::string& text() const { return text_; }

  /// Column in the line as written of one in text(); of replaced text that of its word.
  int original_column(int column) const;

 private:
  struct Run {
    int begin = 0;   // in text_, from 1
    int column = 0;  // in the line as written
    bool is_copied = false;
  };
  void put(std::string_view text, int column, bool is_copied);

  std::string text_;
  std::vector<Run> runs_;
};

}  // namespace servomill::controllers
