/// Words of a conversational block, taken one by one; an unused word is refused by name.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/conversational/q_parameters.h"
#include "controllers/dialects/heidenhain_block.h"

namespace servomill::controllers::conversational {

/// The words of a block after its keyword. Blanks between an address and its number ("X +10", "F
/// MAX") are removed first.
class Words {
 public:
  explicit Words(std::span<const HeidenhainWord> words);

  /// Takes the word that reads exactly `text`; nullptr if the block has none.
  const HeidenhainWord* take(std::string_view text);
  /// Takes the word with this address and returns its number or Q parameter; nullopt if the block
  /// has no such word.
  /// @throws InputError if the address is followed by neither
  std::optional<Operand> take_number(std::string_view address);
  /// Takes the next word; nullptr after the last.
  const HeidenhainWord* take_next();
  /// The next word, which is not taken.
  const HeidenhainWord* peek() const;
  bool is_empty() const { return peek() == nullptr; }
  /// @throws InputError naming the first word that was not taken
  void refuse_rest(std::string_view block) const;

 private:
  void drop_skipped_entries();

  std::vector<HeidenhainWord> words_;
  std::vector<bool> taken_;
};

/// A number or a signed Q parameter: "+10", "10,5", "-Q3", "Q5".
/// @throws InputError
Operand operand_of(std::string_view text, const Place& place);

/// The integer that a word holds: the number of a label, a tool or a cycle.
std::optional<long> integer_of(std::string_view text);

}  // namespace servomill::controllers::conversational
