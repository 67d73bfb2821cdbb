/// Programs for Siemens 840D sl, worked out by hand from the manuals (see siemens_reader.h for the
/// names of the sources).
#pragma once

#include <string>
#include <vector>

#include "controllers/dialects/siemens_reader.h"

namespace servomill::controllers {

using SettingsFilter = bool (*)(const SiemensSettings&);

struct SiemensExample {
  std::string name;
  std::string program;                // follows the head; M30 follows it
  std::vector<std::string> expected;  // actions (without the end), or one fault
  SettingsFilter applies = [](const SiemensSettings&) { return true; };
};

/// Lines 1 and 2 of every example's program.
inline constexpr const char* kSiemensHead = "G710 G17 G40 G90 G94 G54\nTRANS\n";

const std::vector<SiemensExample>& siemens_examples();

/// All settings, of a machine whose rotary axes turn without end.
std::vector<SiemensSettings> siemens_example_settings();

/// G54 at X100 Y200 Z300 A5, G55 at X10 Y20 Z30, G56 at X50 Y60 Z70 rotated by 90 deg, G505 at
/// X1 Y2 Z3; tool 1 is 50 long, tool 2 80.
ControlSetup siemens_example_setup();

/// Expected actions, as action_text.h writes it. An InputError becomes its message.
std::vector<std::string> siemens_actions(const SiemensExample& example,
                                         const SiemensSettings& settings,
                                         const SiemensRules& rules = {});

}  // namespace servomill::controllers
