#include "controllers/gcode/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace servomill::controllers {
namespace {

constexpr std::uint8_t bit(Reader reader) {
  return static_cast<std::uint8_t>(1U << static_cast<unsigned>(reader));
}
constexpr std::uint8_t kFanuc = bit(Reader::fanuc), kHaas = bit(Reader::haas),
                       kMach = bit(Reader::mach), kGrbl = bit(Reader::grbl),
                       kAll = kFanuc | kHaas | kMach | kGrbl;

using enum ReaderRule;

constexpr auto kRules = std::to_array<ReaderRuleEntry>({
    {end_of_text, "a text that ends without M2, M30 or a closing '%'", "read as if M2 followed",
     "grbl, Mach", kGrbl | kMach,
     "Milltronics, System information, PL-551, p. 8 (the end code is assumed); grbl and Mach from "
     "memory. Fanuc requires the M code: B-64014EN/03 p. 21"},
    {percent_at_end, "a '%' that no other '%' precedes", "read as the end of the program",
     "Fanuc, Haas", kFanuc | kHaas, "Fanuc B-64014EN/03 p. 21 (end of record)"},
    {percent_title, "text behind a '%'", "read as a title, without effect", "Fanuc, Haas",
     kFanuc | kHaas, "Fanuc B-64014EN/03 p. 21 (leader section)"},
    {control_characters, "control characters (NUL, DEL, ...)", "read as blanks", "Fanuc, Haas",
     kAll, "from memory: NUL and DEL of tapes are skipped"},
    {open_comment, "a comment without ')'", "read as a comment to the end of the line", "grbl",
     kGrbl, "grbl 1.1, protocol.c"},
    {nested_comment, "brackets within a comment", "read as part of the comment",
     "no control documents it, none reads words there", kAll, "none found"},
    {slash_comment, "a line that begins with '//'", "read as a comment",
     "no control documents it, none reads words there", kAll, "none found"},
    {skip_level, "a block skip with level (/2 ... /9)", "read as '/': one switch serves all levels",
     "Fanuc, Haas", kFanuc | kHaas, "Fanuc B-63944EN, optional block skip"},
    {colon_number, "a program number with ':'", "read as O", "Fanuc, Haas", kFanuc | kHaas,
     "Fanuc B-63944EN, program number in ISO code"},
    {number_with_words, "words in the block of the program number", "read as a block of their own",
     "Fanuc, Haas", kFanuc | kHaas, "from memory"},
    {block_number_anywhere, "an N word behind other words",
     "read as a block number, without effect", "grbl, Mach", kGrbl | kMach,
     "grbl 1.1, gcode.c; Mach from memory"},
    {tool_without_table, "a tool number without a tool table",
     "read as a tool of unknown length and diameter", "every control has a table of its own", kAll,
     "LinuxCNC refuses it; the table of another control is not in the program"},
    {fan_code, "M106 and M107", "without effect on motion", "controls with fan outputs", 0,
     "from memory"},
});

constexpr bool is_in_order() {
  for (std::size_t i = 0; i < kRules.size(); ++i) {
    if (static_cast<std::size_t>(kRules[i].rule) != i) return false;
  }
  return kRules.size() == static_cast<std::size_t>(count);
}
static_assert(is_in_order());

const ReaderRuleEntry& entry(ReaderRule rule) { return kRules[static_cast<std::size_t>(rule)]; }

}  // namespace

std::optional<Reader> reader_named(std::string_view name) {
  const auto* found = std::find(kReaders.begin(), kReaders.end(), name);
  if (found == kReaders.end()) return std::nullopt;
  return static_cast<Reader>(found - kReaders.begin());
}

std::span<const ReaderRuleEntry> reader_rules() { return kRules; }

bool has_rule(Reader reader, ReaderRule rule) {
  if (reader == Reader::linuxcnc || reader == Reader::heidenhain) return false;
  return reader == Reader::any || (entry(rule).readers & bit(reader)) != 0;
}

std::string sentence(ReaderRule rule) {
  const ReaderRuleEntry& one = entry(rule);
  return fmt::format("{}: {} ({}); LinuxCNC refuses it", one.found, one.reading, one.controls);
}

}  // namespace servomill::controllers
