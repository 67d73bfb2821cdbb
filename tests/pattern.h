/// Regular expressions (ECMAScript) of tests. <regex> takes g++ some seconds in every source that
/// uses it: pattern.cpp is the only one.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace servomill {

class Pattern {
 public:
  explicit Pattern(const std::string& text);

  /// True if the pattern describes the whole text.
  bool matches(const std::string& text) const;
  /// True if it describes a part of the text.
  bool is_found_in(const std::string& text) const;
  /// The parts in parentheses, behind the whole text; nothing if the pattern does not describe it.
  std::vector<std::string> parts_of(const std::string& text) const;
  /// The text with `by` in place of every part that the pattern describes; $1 is its first part.
  std::string replaced(const std::string& text, const std::string& by) const;

 private:
  struct Compiled;
  std::shared_ptr<const Compiled> compiled_;
};

}  // namespace servomill
