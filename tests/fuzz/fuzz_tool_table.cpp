// The reader of tool tables. Laws: faults have their places; tools are finite and found by number.
#include <cmath>

#include "controllers/gcode/tool_table.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace servomill;
  const std::string_view text = fuzz::text_of(data, size);
  try {
    const auto table = controllers::ToolTable::parse(text, "tools.tbl");
    for (const auto& [number, tool] : table.entries()) {
      fuzz::require(tool.offset.allFinite() && std::isfinite(tool.diameter), "tools are finite");
      fuzz::require(table.find(number) != nullptr && table.find(number)->number == number,
                    "a tool is found by its number");
    }
  } catch (const InputError& error) {
    fuzz::require_places(error.faults(), text, "tools.tbl");
  }
  return 0;
}
