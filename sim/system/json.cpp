#include "sim/system/json.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

namespace servomill::sim::system {

std::string json_text(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20) {
      out += fmt::format("\\u{:04x}", static_cast<int>(c));
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string json_number(double value) {
  return std::isfinite(value) ? fmt::format("{:.9g}", value) : "null";
}

std::string json_list(std::span<const std::string> items, JsonSpacing spacing) {
  return fmt::format("[{}]", fmt::join(items, spacing == JsonSpacing::blank ? ", " : ","));
}

std::string json_texts(std::span<const std::string> texts, JsonSpacing spacing) {
  std::vector<std::string> items;
  for (const std::string& text : texts) items.push_back(json_text(text));
  return json_list(items, spacing);
}

JsonObject& JsonObject::raw(std::string_view key, std::string_view json) {
  const bool is_spaced = spacing_ == JsonSpacing::blank;
  if (!members_.empty()) members_ += is_spaced ? ", " : ",";
  members_ += json_text(key);
  members_ += is_spaced ? ": " : ":";
  members_ += json;
  return *this;
}

JsonObject& JsonObject::text(std::string_view key, std::string_view value) {
  return raw(key, json_text(value));
}

JsonObject& JsonObject::text_or_null(std::string_view key, std::string_view value) {
  return raw(key, value.empty() ? "null" : json_text(value));
}

JsonObject& JsonObject::number(std::string_view key, double value) {
  return raw(key, json_number(value));
}

JsonObject& JsonObject::fixed(std::string_view key, double value, int decimals) {
  return raw(key, std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "null");
}

JsonObject& JsonObject::boolean(std::string_view key, bool value) {
  return raw(key, value ? "true" : "false");
}

}  // namespace servomill::sim::system
