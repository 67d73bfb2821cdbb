#include "controllers/dialects/fanuc_reader.h"

#include <fmt/format.h>

#include "controllers/dialects/fanuc_machine.h"
#include "plant/vocabulary/interrupt.h"

namespace servomill::controllers {

std::string to_string(const FanucSettings& settings) {
  return fmt::format("EVO={:d} TOS={:d} LRP={:d} {}", settings.EVO, settings.TOS, settings.LRP,
                     settings.is_IS_C ? "IS-C" : "IS-B");
}

std::vector<FanucSettings> all_fanuc_settings() {
  std::vector<FanucSettings> out;
  for (int i = 0; i < 16; ++i) {
    out.push_back({(i & 1) != 0, (i & 2) != 0, (i & 4) != 0, (i & 8) != 0});
  }
  return out;
}

std::vector<MachineAction> read_fanuc(std::string_view text, const std::string& file,
                                      const ControlSetup& setup, const FanucSettings& settings,
                                      const FanucRules& rules) {
  FanucLexer lexer(text, file);
  FanucMachine machine(file, setup, settings, rules);
  while (const auto block = lexer.next()) {
    throw_if_interrupted();
    if (block->has_slash && setup.skips_blocks) continue;
    if (!machine.run(*block)) break;
  }
  return machine.take_actions();
}

}  // namespace servomill::controllers
