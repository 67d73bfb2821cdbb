#include "controllers/gcode/modal_groups.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace servomill::controllers {
namespace {

using enum Group;

// Sorted by code. Source of groups and words: LinuxCNC 2.9, G-code reference and "Modal Groups".
// LinuxCNC has no G43.4, G43.5, G53.1, G68.2, G69: as Fanuc's 30i series has them.
constexpr auto kGCodes = std::to_array<Code>({
    {0, g_motion, true, "", true},
    {10, g_motion, true, "", true},
    {20, g_motion, true, "IJKRP", true},
    {30, g_motion, true, "IJKRP", true},
    {40, g_non_modal, true, "P"},
    {50, g_motion, true, "IJPQ", true},
    {51, g_motion, true, "IJ", true},
    {52, g_motion, true, "LP", true},
    {53, g_non_modal, true, ""},
    {70, g_non_modal, false, ""},
    {80, g_non_modal, false, ""},
    {100, g_non_modal, true, "IJLPQR", true},
    {170, g_plane, true, ""},
    {171, g_plane, true, ""},
    {180, g_plane, true, ""},
    {181, g_plane, true, ""},
    {190, g_plane, true, ""},
    {191, g_plane, true, ""},
    {200, g_units, true, ""},
    {210, g_units, true, ""},
    {280, g_non_modal, true, "", true},
    {281, g_non_modal, true, ""},
    {300, g_non_modal, true, "", true},
    {301, g_non_modal, true, ""},
    {330, g_motion, true, "K", true},
    {331, g_motion, true, "K", true},
    {382, g_motion, true, "", true},
    {383, g_motion, true, "", true},
    {384, g_motion, true, "", true},
    {385, g_motion, true, "", true},
    {400, g_cutter_compensation, true, ""},
    {410, g_cutter_compensation, true, "DL"},
    {411, g_cutter_compensation, true, "DLR"},
    {420, g_cutter_compensation, true, "DL"},
    {421, g_cutter_compensation, true, "DLR"},
    {430, g_tool_length, true, "H"},
    {431, g_tool_length, true, "", true},
    {432, g_tool_length, true, "H"},
    {434, g_tool_length, true, "H"},
    {435, g_tool_length, true, "H"},
    {490, g_tool_length, true, ""},
    {520, g_non_modal, true, "", true},
    {530, g_non_modal, true, ""},
    {531, g_non_modal, true, ""},
    {540, g_work_system, true, ""},
    {550, g_work_system, true, ""},
    {560, g_work_system, true, ""},
    {570, g_work_system, true, ""},
    {580, g_work_system, true, ""},
    {590, g_work_system, true, ""},
    {591, g_work_system, true, ""},
    {592, g_work_system, true, ""},
    {593, g_work_system, true, ""},
    {610, g_path_control, true, ""},
    {611, g_path_control, true, ""},
    {640, g_path_control, true, "PQ"},
    {682, g_work_plane, true, "IJK", true},
    {690, g_work_plane, true, ""},
    {700, g_non_modal, false, ""},
    {710, g_non_modal, false, ""},
    {711, g_non_modal, false, ""},
    {712, g_non_modal, false, ""},
    {720, g_non_modal, false, ""},
    {721, g_non_modal, false, ""},
    {722, g_non_modal, false, ""},
    {730, g_motion, true, "LQR", true},
    {740, g_motion, true, "PR", true},
    {760, g_motion, false, ""},
    {800, g_motion, true, ""},
    {810, g_motion, true, "LR", true},
    {820, g_motion, true, "LPR", true},
    {830, g_motion, true, "LQR", true},
    {840, g_motion, true, "LPR", true},
    {850, g_motion, true, "LR", true},
    {860, g_motion, true, "LPR", true},
    {870, g_motion, true, "IJKLR", true},
    {880, g_motion, true, "LPR", true},
    {890, g_motion, true, "LPR", true},
    {900, g_distance, true, ""},
    {901, g_arc_distance, true, ""},
    {910, g_distance, true, ""},
    {911, g_arc_distance, true, ""},
    {920, g_non_modal, true, "", true},
    {921, g_non_modal, true, ""},
    {922, g_non_modal, true, ""},
    {923, g_non_modal, true, ""},
    {930, g_feed_mode, true, ""},
    {940, g_feed_mode, true, ""},
    {950, g_feed_mode, true, ""},
    {960, g_spindle_mode, false, ""},
    {970, g_spindle_mode, true, ""},
    {980, g_retract, true, ""},
    {990, g_retract, true, ""},
});

constexpr auto kMCodes = std::to_array<Code>({
    {0, m_stop, true, ""},
    {10, m_stop, true, ""},
    {20, m_stop, true, ""},
    {30, m_spindle, true, ""},
    {40, m_spindle, true, ""},
    {50, m_spindle, true, ""},
    {60, m_tool, true, ""},
    {70, m_coolant, true, ""},
    {80, m_coolant, true, ""},
    {90, m_coolant, true, ""},
    {190, m_spindle, false, ""},
    {300, m_stop, true, ""},
    {480, m_override, true, ""},
    {490, m_override, true, ""},
    {500, m_override, true, "P"},
    {510, m_override, true, "P"},
    {520, m_override, true, "P"},
    {530, m_override, true, "P"},
    {600, m_stop, true, ""},
    {610, m_tool, false, ""},
    {620, m_input_output, true, "P"},
    {630, m_input_output, true, "P"},
    {640, m_input_output, true, "P"},
    {650, m_input_output, true, "P"},
    {660, m_input_output, false, ""},
    {670, m_input_output, false, ""},
    {680, m_input_output, false, ""},
    {700, m_spindle, true, ""},
    {710, m_spindle, true, ""},
    {720, m_spindle, true, ""},
    {730, m_spindle, true, ""},
    {980, m_input_output, false, ""},
    {990, m_stop, true, ""},
});

// Why a code that LinuxCNC knows is refused, from a code to a code.
struct Refusal {
  int first, last;  // tenths
  std::string_view reason;
};

constexpr auto kGRefusals = std::to_array<Refusal>({
    {70, 80, "diameter and radius mode are for turning; only milling is supported"},
    {700, 722, "turning cycles are for lathes; only milling is supported"},
    {760, 760, "threading is for lathes; only milling is supported"},
    {960, 960, "constant surface speed is for turning; program the speed with G97 S"},
});

constexpr auto kMRefusals = std::to_array<Refusal>({
    {190, 190, "the spindle angle is not simulated, so it cannot be oriented"},
    {610, 610, "sets the number of the tool in the spindle manually; use T and M6"},
    {660, 660, "waits for an input of the control, which is not simulated"},
    {670, 680, "sets analog outputs of the control, which are not simulated"},
});

constexpr bool by_tenths(const Code& a, const Code& b) { return a.tenths < b.tenths; }
static_assert(std::is_sorted(kGCodes.begin(), kGCodes.end(), by_tenths));
static_assert(std::is_sorted(kMCodes.begin(), kMCodes.end(), by_tenths));

}  // namespace

