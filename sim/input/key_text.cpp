#include "sim/input/key_text.h"

#include <fmt/format.h>

#include "sim/system/json.h"

namespace servomill::sim::input {
namespace {

constexpr std::string_view kDefault = "default ";
constexpr std::string_view kDefaultFollows = "default depends";

std::string_view section_name(const KeyEntry& key) {
  return key.section.empty() ? kTopSection : std::string_view(key.section);
}

// Empty without a default, and where it follows from other keys.
std::string_view default_of(const KeyEntry& key) {
  const std::string_view presence = key.presence;
  if (!presence.starts_with(kDefault) || presence.starts_with(kDefaultFollows)) return {};
  return presence.substr(kDefault.size());
}

// Text that a cell of a table may hold.
std::string in_cell(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '|' || c == '*' || c == '_' || c == '<' || c == '[') out += '\\';
    out += c;
  }
  return out;
}

constexpr std::string_view kPreface =
    "# Keys of scenarios and machines\n\n"
    "Written by `servomill list keys --markdown`, from what the readers ask for; a test compares. "
    "How values are written: [README.md](README.md). Keys outside of sections come first; machine "
    "files leave out `machine.`; NAME, X, EXX, EX0C, EC0Y and KEY stand for any such name. "
    "\"Required\" is meant where the key applies.\n";

}  // namespace

std::string as_text(std::span<const KeyEntry> keys) {
  std::string out, last;
  for (const KeyEntry& one : keys) {
    if (out.empty() || one.section != last) {
      out += fmt::format("{}[{}]\n", out.empty() ? "" : "\n", section_name(one));
    }
    last = one.section;
    out += fmt::format("  {:<24} {} [{}{}{}; {}]\n", one.key, one.help, one.type,
                       one.range.empty() ? "" : ", ", one.range, one.presence);
  }
  return out;
}

std::string as_markdown(std::span<const KeyEntry> keys) {
  std::string out(kPreface), last;
  bool begun = false;
  for (const KeyEntry& one : keys) {
    if (!begun || one.section != last) {
      out += fmt::format(
          "\n## {}\n\n| key | meaning | type | range | presence |\n|---|---|---|---|---|\n",
          in_cell(section_name(one)));
    }
    begun = true;
    last = one.section;
    out += fmt::format("| `{}` | {} | {} | {} | {} |\n", one.key, in_cell(one.help),
                       in_cell(one.type), in_cell(one.range), in_cell(one.presence));
  }
  return out;
}

std::vector<std::string> keys_json(std::span<const KeyEntry> keys) {
  std::vector<std::string> out;
  for (const KeyEntry& one : keys) {
    system::JsonObject line;
    line.text_or_null("section", one.section).text("key", one.key).text("help", one.help);
    line.text("type", one.type).text_or_null("unit", one.unit).text_or_null("range", one.range);
    line.text("presence", one.presence).text_or_null("default", default_of(one));
    out.push_back(line.line());
  }
  return out;
}

}  // namespace servomill::sim::input
