#include "sim/input/controls/control_settings.h"

#include "sim/input/controls/read_controls.h"
#include "sim/input/controls/settings_lines.h"

namespace servomill::sim::input {

std::optional<ControlKind> kind_of_settings(std::string_view text) {
  constexpr int kMany = 3;  // lines of one kind
  int grbl = 0, rrf = 0;
  for (const SettingsLine& line : settings_lines(text, "")) {
    const std::string_view content = line.text;
    for (const char* section : {"[EMC]", "[TRAJ]", "[EMCMOT]", "[KINS]"}) {
      if (content.starts_with(section)) return ControlKind::linuxcnc;
    }
    for (const char* key : {"max_rate_mm_per_min:", "acceleration_mm_per_sec2:"}) {
      if (content.starts_with(key)) return ControlKind::fluidnc;
    }
    const std::size_t dollar = content.find("$1");
    if (dollar != std::string_view::npos && content.find('=', dollar) != std::string_view::npos) {
      ++grbl;
    }
    for (const char* code : {"M203", "M201", "M208", "M566", "M584", "M569", "M92"}) {
      if (content.starts_with(code)) ++rrf;
    }
  }
  if (grbl >= kMany) return ControlKind::grbl;
  if (rrf >= kMany) return ControlKind::rrf;
  return std::nullopt;
}

ControlSettings read_control_settings(ControlKind kind, std::string_view text,
                                      const std::string& file) {
  constexpr std::array kReaders = {read_linuxcnc, read_grbl, read_fluidnc, read_rrf};
  return kReaders[static_cast<std::size_t>(kind)](text, file);
}

}  // namespace servomill::sim::input
