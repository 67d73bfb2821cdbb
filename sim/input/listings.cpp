#include "sim/input/listings.h"

#include <fmt/format.h>

#include "controllers/conversational/conversational.h"
#include "controllers/gcode/reader.h"
#include "controllers/gcode/readers/differences.h"
#include "controllers/siemens/siemens.h"
#include "sim/config/document.h"
#include "sim/evaluation/quantity.h"
#include "strategies/registry.h"

namespace servomill::sim::input {
namespace {

std::string describe(const strategies::Entry& entry) {
  std::string out = fmt::format("{}: {}\n", entry.name, entry.summary);
  for (const ParameterSpec& p : entry.parameters) {
    std::string allowed = p.is_number ? (p.unit.empty() ? "number" : std::string(p.unit)) : "";
    for (const std::string_view word : p.words) {
      allowed += fmt::format("{}\"{}\"", allowed.empty() ? "" : " | ", word);
    }
    out += fmt::format("  {:<20} {} [{}; default {}]\n", p.name, p.help, allowed,
                       p.default_text.empty() ? "none" : p.default_text);
  }
  return out + '\n';
}

}  // namespace

std::string describe_strategies() {
  std::string out;
  for (const std::string_view name : strategies::names()) out += describe(*strategies::find(name));
  return out;
}

std::string describe_quantities() {
  std::string out;
  for (const evaluation::QuantityEntry& info : evaluation::quantities()) {
    out += fmt::format("{:<24} {:<3} {}\n", info.name, info.unit, info.help);
  }
  return out;
}

std::string describe_reader_rules() {
  using controllers::Reader;
  std::string out;
  for (const controllers::ReaderRuleEntry& rule : controllers::reader_rules()) {
    std::string readers;
    for (std::size_t k = 0; k < controllers::kReaders.size(); ++k) {
      if (!controllers::has_rule(static_cast<Reader>(k), rule.rule)) continue;
      readers += fmt::format("{}{}", readers.empty() ? "" : ", ", controllers::kReaders[k]);
    }
    out += fmt::format("{}: {}\n  controls: {}\n  --reader: {}\n  source: {}\n", rule.found,
                       rule.reading, rule.controls, readers, rule.source);
  }
  for (const auto& reading : controllers::conversational::readings()) {
    out += fmt::format(
        "conversational: {}: {}\n  controls: {}\n  --reader: any, heidenhain\n"
        "  source: {}\n",
        reading.found, reading.reading, reading.controls, reading.source);
  }
  for (const auto& reading : controllers::siemens::readings()) {
    out += fmt::format(
        "Siemens: {}: {}\n  controls: {}\n  --reader: any, siemens\n"
        "  source: {}\n",
        reading.found, reading.reading, reading.controls, reading.source);
  }
  out +=
      "\nread differently by different controls, and refused unless --reader or another option "
      "selects one:\n";
  for (const controllers::WordDifferenceEntry& one : controllers::word_differences()) {
    out +=
        fmt::format("{}\n  source: {}\n", controllers::both_readings(one.difference), one.source);
  }
  return out;
}

std::string title_of(const std::string& path) {
  const config::Document document = config::Document::from_file(path);
  for (const char* key : {"title", "name"}) {
    if (const config::Value* value = document.root().find(key)) return value->text;
  }
  return "";
}

}  // namespace servomill::sim::input
