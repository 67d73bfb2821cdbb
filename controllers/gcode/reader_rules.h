/// Rules beyond those of lines (`ReaderRule` names these): words that other controls take.
#pragma once

#include <cstdint>
#include <string>

#include "controllers/gcode/reader.h"

namespace servomill::controllers {

/// Goes on where the enumerators of `ReaderRule` end.
struct WordRule {
  static constexpr ReaderRule long_comment{13};
  static constexpr ReaderRule dwell_word{14};
  static constexpr ReaderRule given_feed{15};
  static constexpr ReaderRule arc_radii{16};
  static constexpr ReaderRule repeated_group{17};
  static constexpr ReaderRule home_with_motion{18};
  static constexpr ReaderRule second_home_number{19};
  static constexpr ReaderRule homing_cycle{20};
  static constexpr ReaderRule additional_work_offset{21};
  static constexpr ReaderRule cycle_repeats{22};
  static constexpr ReaderRule cycle_without_hole{23};
  static constexpr ReaderRule cycle_memory{24};
  static constexpr ReaderRule cycle_without_dwell{25};
  static constexpr ReaderRule fine_boring{26};
  static constexpr ReaderRule tapping_spindle{27};
  static constexpr ReaderRule words_with_g80{28};
  static constexpr ReaderRule motion_behind_cycle{29};
  static constexpr ReaderRule modal_diameter_offset{30};
  static constexpr ReaderRule modal_length_offset{31};
  static constexpr ReaderRule unknown_length{32};
  static constexpr ReaderRule subprogram_repeats{33};
  static constexpr ReaderRule call_with_words{34};
  static constexpr ReaderRule local_subprogram{35};
  static constexpr ReaderRule smoothing{36};
  static constexpr ReaderRule machine_function{37};
  static constexpr ReaderRule polar_coordinates{38};
  static constexpr ReaderRule scaling{39};
  static constexpr ReaderRule mirror_image{40};
  static constexpr ReaderRule rotation{41};
  static constexpr ReaderRule unit_codes{42};
  static constexpr ReaderRule sender_command{43};
  static constexpr ReaderRule checksum{44};
  static constexpr ReaderRule rapid_at_start{45};
  static constexpr ReaderRule centre_off_plane{46};
  static constexpr ReaderRule circular_pocket{47};
  static constexpr std::uint8_t count = 48;
};
static_assert(static_cast<int>(ReaderRule::count) == 13);

/// A rule that a line needed, and the first column that needed it.
struct AppliedRule {
  ReaderRule rule;
  int column = 0;
  std::string detail = {};  // behind the sentence of the rule, or empty
};

}  // namespace servomill::controllers
