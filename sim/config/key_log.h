/// Record of the keys that readers ask a document for: name, type, unit, default and range. The
/// lists of keys in help texts are made from it, so that they cannot differ from the readers.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config/quantity.h"

namespace servomill::sim::config {

struct Rule;

enum class KeyType : std::uint8_t {
  asked,  // its presence or its raw value: the type is left to the other requests
  number,
  integer,
  boolean,
  text,
  choice,
  numbers,
  texts,
  rows,
  table,
  tables,
};

/// One request for a key.
struct KeyUse {
  std::string table;  // dotted path; items of lists without their number: "case.strategy"
  std::string key;
  KeyType type = KeyType::asked;
  bool required = false;
  std::string unit;                     // of a bare number; empty: none
  std::optional<std::string> fallback;  // as a user would write it; "": none
  std::string range;                    // "> 0 and <= 60"
  std::vector<std::string> words;       // of a choice
  bool operator==(const KeyUse&) const = default;
};

class KeyLog {
 public:
  /// Adds a request, once.
  void add(KeyUse use);
  /// All requests in the order of their first occurrence.
  std::span<const KeyUse> uses() const { return uses_; }

 private:
  std::vector<KeyUse> uses_;
};

/// Request for a key that must be there.
KeyUse required_request(KeyType type);
/// Request for a key that may be absent.
KeyUse optional_request(KeyType type, std::string_view fallback);
/// Request for a number or a list of numbers; without a fallback it is required.
KeyUse number_request(KeyType type, std::string_view key, Quantity quantity,
                      std::span<const Rule> rules, std::optional<double> fallback);
/// Request for a whole number.
KeyUse integer_request(std::span<const Rule> rules, std::optional<std::int64_t> fallback);
/// Request for one of some words.
KeyUse choice_request(std::span<const std::string_view> words, std::optional<std::size_t> fallback);

/// "> 0 and <= 60": bounds in a unit of this factor.
std::string range_text(std::span<const Rule> rules, double factor);

/// A path without the numbers of list items: "case[2].strategy[0]" is "case.strategy".
std::string without_items(std::string_view path);

}  // namespace servomill::sim::config
