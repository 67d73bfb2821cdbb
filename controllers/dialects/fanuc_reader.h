/// Reader of Fanuc programs for machining centres, for the verification of written programs.
///
/// It follows the operator's manuals of the Series 0i-MB (B-63844EN/02) and 30i (B-63944EN) and is
/// strict: a mode or position that neither the program nor the operator has set is unknown, and a
/// block whose effect depends on it is refused. The settings of the machine builder that change
/// the effect of a program are parameters of the reader, so that a program can be read under each
/// of them. "M" marks rules that were not found in a manual.
///
/// Read: % O N / ( ); G0 G1 G2 G3 with I J K, G4, G5.1, G9, G15, G17 G18 G19, G20 G21, G28, G30,
/// G31, G40, G43 G44 G49, G50, G50.1, G52 of 0, G53, G54 ... G59, G61 G64, G69, G80, G90 G91,
/// G92.1, G93 G94 G95, G97, G98 G99; F S T H; M0 ... M9 and M30. POPEN, DPRNT[...] and PCLOS put
/// out numbers and move nothing. Refused: what needs cycles, macros,
/// cutter compensation, rotation, scaling, mirror images, shifts by G52 or G92.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/dialects/machine_action.h"

namespace servomill::controllers {

/// Machine builder's parameters that change the effect of a program.
struct FanucSettings {
  bool EVO = false;  // No. 5001#6: the length cancelled by G53, G28, G30 returns by itself (M)
  /// No. 5006#6: length by shift of coordinates, not by motion of Z (B-63943EN-1/02 p. 1654).
  bool TOS = false;
  bool LRP = false;      // No. 1401#1: G0 along a line (B-63844EN/02 p. 48)
  bool is_IS_C = false;  // increment of 0.1 um and 0.0001 deg, not 1 um and 0.001 deg
  bool TLB = false;  // No. 5001#1: length along the normal of the plane (B-63943EN-1/02 p. 1654)
  /// No. 1008#0 (ROA) of A, B, C: absolute positions within one turn, reached by the shorter way
  /// (#1, RAB, and #3, RAA, 0; B-63534EN/02 p. 531).
  std::array<bool, 3> rolls_over{};
  // Functions that the control has. What it has may be in force when the program starts; the code
  // that ends it is an alarm on a control without.
  bool has_polar = true;          // G15, G16
  bool has_scaling = true;        // G50, G51
  bool has_mirror = true;         // G50.1, G51.1
  bool has_surface_speed = true;  // G96, G97
  bool has_preset = true;         // G92 with G92.1
};

/// Name of the settings for messages, such as "EVO=0 TOS=1 LRP=0 IS-B".
std::string to_string(const FanucSettings& settings);

/// All combinations of the first four, then one with TLB and, where axes may roll over, one in
/// which they do: these effects do not meet the others.
std::vector<FanucSettings> all_fanuc_settings(std::array<bool, 3> may_roll_over = {});

/// Rules of the dialect as data, so that tests can prove by wrong ones that each is pinned.
struct FanucRules {
  // dimensions
  double inch_in_mm = 25.4;
  bool number_without_point_is_increments = true;
  bool centre_is_from_begin = true;  // I J K, under G90 and G91
  bool G2_is_clockwise = true;       // seen against the positive normal
  int G18_first_axis = 2;            // ZX, not XZ
  // tool length
  double G43_sign = 1.0;
  bool machine_position_cancels_length = true;  // G53: B-63844EN/02 p. 204
  bool reference_return_cancels_length = true;  // G28, G30: the same page
  bool G49_alone_moves_Z = true;                // where TOS is 0: B-63943EN-1/02 p. 1654
  bool G43_alone_moves_Z = true;                // the same
  bool length_returns_only_with_EVO = true;     // M
  // positions
  bool G53_ignores_work_offset = true;
  bool G53_is_for_one_block = true;
  bool G28_goes_through_a_point = true;
  bool rolls_over_by_shorter_way = true;  // B-63534EN/02 p. 531
  bool tool_change_forgets_positions = true;
  bool stop_forgets_positions = true;
  bool skip_forgets_positions = true;  // G31
  // modes
  bool modes_are_unknown_at_start = true;
  bool tool_change_forgets_modes = true;
  bool tool_change_forgets_spindle = true;
  bool feed_mode_forgets_F = true;
  // numbers of time
  double dwell_X_in_s = 1.0;
  double dwell_P_in_increments = 1e-3;  // s on IS-B; a tenth on IS-C (M)
  bool helix_feed_is_along_arc = true;  // M
  bool inverse_time_is_per_minute = true;
  // auxiliary functions
  bool M9_stops_mist_and_flood = true;
  bool M4_is_counter_clockwise = true;
  bool exact_stop_G9_is_for_one_block = true;
};

/// Actions of the machine, up to M2 or M30.
/// @throws InputError with line and column where the text is not of the dialect, or where its
/// effect depends on something that is not determined
std::vector<MachineAction> read_fanuc(std::string_view text, const std::string& file,
                                      const ControlSetup& setup, const FanucSettings& settings,
                                      const FanucRules& rules = {});

}  // namespace servomill::controllers
