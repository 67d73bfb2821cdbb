// The reader of tool tables. Laws: faults have their places; tools are finite and found by number.
#include <cmath>

#include "controllers/gcode/tool_table.h"
#include "tests/fuzz/fuzz.h"

namespace servomill::fuzz {

void run(std::string_view text) {
  try {
    const auto table = controllers::ToolTable::parse(text, "tools.tbl");
    for (const auto& [number, tool] : table.entries()) {
      require(tool.offset.allFinite() && std::isfinite(tool.diameter), "tools are finite");
      require(table.find(number) != nullptr && table.find(number)->number == number,
              "a tool is found by its number");
    }
  } catch (const InputError& error) {
    require_places(error.faults(), text, "tools.tbl");
  }
}

}  // namespace servomill::fuzz