std::span<const Code> g_codes() { return kGCodes; }
std::span<const Code> m_codes() { return kMCodes; }

namespace {

constexpr std::size_t kTenths = 1000;  // no code is G100 or above

// Position of the code of so many tenths in its table, counted from 1.
template <std::size_t N>
constexpr std::array<std::uint8_t, kTenths> index_of_codes(const std::array<Code, N>& codes) {
  std::array<std::uint8_t, kTenths> index{};
  for (std::size_t i = 0; i < N; ++i) {
    index[static_cast<std::size_t>(codes[i].tenths)] = static_cast<std::uint8_t>(i + 1);
  }
  return index;
}

constexpr auto kGIndex = index_of_codes(kGCodes);
constexpr auto kMIndex = index_of_codes(kMCodes);

}  // namespace

const Code* find_code(char letter, int tenths) {
  if (tenths < 0 || tenths >= static_cast<int>(kTenths)) return nullptr;
  const auto i = static_cast<std::size_t>(tenths);
  const std::size_t place = letter == 'G' ? kGIndex[i] : kMIndex[i];
  if (place == 0) return nullptr;
  return letter == 'G' ? &kGCodes[place - 1] : &kMCodes[place - 1];
}

std::string_view refusal(char letter, int tenths) {
  const std::span<const Refusal> refusals =
      letter == 'G' ? std::span<const Refusal>(kGRefusals) : std::span<const Refusal>(kMRefusals);
  for (const Refusal& one : refusals) {
    if (tenths >= one.first && tenths <= one.last) return one.reason;
  }
  return "not supported yet";
}

std::string code_name(char letter, int tenths) {
  return tenths % 10 == 0 ? fmt::format("{}{}", letter, tenths / 10)
                          : fmt::format("{}{}.{}", letter, tenths / 10, tenths % 10);
}

}  // namespace servomill::controllers
