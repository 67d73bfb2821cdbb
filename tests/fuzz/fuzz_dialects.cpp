// The readers of programs for Fanuc, Siemens and Heidenhain. Each reads every text, with settings
// that its length selects. Laws: a fault has its place in the text; actions are finite, their lines
// are in the text and in order, motions have directions and feeds.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/dialects/fanuc_reader.h"
#include "controllers/dialects/heidenhain_reader.h"
#include "controllers/dialects/siemens_reader.h"
#include "plant/vocabulary/units.h"
#include "tests/fuzz/fuzz.h"

namespace servomill::fuzz {
namespace {

using controllers::ActionKind;
using controllers::ControlSetup;
using controllers::MachineAction;

constexpr std::string_view kFile = "p.nc";

ControlSetup setup_for(std::string_view text) {
  ControlSetup setup;
  for (std::size_t i = 0; i < 4; ++i) {
    setup.work_offset[i] = AxisWords::Constant(0.1 * static_cast<double>(i));
  }
  setup.work_rotation[1] = 30.0 * deg;
  setup.tool_length = {{1, 0.05}, {2, 0.0}, {5, -0.01}};
  setup.skips_blocks = text.size() % 2 == 1;
  if (text.size() % 3 == 1) setup.start.fill(0.25);
  return setup;
}

void require_action(const MachineAction& action, int first_line, int last_line) {
  const std::string which = fmt::format("line {}", action.line);
  require(action.line >= first_line && action.line <= last_line, "lines are in order", which);
  for (const auto& position : action.end) {
    require(!position || std::isfinite(*position), "positions are finite", which);
  }
  require(std::isfinite(action.feed) && std::isfinite(action.value), "numbers are finite", which);
  if (action.kind == ActionKind::arc) {
    require(action.turns != 0 && action.centre.allFinite(), "arcs have a direction", which);
  }
  if (action.kind == ActionKind::arc || action.kind == ActionKind::feed) {
    require(action.feed > 0.0, "feeds are positive", which);
  }
}

template <class Read>
void check(std::string_view text, Read read) {
  try {
    const std::vector<MachineAction> actions = read();
    const int lines = 1 + static_cast<int>(std::count(text.begin(), text.end(), '\n'));
    int line = 1;
    for (const MachineAction& action : actions) {
      require_action(action, line, lines);
      line = action.line;
    }
  } catch (const InputError& error) {
    require_places(error.faults(), text, kFile);
  }
}

template <class Settings>
const Settings& selected(const std::vector<Settings>& all, std::string_view text) {
  return all[text.size() % all.size()];
}

}  // namespace

void run(std::string_view text) {
  const std::string file(kFile);
  const ControlSetup setup = setup_for(text);
  check(text, [&] {
    return read_fanuc(text, file, setup, selected(controllers::all_fanuc_settings(), text));
  });
  check(text, [&] {
    return read_siemens(text, file, setup,
                        selected(controllers::all_siemens_settings({true, true, true}), text));
  });
  check(text, [&] {
    const bool has_tilting = text.size() % 2 == 0;
    return read_heidenhain(text, file, setup,
                           selected(controllers::all_heidenhain_settings(has_tilting), text));
  });
}

}  // namespace servomill::fuzz
