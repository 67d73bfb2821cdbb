#include "sim/programs/verification/readings.h"

#include <fmt/format.h>

#include <algorithm>

#include "controllers/dialects/fanuc_reader.h"
#include "controllers/dialects/heidenhain_reader.h"
#include "controllers/dialects/siemens_reader.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim::programs {
namespace {

const std::string kFile = "written";

std::vector<Reading> fanuc_readings(const std::string& text, const controllers::ControlSetup& setup,
                                    const ReadingOptions& options) {
  const auto has = [&](std::string_view function) {
    return std::find(options.without.begin(), options.without.end(), function) ==
           options.without.end();
  };
  const std::array<bool, 3> no_axis{};
  std::vector<Reading> out;
  const bool needs_IS_C = options.resolution < 0.99 * um;
  for (controllers::FanucSettings one :
       controllers::all_fanuc_settings(has("rollover") ? options.is_endless : no_axis)) {
    const bool is_of_its_own = one.TLB || one.rolls_over != no_axis;
    if (needs_IS_C && is_of_its_own) one.is_IS_C = true;
    if ((needs_IS_C && !one.is_IS_C) || (one.TLB && !has("length-b"))) continue;
    one.has_polar = has("polar");
    one.has_scaling = has("scaling");
    one.has_mirror = has("mirror");
    one.has_surface_speed = has("surface-speed");
    one.has_preset = has("preset");
    out.push_back({controllers::to_string(one),
                   [&text, &setup, one] { return read_fanuc(text, kFile, setup, one); }});
  }
  return out;
}

std::vector<Reading> siemens_readings(const std::string& text,
                                      const controllers::ControlSetup& setup,
                                      std::array<bool, 3> is_endless) {
  std::vector<Reading> out;
  for (const controllers::SiemensSettings& one : controllers::all_siemens_settings(is_endless)) {
    out.push_back({controllers::to_string(one),
                   [&text, &setup, one] { return read_siemens(text, kFile, setup, one); }});
  }
  return out;
}

std::vector<Reading> heidenhain_readings(const std::string& text,
                                         const controllers::ControlSetup& setup,
                                         bool has_rotary_axes) {
  std::vector<Reading> out;
  for (const controllers::HeidenhainSettings& one :
       controllers::all_heidenhain_settings(has_rotary_axes)) {
    out.push_back({controllers::to_string(one),
                   [&text, &setup, one] { return read_heidenhain(text, kFile, setup, one); }});
  }
  return out;
}

// A block of its own, as the control requires: "N3 G20" or "G20".
bool has_inches(const std::string& text) {
  for (std::size_t at = text.find("G20\n"); at != std::string::npos;
       at = text.find("G20\n", at + 1)) {
    const std::size_t begin = text.rfind('\n', at) + 1;  // npos + 1 is 0
    if (text.find_first_not_of("N0123456789 ", begin) == at) return true;
  }
  return false;
}

}  // namespace

double written_grid(const std::string& text, Dialect dialect, double resolution) {
  constexpr double kInchGrid = 2.54;  // 0.0001 inch in 0.001 mm
  return dialect == Dialect::fanuc && has_inches(text) ? kInchGrid * resolution : resolution;
}

std::vector<Reading> readings_of(const std::string& text, Dialect dialect,
                                 const controllers::ControlSetup& setup,
                                 const ReadingOptions& options) {
  if (dialect == Dialect::fanuc) return fanuc_readings(text, setup, options);
  if (dialect == Dialect::siemens) return siemens_readings(text, setup, options.is_endless);
  return heidenhain_readings(text, setup, options.has_rotary_axes);
}

}  // namespace servomill::sim::programs
