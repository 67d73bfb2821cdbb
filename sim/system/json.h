/// JSON as commands print it: on one line, keys in the order in which they are added.
#pragma once

#include <concepts>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace servomill::sim::system {

/// A text between quotes.
std::string json_text(std::string_view text);

/// Nine digits; null for what is not finite.
std::string json_number(double value);

/// Behind commas and colons.
enum class JsonSpacing : std::uint8_t { blank, none };

/// A list of texts.
std::string json_texts(std::span<const std::string> texts,
                       JsonSpacing spacing = JsonSpacing::blank);

/// A list of what is JSON already.
std::string json_list(std::span<const std::string> items, JsonSpacing spacing = JsonSpacing::blank);

/// JsonObject().text("axis", "X").number("Kv", 33.3).line() is {"axis": "X", "Kv": 33.3}
class JsonObject {
 public:
  explicit JsonObject(JsonSpacing spacing = JsonSpacing::blank) : spacing_(spacing) {}

  JsonObject& text(std::string_view key, std::string_view value);
  /// null if empty
  JsonObject& text_or_null(std::string_view key, std::string_view value);
  JsonObject& number(std::string_view key, double value);
  /// With that many decimals; null for what is not finite.
  JsonObject& fixed(std::string_view key, double value, int decimals);
  JsonObject& integer(std::string_view key, std::integral auto value) {
    return raw(key, std::to_string(value));
  }
  JsonObject& boolean(std::string_view key, bool value);
  /// A value that is JSON already.
  JsonObject& raw(std::string_view key, std::string_view json);

  std::string line() const { return "{" + members_ + "}"; }

 private:
  JsonSpacing spacing_;
  std::string members_;
};

}  // namespace servomill::sim::system
