/// Documents that are based on others: their key `based_on`.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "sim/config/value.h"

namespace servomill::sim::input {

/// Most documents that may stand on each other.
inline constexpr int kMaxBases = 8;

/// Name of a sort of documents, for messages.
struct DocumentKind {
  std::string_view one, several;  // "a scenario", "scenarios"
};

/// Takes the key `based_on` out of a document.
/// @param bases_left  how many more documents may follow
/// @return path of the file that it names; nothing where there is no such key
/// @throws InputError if it is no name of a file that is there, or one too many
std::optional<std::string> take_base(config::Value& root, const DocumentKind& kind, int bases_left);

}  // namespace servomill::sim::input
