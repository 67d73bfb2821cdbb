// The reader of cutter locations, APT and CSV. Laws: faults and warnings have their places; tool
// axes are unit vectors, everything is finite.
#include <cmath>

#include "controllers/gcode/cl_data.h"
#include "tests/fuzz/fuzz.h"

namespace servomill::fuzz {
namespace {

constexpr double kUnitTol = 1e-12;  // rounding of a vector divided by its length

void read(std::string_view text, const std::string& file) {
  std::vector<controllers::Warning> warnings;
  try {
    const auto data = controllers::read_cl_data(text, file, &warnings);
    for (const auto& record : data.records) {
      require(
          std::isfinite(record.feed) && std::isfinite(record.value) && record.P.p_WT.allFinite(),
          "records are finite");
      require(std::abs(record.P.k_W.norm() - 1.0) < kUnitTol, "tool axes are unit vectors");
    }
    require(data.locations() > 0, "a file holds a location");
    warnings = data.warnings;
  } catch (const InputError& error) {
    require_places(error.faults(), text, file);
  }
  for (const auto& warning : warnings) {
    const Fault as_fault{warning.place, warning.message};
    require_places(std::span(&as_fault, 1), text, file);
  }
}

}  // namespace

void run(std::string_view text) {
  // APT knows no line that begins with a letter of the header of CSV
  const bool is_csv = !text.empty() && (text[0] == '#' || text[0] == 'x' || text[0] == '\n');
  read(text, is_csv ? "part.csv" : "part.cls");
}

}  // namespace servomill::fuzz
