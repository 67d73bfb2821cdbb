#include "sim/calibration/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/units.h"
#include "sim/system/text_table.h"

namespace servomill::sim::calibration {
namespace {

using plant::ErrorName;
using Lines = std::vector<std::vector<std::string>>;

std::string group_table(const Calibration& calibration) {
  Lines lines = {
      {"group", "kind", "numbers", "uncertainty", "residual rms", "redundancy", "variance ratio"}};
  for (std::size_t g = 0; g < calibration.readings.groups.size(); ++g) {
    const readings::Group& group = calibration.readings.groups[g];
    const GroupResult& result = calibration.adjustment.groups[g];
    lines.push_back({group.name, std::string(readings::kKinds[std::size_t(group.kind)]),
                     std::to_string(result.numbers),
                     in_unit(result.uncertainty, group) + (group.uncertainty ? "" : " (estimated)"),
                     in_unit(result.rms, group), fmt::format("{:.1f}", result.redundancy),
                     result.redundancy > 0.5 ? fmt::format("{:.2f}", result.ratio()) : "-"});
  }
  return system::text_table(std::move(lines), 0, {2, 3, 4, 5, 6});
}

// "0 to 500 mm"
std::string range_text(const std::vector<double>& knots, Axis axis) {
  const double unit = is_linear(axis) ? mm : deg;
  return fmt::format("{:g} to {:g} {}", knots.front() / unit, knots.back() / unit,
                     is_linear(axis) ? "mm" : "deg");
}

// Beside the function of the own axis.
std::vector<std::string> grid_line(const KnownGrid& known) {
  const auto& [own, across] = known.form.axes;
  return {
      fmt::format("{} over {} and {}", plant::to_string(known.name), letter(own), letter(across)),
      fmt::format("{:.3f} to {:.3f}", known.least / um, known.most / um),
      fmt::format("{:.2g}", 2.0 * known.sigma / um),
      is_linear(known.name.direction) ? "um" : "urad",
      range_text(known.form.knots[0], own) + ", " + range_text(known.form.knots[1], across),
      known.is_combined ? "in combination" : ""};
}

std::string error_table(const Calibration& calibration) {
  const Adjustment& adjustment = calibration.adjustment;
  Lines lines = {{"error", "value", "+- (k = 2)", "unit", "over", ""}};
  const auto remark = [&](const ErrorName& name) {
    return is_combined(adjustment, name) ? std::string("in combination") : std::string();
  };
  const Unknowns& unknowns = adjustment.unknowns;
  for (std::size_t k = 0; k < unknowns.locations.size(); ++k) {
    const int unknown = unknowns.first_location() + int(k);
    const double variance = adjustment.covariance(unknown, unknown);
    const ErrorName& name = unknowns.locations[k].name;
    if (!(variance > 0.0)) continue;
    lines.push_back({plant::to_string(name), fmt::format("{:.3f}", adjustment.values[unknown] / um),
                     fmt::format("{:.2g}", 2.0 * std::sqrt(variance) / um),
                     is_linear(name.direction) ? "um" : "urad", "", remark(name)});
  }
  for (const KnownFunction& known : functions_along_travel(adjustment)) {
    const auto [least, most] = std::minmax_element(known.value.begin(), known.value.end());
    const double sigma = *std::max_element(known.sigma.begin(), known.sigma.end());
    lines.push_back(
        {plant::to_string(known.name), fmt::format("{:.3f} to {:.3f}", *least / um, *most / um),
         fmt::format("{:.2g}", 2.0 * sigma / um), is_linear(known.name.direction) ? "um" : "urad",
         range_text(known.s, known.name.axis), remark(known.name)});
    if (!known.reversal) continue;
    const auto& [value, uncertainty] = *known.reversal;
    lines.push_back({"  reversal", fmt::format("{:.3f}", value / um),
                     fmt::format("{:.2g}", 2.0 * uncertainty / um),
                     is_linear(known.name.direction) ? "um" : "urad", "", "up minus down"});
  }
  for (const KnownGrid& known : known_grids(adjustment)) lines.push_back(grid_line(known));
  return system::text_table(std::move(lines), 0, {1, 2});
}

// One row for each position of an error along an axis.
std::string function_rows(const std::string& label, const ErrorName& name,
                          const std::vector<double>& at, const std::vector<double>& values,
                          const std::vector<double>& sigma, bool is_combined_with_others) {
  const bool linear = is_linear(name.axis);
  std::string out;
  for (std::size_t i = 0; i < at.size(); ++i) {
    out += fmt::format("{},{:.6f},{},{:.6f},{:.6f},{},{}\n", label, at[i] / (linear ? mm : deg),
                       linear ? "mm" : "deg", values[i] / um, sigma[i] / um,
                       is_linear(name.direction) ? "um" : "urad", is_combined_with_others ? 1 : 0);
  }
  return out;
}

}  // namespace

std::string in_unit(double value, const readings::Group& group) {
  const bool is_angle = readings::is_angular(group.kind, group.axis);
  return fmt::format("{:.3g} {}", value / um, is_angle ? "urad" : "um");
}

std::string function_table(const Calibration& calibration) {
  const Adjustment& adjustment = calibration.adjustment;
  const Unknowns& unknowns = adjustment.unknowns;
  std::string out = "error,position,position_unit,value,standard_uncertainty,unit,in_combination\n";
  for (std::size_t k = 0; k < unknowns.locations.size(); ++k) {
    const int u = unknowns.first_location() + int(k);
    const ErrorName& name = unknowns.locations[k].name;
    if (!(adjustment.covariance(u, u) > 0.0)) continue;
    out += fmt::format("{},,,{:.6f},{:.6f},{},{}\n", plant::to_string(name),
                       adjustment.values[u] / um, std::sqrt(adjustment.covariance(u, u)) / um,
                       is_linear(name.direction) ? "um" : "urad",
                       is_combined(adjustment, name) ? 1 : 0);
  }
  for (const KnownFunction& known : functions_along_travel(adjustment)) {
    out += function_rows(plant::to_string(known.name), known.name, known.s, known.value,
                         known.sigma, is_combined(adjustment, known.name));
  }
  for (const KnownLine& line : lines_of_grids(adjustment)) {
    const bool across = is_linear(line.across);
    const std::string label =
        fmt::format("{} at {} {:g} {}", plant::to_string(line.name), letter(line.across),
                    line.at / (across ? mm : deg), across ? "mm" : "deg");
    out += function_rows(label, line.name, line.s, line.value, line.sigma,
                         is_combined(adjustment, line.name));
  }
  return out;
}

std::string report(const Calibration& calibration) {
  const Adjustment& adjustment = calibration.adjustment;
  std::string out = group_table(calibration) + "\n" + error_table(calibration);
  out += fmt::format(
      "\n{} numbers, {} unknowns, {} excluded; whitened residuals {:.2f} (1 expected)\n",
      calibration.observations.all.size(), adjustment.unknowns.size(), adjustment.left_out.size(),
      adjustment.redundancy > 0.0 ? std::sqrt(adjustment.squares / adjustment.redundancy) : 0.0);
  for (const Smoothness& one : calibration.smoothness) {
    out += fmt::format("{} of {} by cross-validation: {}; excluded readings are predicted within",
                       one.is_of_knots ? "number of knots" : "degree", one.form, one.chosen);
    for (const auto& [number, error] : one.errors) out += fmt::format(" {}: {:.2f}", number, error);
    out += " standard uncertainties\n";
  }
  std::vector<std::string> sentences = unidentifiable_sentences(calibration);
  if (!calibration.one_way.empty()) {
    std::vector<std::string> one_way;
    for (const Axis axis : calibration.one_way) one_way.emplace_back(1, letter(axis));
    sentences.push_back(
        fmt::format("lost motion of {}: positions are read in one direction only, or the readings "
                    "do not give the direction",
                    fmt::join(one_way, ", ")));
  }
  if (!sentences.empty()) {
    out += "\nNot determined by the readings:\n";
    for (const std::string& sentence : sentences) out += "  " + sentence + "\n";
  }
  return out;
}

}  // namespace servomill::sim::calibration
