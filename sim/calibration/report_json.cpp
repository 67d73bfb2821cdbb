#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "plant/vocabulary/units.h"
#include "sim/calibration/report.h"
#include "sim/system/json.h"

namespace servomill::sim::calibration {
namespace {

using system::JsonObject;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

const char* unit_of(bool linear) { return linear ? "um" : "urad"; }

std::string group_json(const readings::Group& group, const GroupResult& result) {
  JsonObject out;
  out.text("group", group.name)
      .text("kind", readings::kKinds[static_cast<std::size_t>(group.kind)])
      .integer("numbers", result.numbers)
      .text("unit", unit_of(!readings::is_angular(group.kind, group.axis)))
      .number("uncertainty", result.uncertainty / um)
      .boolean("is_estimated", !group.uncertainty)
      .number("residual_rms", result.rms / um)
      .number("redundancy", result.redundancy)
      .number("variance_ratio", result.redundancy > 0.5 ? result.ratio() : kUnknown);
  return out.line();
}

void add_locations(const Adjustment& adjustment, std::vector<std::string>& out) {
  const Unknowns& unknowns = adjustment.unknowns;
  for (std::size_t k = 0; k < unknowns.locations.size(); ++k) {
    const int unknown = unknowns.first_location() + static_cast<int>(k);
    const double variance = adjustment.covariance(unknown, unknown);
    const plant::ErrorName& name = unknowns.locations[k].name;
    if (!(variance > 0.0)) continue;
    out.push_back(JsonObject()
                      .text("error", plant::to_string(name))
                      .text("unit", unit_of(is_linear(name.direction)))
                      .number("value", adjustment.values[unknown] / um)
                      .number("U", 2.0 * std::sqrt(variance) / um)
                      .boolean("is_combined", is_combined(adjustment, name))
                      .line());
  }
}

std::string function_json(const Adjustment& adjustment, const KnownFunction& known) {
  const auto [least, most] = std::minmax_element(known.value.begin(), known.value.end());
  const double sigma = *std::max_element(known.sigma.begin(), known.sigma.end());
  const bool linear = is_linear(known.name.axis);
  JsonObject out;
  out.text("error", plant::to_string(known.name))
      .text("unit", unit_of(is_linear(known.name.direction)))
      .number("min", *least / um)
      .number("max", *most / um)
      .number("U", 2.0 * sigma / um)
      .text("position_unit", linear ? "mm" : "deg")
      .number("from", known.s.front() / (linear ? mm : deg))
      .number("to", known.s.back() / (linear ? mm : deg));
  out.number("reversal", known.reversal ? known.reversal->first / um : kUnknown);
  out.number("U_reversal", known.reversal ? 2.0 * known.reversal->second / um : kUnknown);
  return out.boolean("is_combined", is_combined(adjustment, known.name)).line();
}

}  // namespace

std::string report_json(const Calibration& calibration,
                        const std::vector<std::string>& suggestions) {
  const Adjustment& adjustment = calibration.adjustment;
  std::vector<std::string> groups, errors;
  for (std::size_t g = 0; g < calibration.readings.groups.size(); ++g) {
    groups.push_back(group_json(calibration.readings.groups[g], adjustment.groups[g]));
  }
  add_locations(adjustment, errors);
  for (const KnownFunction& known : functions_along_travel(adjustment)) {
    errors.push_back(function_json(adjustment, known));
  }
  for (const KnownGrid& known : known_grids(adjustment)) {
    const auto& [own, across] = known.form.axes;
    errors.push_back(JsonObject()
                         .text("error", plant::to_string(known.name))
                         .text("unit", unit_of(is_linear(known.name.direction)))
                         .text("axes", fmt::format("{}{}", letter(own), letter(across)))
                         .number("min", known.least / um)
                         .number("max", known.most / um)
                         .number("U", 2.0 * known.sigma / um)
                         .boolean("is_combined", known.is_combined)
                         .line());
  }
  return JsonObject()
      .raw("groups", system::json_list(groups))
      .raw("errors", system::json_list(errors))
      .raw("undetermined", system::json_texts(unidentifiable_sentences(calibration)))
      .raw("suggestions", system::json_texts(suggestions))
      .line();
}

}  // namespace servomill::sim::calibration
