#include "controllers/gcode/cl_data.h"

#include <fmt/format.h>

#include <algorithm>

#include "controllers/gcode/apt_reader.h"
#include "controllers/gcode/cl_csv_reader.h"
#include "controllers/gcode/cl_reader.h"

namespace servomill::controllers {

std::string to_string(const Warning& warning) {
  return fmt::format("{}: warning: {}", to_string(warning.place), warning.message);
}

std::size_t ClData::locations() const {
  return static_cast<std::size_t>(
      std::count_if(records.begin(), records.end(),
                    [](const ClRecord& record) { return is_motion(record.kind); }));
}

const ClRecord* ClData::first_without_tool() const {
  for (const ClRecord& record : records) {
    if (record.kind == MoveKind::tool) return nullptr;
    if (is_motion(record.kind)) return &record;
  }
  return nullptr;
}

ClData read_cl_data(std::string_view text, const std::string& file,
                    std::vector<Warning>* of_refused) {
  return in_capitals(file).ends_with(".CSV") ? read_cl_csv(text, file, of_refused)
                                             : read_apt(text, file, of_refused);
}

}  // namespace servomill::controllers
