#include "controllers/dialects/fanuc_reader.h"

#include <fmt/format.h>

#include "controllers/dialects/fanuc_machine.h"
#include "plant/vocabulary/interrupt.h"

namespace servomill::controllers {

std::string to_string(const FanucSettings& settings) {
  std::string text =
      fmt::format("EVO={:d} TOS={:d} LRP={:d} TLB={:d} {}", settings.EVO, settings.TOS,
                  settings.LRP, settings.TLB, settings.is_IS_C ? "IS-C" : "IS-B");
  for (std::size_t i = 0; i < settings.rolls_over.size(); ++i) {
    if (settings.rolls_over[i]) text += fmt::format(" {} ROA=1", "ABC"[i]);
  }
  return text;
}

std::vector<FanucSettings> all_fanuc_settings(std::array<bool, 3> may_roll_over) {
  std::vector<FanucSettings> out;
  for (int i = 0; i < 16; ++i) {
    FanucSettings one;
    one.EVO = (i & 1) != 0;
    one.TOS = (i & 2) != 0;
    one.LRP = (i & 4) != 0;
    one.is_IS_C = (i & 8) != 0;
    out.push_back(one);
  }
  out.emplace_back().TLB = true;
  if (may_roll_over != std::array<bool, 3>{}) out.emplace_back().rolls_over = may_roll_over;
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
