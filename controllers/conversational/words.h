/// Words of a conversational block, taken out one by one: what is left is refused by name.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/conversational/q_parameters.h"
#include "controllers/dialects/heidenhain_block.h"

namespace servomill::controllers::conversational {

/// The words of a block behind its keyword. Blanks between an address and its number ("X +10", "F
/// MAX") are taken out first.
class Words {
 public:
  explicit Words(std::span<const HeidenhainWord> words);

  /// Takes the word with exactly this text.
  const HeidenhainWord* take(std::string_view text);
  /// Takes the word with this address and a number or Q parameter behind it.
  /// @throws InputError if what follows is neither
  std::optional<Operand> take_number(std::string_view address);
  /// Takes the next word, whatever it is; nullptr behind the last.
  const HeidenhainWord* take_next();
  /// The next word, which stays.
  const HeidenhainWord* peek() const;
  bool is_empty() const { return peek() == nullptr; }
  /// @throws InputError that names the first word left
  void refuse_rest(std::string_view block) const;

 private:
  std::vector<HeidenhainWord> words_;
  std::vector<bool> taken_;
};

/// A number or a signed Q parameter: "+10", "10,5", "-Q3", "Q5".
/// @throws InputError
Operand operand_of(std::string_view text, const Place& place);

/// An integer in a word: number of a label, a tool, a cycle.
std::optional<long> integer_of(std::string_view text);

}  // namespace servomill::controllers::conversational
