#include "sim/config/key_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/config/rule.h"

namespace servomill::sim::config {

void KeyLog::add(KeyUse use) {
  if (std::find(uses_.begin(), uses_.end(), use) == uses_.end()) uses_.push_back(std::move(use));
}

KeyUse required_request(KeyType type) {
  KeyUse use;
  use.type = type;
  use.required = true;
  return use;
}

KeyUse optional_request(KeyType type, std::string_view fallback) {
  KeyUse use;
  use.type = type;
  use.fallback = fallback;
  return use;
}

KeyUse number_request(KeyType type, std::string_view key, Quantity quantity,
                      std::span<const Rule> rules, std::optional<double> fallback) {
  const Unit unit = unit_of_key(key, quantity).value_or(Unit{si_unit(quantity), quantity, 1.0});
  KeyUse use = fallback ? optional_request(type, "") : required_request(type);
  if (quantity != kNumber) use.unit = unit.symbol;
  use.range = range_text(rules, unit.factor);
  if (fallback) {
    const double value = *fallback / unit.factor;
    use.fallback = std::isfinite(value) ? fmt::format("{:.6g}", value) : std::string();
  }
  return use;
}

KeyUse integer_request(std::span<const Rule> rules, std::optional<std::int64_t> fallback) {
  KeyUse use =
      fallback ? optional_request(KeyType::integer, "") : required_request(KeyType::integer);
  use.range = range_text(rules, 1.0);
  if (fallback) use.fallback = fmt::format("{}", *fallback);
  return use;
}

KeyUse choice_request(std::span<const std::string_view> words,
                      std::optional<std::size_t> fallback) {
  KeyUse use = fallback ? optional_request(KeyType::choice, "") : required_request(KeyType::choice);
  use.words.assign(words.begin(), words.end());
  if (fallback) use.fallback = words[*fallback];
  return use;
}

std::string range_text(std::span<const Rule> rules, double factor) {
  std::string out;
  for (const Rule& rule : rules) {
    out += fmt::format("{}{} {:.6g}", out.empty() ? "" : " and ", symbol_of(rule.comparison),
                       rule.bound / factor);
  }
  return out;
}

std::string without_items(std::string_view path) {
  std::string out;
  bool in_item = false;
  for (const char c : path) {
    if (c == '[') in_item = true;
    if (!in_item) out += c;
    if (c == ']') in_item = false;
  }
  return out;
}

}  // namespace servomill::sim::config
