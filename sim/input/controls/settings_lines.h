/// Lines, words and numbers of settings files, with their places.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plant/vocabulary/input_error.h"

namespace servomill::sim::input {

/// A line without blanks around it.
struct SettingsLine {
  std::string_view text;
  Place place;  // of its first character
};

std::vector<SettingsLine> settings_lines(std::string_view text, const std::string& file);

std::string_view without_blanks(std::string_view text);

/// Gathers faults, so that a reader reports all of them.
class SettingsFaults {
 public:
  void add(Place place, std::string message) {
    faults_.push_back({std::move(place), std::move(message)});
  }
  /// A number, or a fault and none.
  std::optional<double> number(const Place& place, const std::string& key, std::string_view text);
  /// The same, which must be > 0.
  std::optional<double> positive(const Place& place, const std::string& key, std::string_view text);
  /// @throws InputError if there are any
  void finish();

 private:
  std::vector<Fault> faults_;
};

}  // namespace servomill::sim::input
