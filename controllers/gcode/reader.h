/// Readers of programs: LinuxCNC's, and those of other controls, by one table of rules.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace servomill::controllers {

/// The control whose reading of a program counts. `linuxcnc` accepts exactly what LinuxCNC accepts;
/// `any` accepts beyond that what a control in use accepts, if no two read it differently.
/// `heidenhain` takes a program for conversational, which `any` does where it begins with BEGIN PGM
/// or its file is called *.h (controllers/conversational).
enum class Reader : std::uint8_t { any, linuxcnc, fanuc, haas, mach, grbl, heidenhain };
inline constexpr std::array<std::string_view, 7> kReaders = {
    "any", "linuxcnc", "fanuc", "haas", "mach", "grbl", "heidenhain"};

/// The reader of that name, or nullopt.
std::optional<Reader> reader_named(std::string_view name);

/// Readings beyond LinuxCNC's rules.
enum class ReaderRule : std::uint8_t {
  end_of_text,
  percent_at_end,
  percent_title,
  control_characters,
  open_comment,
  nested_comment,
  slash_comment,
  skip_level,
  colon_number,
  number_with_words,
  block_number_anywhere,
  tool_without_table,
  fan_code,
  count
};

/// One rule as data.
struct ReaderRuleEntry {
  ReaderRule rule;
  std::string_view found;     // in the program
  std::string_view reading;   // how it is read
  std::string_view controls;  // that read it so
  std::uint8_t readers;       // those of `Reader`, a bit each; `any` has every rule
  std::string_view source;    // manual and page, or "from memory", or that none was found
};

/// All rules, in the order of `ReaderRule`.
std::span<const ReaderRuleEntry> reader_rules();

/// Returns true if `reader` has the rule. `linuxcnc` has none.
bool has_rule(Reader reader, ReaderRule rule);

/// "a program that ends without M2 or M30: read as if M2 followed (grbl, Mach)", for warnings.
std::string sentence(ReaderRule rule);

}  // namespace servomill::controllers
