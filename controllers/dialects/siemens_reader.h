/// Reader of programs for Siemens 840D sl: the actions of the machine, in machine coordinates.
///
/// Written from the manuals, by its own rules; it sees no header of a writer. Sources (V: seen):
/// [P]  NC programming, Programming Manual 12/2019, 6FC5398-2EP40-0BA0 (SINUMERIK ONE; V)
/// [W1] Basic logic functions: Tool Offset, Function Manual 11/2006, 6FC5397-0BP10-2BA0 (V)
/// [K2] Axis Types, Coordinate Systems, Frames, Function Manual 08/2005, 6FC5397-0BP10-0BA0 (V)
/// [V1] Feeds, Function Manual 08/2005, 6FC5397-0BP10-0BA0 (V)
/// [D]  802D sl Operation and Programming 06/2006, 6FC5398-3CP10-0BA0 (V)
/// [IS] ISO Dialects Milling 04.07 (V)
/// [R2] Axes and spindles, Function Manual 06/2019, A5E47437747B AA (V)
/// "M" marks what is from memory and was not found in a manual.
///
/// A mode that the program has not set is unknown, and so is every position; a block whose meaning
/// depends on one is refused. After a tool change by a macro (see SiemensSettings) all positions,
/// the plane, G90, units, the kind of feed, the work offset, the programmable frame, the
/// transformation, the path mode, D, S and the spindle are unknown again. After M0 and M1 the
/// positions are unknown. Work offsets include the basic frame, which acts with each of them.
///
/// Assumptions about the machine: a milling machine without a diameter axis (DIAMON is refused),
/// no transformation unless rotary axes are programmed, geometry axes as the path axes of F
/// (MD22420 = 0; M).
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/dialects/machine_action.h"

namespace servomill::controllers {

/// Settings of the machine's builder or the operator that change the meaning of a program.
struct SiemensSettings {
  /// MD20270: D after a tool change. 0: D0; -1: the number of the old tool; else the number. Only
  /// a tool change without a macro leaves it in force. [W1] p. 13
  int default_D = 1;
  bool SUPA_drops_length = true;  // MD10760: G153 and SUPA suppress the tool length. [IS] p. 3-42
  bool M6_is_macro = true;        // a cycle of the builder that moves axes and leaves modes behind
  bool T_changes_tool = false;    // MD22550 = 0: T changes the tool, not M6. [W1] p. 33
  /// SD42940 = 0: length 1 acts along the normal of the plane: Z, Y, X with G17, G18, G19.
  /// false: along Z in every plane. [P] p. 750
  bool length_follows_plane = true;
  /// MD30310 = 1 for A, B, C: positions are angles from 0 to 360 deg, not counts of them. Others
  /// are taken as the angle that they are (MD30455 bit 0 = 1), where they are no alarm.
  std::array<bool, 3> is_modulo{};
  bool G90_is_shortest = false;  // MD30455 bit 2, where AC(...) is not written. [R2] p. 225
};

/// Name of the settings for messages, such as "MD20270=1 MD10760=0 MD22550=1 SD42940=0 plain M6".
std::string to_string(const SiemensSettings& settings);

/// Every combination of the first five whose members differ in meaning: 32. Where there are modulo
/// axes two more, with them, since they do not meet the others.
/// @param may_be_modulo  of A, B, C: those that turn without end
std::vector<SiemensSettings> all_siemens_settings(std::array<bool, 3> may_be_modulo = {});

/// Rules of the reader that a test can set wrong, one at a time, to see that the worked examples
/// find it. Each is true as the control has it.
struct SiemensRules {
  bool length_is_added = true;              // machine = program + offset + length [W1]
  bool D_acts_in_its_block = true;          // with the first motion of the axis [W1] p. 13
  bool length_needs_a_line = true;          // G0, G1: an arc is refused [W1] p. 13
  bool SUPA_suppresses_offset = true;       // [K2] p. 1-7, [IS] p. 3-42
  bool SUPA_ends_with_its_block = true;     // [IS] p. 3-42
  bool increment_needs_same_offset = true;  // SD42440, SD42442: else refused [K2] p. 1-7
  bool IC_ends_with_its_block = true;       // [D] p. 8-138
  bool centre_counts_from_start = true;     // I J K [D] p. 8-154
  bool G2_is_clockwise = true;              // seen against the third axis [IS]
  bool G18_is_ZX = true;                    // Z the first axis, X the second (M)
  bool negative_CR_is_long = true;          // more than 180 deg [P] p. 192
  bool TURN_adds_turns = true;              // full circles before the rest [P] p. 205
  bool CIP_passes_its_point = true;         // which decides the direction [P] p. 198
  bool CIP_point_is_absolute = true;        // under G90, or with AC [P] p. 198
  bool equal_ends_are_full_circle = true;   // (M)
  bool G71_leaves_F = true;                 // only G700 and G710 set the unit of F [D] p. 8-139
  bool F_ends_with_its_kind = true;         // G93, G94, G95 delete it [V1] p. 2-4
  bool F_of_G4_is_time = true;              // the feed in force stays (M)
  bool G60_rapid_may_bend = true;           // RTLIOF [P] p. 181
  bool G9_ends_with_its_block = true;       // [P] p. 293
  bool MEAS_forgets_positions = true;       // of the axes of its block (M)
  bool ADIS_is_of_G641 = true;              // CTOL is that of G642 [P], 828D p. 490
  bool stop_acts_after_motion = true;       // M0, M1, M2, M17, M30 (M)
  bool stop_forgets_positions = true;       // the operator may have jogged
  bool macro_forgets_state = true;          // M6
  bool offset_rotates = true;               // a settable frame with a rotation about Z
  bool AC_is_not_shortest = true;           // towards the angle without passing 0 deg [R2] p. 225
};

/// The actions of a program. An axis that no block has named has an unknown position.
/// @throw InputError with line and column, where the text is none of the dialect's, where what a
///   block does depends on something undetermined, and where a word is known but not read
std::vector<MachineAction> read_siemens(std::string_view text, const std::string& file,
                                        const ControlSetup& setup, const SiemensSettings& settings,
                                        const SiemensRules& rules = {});

}  // namespace servomill::controllers
