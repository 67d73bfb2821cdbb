/// Parameters declared as data: from one table follow the allowed keys, the checks, the messages
/// and the help text.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>

namespace servomill {

/// The shortcoming of a strategy that a parameter sets. Error budgets take one away, studies of
/// convergence refine one, without knowing the strategy or the parameter.
enum class Shortcoming : std::uint8_t {
  none,
  points,             // of tables, and what lies between them
  delay,              // response, dead time, update
  saturation,         // limits of what it displaces
  single_evaluation,  // errors evaluated where displacing changes them
  identification,     // knows less than the case has
  measurement,        // of what it learns from
  chord_tolerance,    // of rewritten programs: the square of the length of blocks
  block_length,       // of rewritten programs
};

/// One parameter of a strategy. Numbers are in the unit that the name's suffix tells (as the user
/// writes them); the reader converts to SI.
struct ParameterSpec {
  std::string_view name;               // TOML key, with its unit suffix
  std::string_view help;               // one line
  std::string_view unit = {};          // of the bare number; "" is dimensionless
  std::string_view default_text = {};  // number or word as the user would write it; "": required
  double min = -1e300, max = 1e300;    // inclusive, in `unit`
  bool is_number = true;               // false: only words are allowed
  std::span<const std::string_view> words = {};  // words allowed (beside the number)
  Shortcoming shortcoming = Shortcoming::none;   // that it sets
  std::string_view ideal = {};  // number or word without it, as the user would write it; "": it can
                                // be refined, not taken away
};

/// Values read for such a table: numbers in SI, or one of the words.
class Parameters {
 public:
  void set(std::string_view name, double value_si) { numbers_[std::string(name)] = value_si; }
  void set(std::string_view name, std::string_view word) { words_[std::string(name)] = word; }

  bool is_word(std::string_view name) const { return words_.contains(std::string(name)); }
  double number(std::string_view name) const { return numbers_.at(std::string(name)); }
  const std::string& word(std::string_view name) const { return words_.at(std::string(name)); }

 private:
  std::map<std::string, double> numbers_;
  std::map<std::string, std::string> words_;
};

}  // namespace servomill
