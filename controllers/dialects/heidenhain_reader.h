/// Reader of Heidenhain conversational programs (`.H`; TNC 426/430, iTNC 530): the motion that such
/// a control makes of a text, in machine coordinates. It knows the control's manuals only, and
/// serves to verify programs that were written for this control.
///
/// Sources (V: seen; M: from memory, to be confirmed before it is relied upon):
/// [430] TNC 426, TNC 430 user's manual: p. 108 feed, p. 153 helix, p. 468 formats (V)
/// [476] TNC 426 (280 476) user's manual: p. 192 M126, M94 (V)
/// [472] TNC 426B (280 472) ISO: p. 122 M91, M92 (V)
/// [410] TNC 410 user's manual: p. 79 CC, C, full circle, tolerance (V)
/// [ISO] TNC 410, 426, 430 ISO: p. 159 M136, p. 164 M116, p. 169 M128 and its end by M129 (V)
/// [530] iTNC 530 user's manual: p. 520 M126, MP7682; 340 49x-04 ISO: p. 290 M128 (V)
/// [PIL] TNC 310 pilot: p. 8 pole, angle reference axes (V)
/// [155] TNC 155: p. 15 functions at the start and at the end of a block (V)
/// [306] TNC 306 technical manual: p. 4-99 MP7440, halt at M6 (V)
/// [640] TNC 640 ISO (34059x-05): p. 170 tool 0, p. 631 formats (V)
/// [620] TNC 620 cycle programming (340 56x-02): p. 256 end of cycle 26 (V)
/// [41U] TNC 410 user's manual: p. 186 cycle 11 and its end (V)
/// [TM] TNC 426, TNC 430 technical manual: p. 7-30 the tolerance is that of cycle 32 or MP1096 (V)
/// Everything else is M: cycles 7 to 10, 19 and 247, the form of cycle 32, PLANE RESET STAY, TRANS
/// DATUM, M140, FT, FU (mm per revolution: [640] p. 631), F of inch programs in 0.1 inch/min.
///
/// Assumptions, where no manual was found that says otherwise: M90, M103, M109, M110, M112, M118
/// and M120 are off when a program starts; transformations and M functions of the control survive a
/// tool change, while F, S, R0, the pole and all positions do not; F of a helix is along its path;
/// the active preset at the start is number 1; the tool table holds the lengths of `ControlSetup`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "controllers/dialects/machine_action.h"

namespace servomill::controllers {

/// Settings of builder and operator that change the meaning of a program. A program has one meaning
/// only if it has the same under all of them.
struct HeidenhainSettings {
  /// Rotary axes with the functions that tilt the plane (cycle 19, PLANE, M128). They may be active
  /// when the program starts, and a program must switch them off. Without, the control rejects
  /// them.
  bool has_tilting = false;
  /// FMAX: all axes arrive together on a straight line, as G00 does ("straight line at rapid
  /// traverse": iTNC 530, 60642x-03, ISO p. 211). Of FMAX itself nothing was found.
  bool is_rapid_straight = true;
  /// The display of rotary axes is reduced to less than 360 degrees, so that M126 acts. [476] p.
  /// 192
  bool is_rotary_display_reduced = false;
  /// Rotary axes take the shorter path without M126, too: MP7682 bit 2. [530] p. 520
  bool is_shorter_path_usual = false;
  /// M136: F in um per revolution (NC software before 280 476), not in mm. [ISO] p. 159
  bool is_m136_in_micrometres = false;
  /// F of a block that moves linear and rotary axes is the rate of all of them, a degree for a
  /// millimetre; otherwise that of the linear ones. Not found in a manual.
  bool is_feed_of_all_axes = true;
  /// M0 and M1 stop the spindle and the coolant. [155] p. 15; newer manuals name the spindle only
  bool is_stop_switching_off = true;
  bool is_optional_stop_on = true;  ///< M1 stops: a switch of the operator
  bool is_m6_halting = true;        ///< M6 halts the program: MP7440 bit 0. [306] p. 4-99
};

/// Differences of the settings from usual ones, for messages: "M1 does not stop, M136 in um".
std::string to_string(const HeidenhainSettings& settings);

/// Settings to read a program with: a usual control, then each setting changed by itself (their
/// effects do not meet), then all of them.
std::vector<HeidenhainSettings> all_heidenhain_settings(bool has_tilting);

/// Rules of the reader, for tests only: each can be made wrong, and an example must notice it.
struct HeidenhainRules {
  bool fmax_acts_in_its_block_only = true;
  bool f_is_modal = true;
  bool f_is_in_tenths_of_inch = true;  // in programs in INCH
  bool ft_is_in_seconds = true;
  bool increments_start_at_position = true;  // IX, IY ...
  bool m91_counts_from_machine_datum = true;
  bool m91_drops_tool_length = true;
  bool m91_acts_in_its_block_only = true;
  bool m3_acts_at_block_start = true;  // with M4, M8, M13, M14
  bool m5_acts_at_block_end = true;    // with M9
  bool m13_switches_coolant = true;
  bool tool_call_forgets_positions = true;
  bool probe_returns = true;  // TCH PROBE 0: to the position that it began at (M)
  bool tool_call_changes_length = true;
  bool delta_length_adds = true;       // DL
  bool stop_forgets_positions = true;  // M0, M1
  bool stop_switches_off = true;
  bool dr_plus_is_counter_clockwise = true;
  bool equal_ends_make_full_circle = true;
  bool cc_alone_takes_position = true;
  bool increments_of_cc_start_at_position = true;
  bool ipa_counts_revolutions = true;
  bool zx_angle_starts_at_z = true;
  bool shift_adds = true;  // cycle 7
  bool shift_replaces_shift = true;
  bool rotation_is_counter_clockwise = true;  // cycle 10
  bool mirror_reverses_arcs = true;           // cycle 8
  bool preset_changes_offset = true;          // cycle 247
  bool dwell_is_in_seconds = true;
  bool m126_takes_shorter_path = true;
  bool unknown_is_refused = true;  // otherwise: modes are off, positions 0
};

/// Actions of a machine whose control runs `text`.
/// @param text  the whole file
/// @param file  its name, for messages
/// @throws InputError, one fault, where the text is not of this dialect, not covered, or depends on
///     something that neither the program nor `setup` determines
std::vector<MachineAction> read_heidenhain(std::string_view text, const std::string& file,
                                           const ControlSetup& setup,
                                           const HeidenhainSettings& settings,
                                           const HeidenhainRules& rules = {});

}  // namespace servomill::controllers
