#include "sim/calibration/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "plant/vocabulary/units.h"
#include "sim/system/text_table.h"

namespace servomill::sim::calibration {
namespace {

using plant::ErrorName;
using Lines = std::vector<std::vector<std::string>>;

constexpr std::size_t kShownOutliers = 10;
constexpr double kWrongRatio = 2.0;    // of variances, where the redundancy makes it significant
constexpr double kSignificant = 5.0;   // standard deviations of a ratio
constexpr double kImplausible = 5.0;   // standard uncertainties of a set-up
constexpr double kWrongSize = 0.2e-3;  // m, of a radius or length that is not known

const readings::Group& group_of(const Calibration& calibration, std::size_t group) {
  return calibration.readings.groups[group];
}

bool is_angular(const readings::Group& group) {
  return readings::is_angular(group.kind, group.axis);
}

// "readings.toml:6: ", where a group is to be mended; of readings without a file nothing
std::string place_prefix(const readings::Group& group) {
  if (group.place.file.empty()) return {};
  return to_string(Place{group.place.file, group.place.line, 0}) + ": ";
}

// "readings.toml:6: "X, laser""
std::string placed_name(const readings::Group& group) {
  return fmt::format("{}\"{}\"", place_prefix(group), group.name);
}

// "0.52 um"
std::string in_unit(double value, bool angular) {
  return fmt::format("{:.3g} {}", value / um, angular ? "urad" : "um");
}

std::string group_table(const Calibration& calibration) {
  Lines lines = {
      {"group", "kind", "numbers", "uncertainty", "residual rms", "redundancy", "variance ratio"}};
  for (std::size_t g = 0; g < calibration.readings.groups.size(); ++g) {
    const readings::Group& group = group_of(calibration, g);
    const GroupResult& result = calibration.adjustment.groups[g];
    lines.push_back(
        {group.name, std::string(readings::kKinds[std::size_t(group.kind)]),
         std::to_string(result.numbers),
         in_unit(result.uncertainty, is_angular(group)) + (group.uncertainty ? "" : " (estimated)"),
         in_unit(result.rms, is_angular(group)), fmt::format("{:.1f}", result.redundancy),
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

std::string outlier_sentence(const Calibration& calibration, const Outlier& outlier) {
  const Observation& one = calibration.observations.all[outlier.observation];
  const readings::Group& group = group_of(calibration, one.group);
  return fmt::format(
      "{}: reading of \"{}\" is off by {}, {:.1f} times its standard uncertainty; it counts: check "
      "it at the machine, or leave it out",
      readings::place_of(group, group.rows[one.row]), group.name,
      in_unit(calibration.adjustment.residuals[outlier.observation], is_angular(group)),
      std::abs(outlier.standardized));
}

std::string ratio_sentence(const readings::Group& group, const GroupResult& result) {
  return fmt::format(
      "{}: its residuals are {:.1f} times what its uncertainty of {} implies; the "
      "uncertainty, the form of the errors (knots, a grid over another axis) or the set-up is not "
      "as stated",
      placed_name(group), std::sqrt(result.ratio()),
      in_unit(result.uncertainty, is_angular(group)));
}

// Radii and lengths that come out far from what is stated, and set-ups far from what is known.
void add_set_up_warnings(const Calibration& calibration, std::vector<std::string>& out) {
  const Adjustment& adjustment = calibration.adjustment;
  const std::vector<SetUpUnknown>& set_up = adjustment.unknowns.set_up;
  for (std::size_t u = 0; u < set_up.size(); ++u) {
    const SetUpUnknown& one = set_up[u];
    const double value = adjustment.values[Eigen::Index(u)];
    const std::string name = (one.group ? place_prefix(group_of(calibration, *one.group)) : "") +
                             adjustment.unknowns.name(int(u), calibration.readings);
    const std::string shown = fmt::format("{:.3g} {}", value / one.unit, one.unit_name);
    if (one.prior && std::abs(value) > kImplausible * *one.prior) {
      out.push_back(fmt::format("{} is estimated at {}, {:.0f} times its uncertainty: check it",
                                name, shown, std::abs(value) / *one.prior));
    } else if (!one.prior && one.is_size && std::abs(value) > kWrongSize) {
      out.push_back(fmt::format("{} is estimated {:.3f} mm {} than stated: check it", name,
                                std::abs(value) / mm, value > 0.0 ? "larger" : "smaller"));
    }
  }
}

std::string suspect_sentence(const Calibration& calibration, const Suspect& suspect) {
  std::vector<std::string> names;
  for (const std::size_t group : suspect.groups) {
    names.push_back(placed_name(group_of(calibration, group)));
  }
  const bool one = names.size() == 1;
  const std::string_view verb = one ? "contradicts" : "contradict", its = one ? "its" : "their";
  if (suspect.factor < 0.0) {
    return fmt::format(
        "{} {} the other groups; with the opposite sign {} would agree with them: "
        "check the sign of {} readings",
        fmt::join(names, " and "), verb, one ? "it" : "they", its);
  }
  return fmt::format(
      "{} {} the other groups; {:.4g} times as large {} would agree with them: check "
      "the unit of {} readings",
      fmt::join(names, " and "), verb, suspect.factor, one ? "it" : "they", its);
}

// Targets at which a run is missing that others have.
void add_missing_runs(const readings::Group& group, std::vector<std::string>& out) {
  if (!group.axis) return;
  int runs = 0;
  std::map<std::pair<double, int>, std::vector<const readings::Reading*>> targets;
  for (const readings::Reading& row : group.rows) {
    runs = std::max(runs, row.run + 1);
    // the axis that is measured is the one that has a direction, if any has
    const auto joint = std::max_element(row.direction.begin(), row.direction.end(),
                                        [](int a, int b) { return std::abs(a) < std::abs(b); });
    targets[{row.Q.sum(), *joint}].push_back(&row);
  }
  for (const auto& [target, rows] : targets) {
    const int missing = runs - static_cast<int>(rows.size());
    if (missing <= 0) continue;
    out.push_back(
        fmt::format("{}: {} of {} runs are missing at the target of this line: measure "
                    "them; what is there counts",
                    readings::place_of(group, *rows.front()), missing, runs));
  }
}

bool has_temperature(const readings::Group& group) {
  return std::any_of(group.rows.begin(), group.rows.end(),
                     [](const readings::Reading& row) { return !std::isnan(row.temperature); });
}

// Columns that nothing uses, runs that are missing, directions that nobody has measured.
void add_reading_warnings(const Calibration& calibration, std::vector<std::string>& out) {
  for (const readings::Group& group : calibration.readings.groups) {
    if (group.directions_unused) {
      out.push_back(
          fmt::format("{}: its column direction is not used; readings of kind {} tell "
                      "it of axes where one rotary axis moves only",
                      placed_name(group), readings::kKinds[static_cast<std::size_t>(group.kind)]));
    }
    if (has_temperature(group) && !group.expansion) {
      out.push_back(
          fmt::format("{}: its column temperature_degC is not used; a table expansion "
                      "takes lengths back to 20 degC",
                      placed_name(group)));
    }
    add_missing_runs(group, out);
  }
  for (const Axis axis : calibration.one_way) {
    const auto& groups = calibration.readings.groups;
    const auto first = std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
      return group.kind == readings::Kind::positioning && group.axis == axis;
    });
    out.push_back(
        fmt::format("{}: positions of {} are read in one direction, or their rows do not "
                    "say in which: lost motion of {} stays unknown; add a column "
                    "direction, and runs back",
                    placed_name(*first), letter(axis), letter(axis)));
  }
}

}  // namespace

std::vector<std::string> warnings(const Calibration& calibration) {
  std::vector<std::string> out;
  for (const Suspect& suspect : calibration.suspects) {
    out.push_back(suspect_sentence(calibration, suspect));
  }
  add_reading_warnings(calibration, out);
  add_set_up_warnings(calibration, out);
  for (std::size_t g = 0; g < calibration.adjustment.groups.size(); ++g) {
    const GroupResult& result = calibration.adjustment.groups[g];
    const double spread = std::sqrt(2.0 / std::max(result.redundancy, 1e-9));
    if (result.redundancy > 0.5 && result.ratio() > kWrongRatio &&
        result.ratio() > 1.0 + kSignificant * spread) {
      out.push_back(ratio_sentence(group_of(calibration, g), result));
    }
  }
  const std::size_t shown = std::min(kShownOutliers, calibration.outliers.size());
  for (std::size_t i = 0; i < shown; ++i) {
    out.push_back(outlier_sentence(calibration, calibration.outliers[i]));
  }
  if (shown < calibration.outliers.size()) {
    out.push_back(
        fmt::format("{} more readings are outliers", calibration.outliers.size() - shown));
  }
  return out;
}

namespace {

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
      "\n{} numbers, {} unknowns, {} left out; whitened residuals {:.2f} (1 expected)\n",
      calibration.observations.all.size(), adjustment.unknowns.size(), adjustment.left_out.size(),
      adjustment.redundancy > 0.0 ? std::sqrt(adjustment.squares / adjustment.redundancy) : 0.0);
  for (const Smoothness& one : calibration.smoothness) {
    out += fmt::format("{} of {} by cross-validation: {}; readings left out are predicted within",
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
