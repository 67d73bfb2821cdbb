/// A value of a TOML document as a plain tree that remembers where everything was written.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "plant/vocabulary/input_error.h"

namespace servomill::sim::config {

struct Value {
  enum class Type : std::uint8_t { text, integer, real, boolean, date_time, list, table };

  Type type = Type::table;
  Place place;          // of the value
  std::string key;      // its name in the table that holds it; empty in a list and at the root
  Place key_place;      // of that name
  std::string written;  // a scalar as it stands in the document, quotes included: valid TOML

  // what it means; only the member of its type is set
  std::string text;
  std::int64_t integer = 0;
  double real = 0.0;
  bool boolean = false;
  std::vector<Value> children;  // items of a list, entries of a table, in the order of the document

  const Value* find(std::string_view name) const;  ///< entry of a table, or nullptr
  Value* find(std::string_view name);
};

/// Same meaning: places, spelling and the order of a table's entries do not count.
bool same_value(const Value& a, const Value& b);

/// "a text", "a table", ...: for messages.
std::string_view type_name(Value::Type type);

/// The value in one line: scalars as written, "[...]", "{...}" with their contents.
std::string inline_toml(const Value& value);

/// A table as a TOML document that reads again to the same values.
std::string to_toml(const Value& table);

/// `key` as TOML wants it: bare if possible, else quoted.
std::string quoted_key(std::string_view key);

/// `text` as a basic TOML string, quotes included.
std::string quoted_text(std::string_view text);

/// `path` and `key` joined by a dot; the path of the root is empty.
std::string joined_key(std::string_view path, std::string_view key);

}  // namespace servomill::sim::config
