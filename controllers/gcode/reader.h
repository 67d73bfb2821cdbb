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
/// or its file is called *.h (controllers/conversational), and `siemens` for one in the language of
/// SINUMERIK, which `any` does for files *.mpf and *.spf and for words that only it has
/// (controllers/siemens).
enum class Reader : std::uint8_t { any, linuxcnc, fanuc, haas, mach, grbl, heidenhain, siemens };
inline constexpr std::array<std::string_view, 8> kReaders = {
    "any", "linuxcnc", "fanuc", "haas", "mach", "grbl", "heidenhain", "siemens"};

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
  long_comment,
  dwell_word,
  given_feed,
  arc_radii,
  repeated_group,
  home_with_motion,
  second_home_number,
  homing_cycle,
  home_letters,
  additional_work_offset,
  cycle_repeats,
  cycle_without_hole,
  cycle_memory,
  cycle_without_dwell,
  cycle_unused_dwell,
  fine_boring,
  tapping_spindle,
  words_with_g80,
  motion_behind_cycle,
  modal_diameter_offset,
  modal_length_offset,
  unknown_length,
  subprogram_repeats,
  call_with_words,
  local_subprogram,
  subprogram_file,
  smoothing,
  machine_function,
  ignored_function,
  cancel_codes,
  check_codes,
  coolant_codes,
  exact_stop,
  spindle_power,
  skip_behind_number,
  polar_coordinates,
  scaling,
  mirror_image,
  rotation,
  unit_codes,
  sender_command,
  sender_wait,
  checksum,
  rapid_at_start,
  centre_off_plane,
  circular_pocket,
  haas_pocket,
  haas_mirror,
  corner,
  macro_statement,
  several_statements,
  variable_increment,
  macro_call,
  modal_macro_call,
  macro_output,
  arc_without_axes,
  home_under_tip_control,
  subprogram_behind_end,
  repeated_word,
  haas_tip_control,
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

/// A rule that a line needed, and the first column that needed it.
struct AppliedRule {
  ReaderRule rule;
  int column = 0;
  std::string detail = {};  // behind the sentence of the rule, or empty
};

/// All rules, in the order of `ReaderRule`.
std::span<const ReaderRuleEntry> reader_rules();

/// Returns true if `reader` has the rule. `linuxcnc` has none.
bool has_rule(Reader reader, ReaderRule rule);

/// True for an M code that some rule gives a meaning, or a refusal: none of the machine's builder.
bool is_known_function(int code);

/// An M code of the machine's builder that is to be left out, written "M82".
struct IgnoredCode {
  int number = -1;
  std::string fault;  // empty: none
};
IgnoredCode ignored_code(std::string_view text);

/// "a program that ends without M2 or M30: read as if M2 followed (grbl, Mach)", for warnings.
std::string sentence(ReaderRule rule);

}  // namespace servomill::controllers
