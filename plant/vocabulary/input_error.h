/// The one error type for what a user wrote wrong: TOML, G-code, tables, the command line.
#pragma once

#include <exception>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace servomill {

/// Place of a fault. Line and column count from 1; 0 means "unknown", and is not printed.
struct Place {
  std::string file;
  int line = 0;
  int column = 0;
  bool operator==(const Place&) const = default;
};

/// "file:line:column" as far as known.
std::string to_string(const Place& place);

/// One fault: its place and a sentence that names key, value and rule.
struct Fault {
  Place place;
  std::string message;
};

/// "file:line:column: error: message"
std::string to_string(const Fault& fault);

/// All faults found in one input. what() is one line a fault, in order of place.
class InputError : public std::exception {
 public:
  explicit InputError(std::vector<Fault> faults);
  InputError(Place place, std::string message);

  const std::vector<Fault>& faults() const { return faults_; }
  const char* what() const noexcept override { return text_.c_str(); }

 private:
  std::vector<Fault> faults_;
  std::string text_;
};

/// The candidate that `word` most likely means (edit distance at most a third of its length,
/// rounded up), or an empty view. Ties go to the earlier candidate.
std::string_view nearest_name(std::string_view word, std::span<const std::string_view> candidates);

/// "; did you mean 'X'?" or "" when no candidate is near.
std::string did_you_mean(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace servomill
