#include "tests/pattern.h"

#include <regex>

namespace servomill {

struct Pattern::Compiled {
  std::regex regex;
};

Pattern::Pattern(const std::string& text)
    : compiled_(std::make_shared<const Compiled>(Compiled{std::regex(text)})) {}

bool Pattern::matches(const std::string& text) const {
  return std::regex_match(text, compiled_->regex);
}

bool Pattern::is_found_in(const std::string& text) const {
  return std::regex_search(text, compiled_->regex);
}

std::vector<std::string> Pattern::parts_of(const std::string& text) const {
  std::smatch match;
  if (!std::regex_match(text, match, compiled_->regex)) return {};
  return {match.begin(), match.end()};
}

std::string Pattern::replaced(const std::string& text, const std::string& by) const {
  return std::regex_replace(text, compiled_->regex, by);
}

}  // namespace servomill
