#include <fmt/format.h>

#include <cmath>
#include <span>

#include "controllers/conversational/conversational.h"
#include "controllers/gcode/reader.h"
#include "controllers/gcode/readers/differences.h"
#include "controllers/siemens/siemens.h"
#include "sim/evaluation/quantity.h"
#include "sim/input/listings.h"
#include "sim/system/json.h"
#include "strategies/registry.h"

namespace servomill::sim::input {
namespace {

using system::JsonObject;

std::vector<std::string> texts(std::span<const std::string_view> views) {
  return {views.begin(), views.end()};
}

// A bound that the parameter has; null where it has none.
std::string bound_json(double bound) {
  constexpr double kNoBound = 1e300;
  return std::abs(bound) < kNoBound ? system::json_number(bound) : "null";
}

std::string parameter_json(const ParameterSpec& p) {
  return JsonObject()
      .text("key", p.name)
      .text("help", p.help)
      .boolean("is_number", p.is_number)
      .text_or_null("unit", p.unit)
      .raw("min", bound_json(p.min))
      .raw("max", bound_json(p.max))
      .raw("words", system::json_texts(texts(p.words)))
      .text_or_null("default", p.default_text)
      .line();
}

std::string rule_json(std::string_view found, std::string_view reading, std::string_view controls,
                      std::span<const std::string> readers, std::string_view source) {
  return JsonObject()
      .text("found", found)
      .text("reading", reading)
      .text("controls", controls)
      .raw("readers", system::json_texts(readers))
      .text("source", source)
      .line();
}

// @param readers  a bit each
std::vector<std::string> readers_of(std::uint8_t readers) {
  std::vector<std::string> out;
  for (std::size_t k = 0; k < controllers::kReaders.size(); ++k) {
    if ((readers >> k & 1U) != 0U) out.emplace_back(controllers::kReaders[k]);
  }
  return out;
}

std::vector<std::string> readers_with(controllers::ReaderRule rule) {
  std::vector<std::string> out;
  for (std::size_t k = 0; k < controllers::kReaders.size(); ++k) {
    if (controllers::has_rule(static_cast<controllers::Reader>(k), rule)) {
      out.emplace_back(controllers::kReaders[k]);
    }
  }
  return out;
}

}  // namespace

std::vector<std::string> strategies_json() {
  std::vector<std::string> out;
  for (const std::string_view name : strategies::names()) {
    const strategies::Entry& entry = *strategies::find(name);
    std::vector<std::string> parameters;
    for (const ParameterSpec& one : entry.parameters) parameters.push_back(parameter_json(one));
    out.push_back(JsonObject()
                      .text("strategy", entry.name)
                      .text("help", entry.summary)
                      .raw("keys", system::json_list(parameters))
                      .line());
  }
  return out;
}

std::vector<std::string> quantities_json() {
  std::vector<std::string> out;
  for (const evaluation::QuantityEntry& one : evaluation::quantities()) {
    out.push_back(JsonObject()
                      .text("quantity", one.name)
                      .text("unit", one.unit)
                      .text("help", one.help)
                      .line());
  }
  return out;
}

std::vector<std::string> reader_rules_json() {
  std::vector<std::string> out;
  for (const controllers::ReaderRuleEntry& one : controllers::reader_rules()) {
    out.push_back(
        rule_json(one.found, one.reading, one.controls, readers_with(one.rule), one.source));
  }
  const std::vector<std::string> conversational = {"any", "heidenhain"};
  for (const auto& one : controllers::conversational::readings()) {
    out.push_back(rule_json(fmt::format("conversational: {}", one.found), one.reading, one.controls,
                            conversational, one.source));
  }
  const std::vector<std::string> siemens = {"any", "siemens"};
  for (const auto& one : controllers::siemens::readings()) {
    out.push_back(rule_json(fmt::format("Siemens: {}", one.found), one.reading, one.controls,
                            siemens, one.source));
  }
  for (const controllers::WordDifferenceEntry& one : controllers::word_differences()) {
    for (const controllers::WordReading& reading : one.readings) {
      out.push_back(rule_json(one.found, reading.text, reading.controls,
                              readers_of(reading.readers), one.source));
    }
  }
  return out;
}

}  // namespace servomill::sim::input
