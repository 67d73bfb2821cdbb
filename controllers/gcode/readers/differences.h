/// Words that two controls read differently. Such a word is never read in silence: a program that
/// holds one is refused with both readings unless the reader that is chosen has one of them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "controllers/gcode/reader.h"

namespace servomill::controllers {

enum class WordDifference : std::uint8_t {
  dwell_unit,
  dwell_increments,
  cycle_dwell_unit,
  length_offset_zero,
  stored_home,
  retract_level,
  cycle_distance,
  polar_centre,
  feed_beside_unit,
  subprogram_digits,
  lone_machine_coordinates,
  preset_words,
  missing_diameter_offset,
  tool_table_input,
  work_offset_input,
  override_codes,
  start_motion,
  decimal_point,
  scale_factor,
  circular_pocket,
  common_variable,
  angle_range,
  remainder,
  variable_dwell,
  argument_point,
  return_block,
  system_zero,
  incremental_input,
  cycle_from_below,
  count
};

/// One way to read a word.
struct WordReading {
  std::string_view text;      // "seconds"
  std::string_view controls;  // that read it so
  std::uint8_t readers = 0;   // those of `Reader`, a bit each
};

struct WordDifferenceEntry {
  WordDifference difference;
  std::string_view found;  // in the program
  std::array<WordReading, 2> readings;
  std::string_view option;  // that chooses, beside --reader, or empty
  std::string_view source;
};

/// All differences, in the order of `WordDifference`.
std::span<const WordDifferenceEntry> word_differences();

/// Which of the two readings a reader has, or nullopt.
std::optional<int> reading_of(WordDifference difference, Reader reader);

/// True for a code of LinuxCNC that the control of the reader is known not to have.
bool lacks(Reader reader, char letter, int tenths);

/// Ends a trial that cannot tell whether the control would read the program.
struct Undetermined {};

/// "G4 P without a decimal point: seconds (LinuxCNC, grbl), milliseconds (Fanuc, Haas); choose with
/// --reader"
std::string both_readings(WordDifference difference);

}  // namespace servomill::controllers
