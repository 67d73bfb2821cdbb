/// The G and M codes that are known, their modal groups, and which words belong to which code.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace servomill::controllers {

/// Codes of one group exclude each other in a block. Numbers as in LinuxCNC's manual.
enum class Group : std::uint8_t {
  none,  // not known
  g_non_modal,
  g_motion,
  g_plane,
  g_distance,
  g_arc_distance,
  g_feed_mode,
  g_units,
  g_cutter_compensation,
  g_tool_length,
  g_retract,
  g_work_system,
  g_path_control,
  g_spindle_mode,
  g_work_plane,  // not in LinuxCNC: 16 in Fanuc's manuals
  m_input_output,
  m_stop,
  m_tool,
  m_spindle,
  m_coolant,
  m_override,
  count
};

struct Code {
  int tenths;  // 10 times the code: G59.1 is 591
  Group group;
  bool supported;          // false: known to LinuxCNC, refused here with a reason
  std::string_view uses;   // letters of words that belong to it, beside axis words
  bool uses_axes = false;  // takes the axis words of its block
};

std::span<const Code> g_codes();
std::span<const Code> m_codes();

/// nullptr if there is no such code.
const Code* find_code(char letter, int tenths);

/// Why a code that is known but not supported is refused.
std::string_view refusal(char letter, int tenths);

/// "G59.1"
std::string code_name(char letter, int tenths);

}  // namespace servomill::controllers
