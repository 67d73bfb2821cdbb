#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/calibration/report.h"

namespace servomill::sim::calibration {
namespace {

constexpr std::size_t kShownOutliers = 10;
constexpr double kWrongRatio = 2.0;    // of variances, where the redundancy makes it significant
constexpr double kSignificant = 5.0;   // standard deviations of a ratio
constexpr double kImplausible = 5.0;   // standard uncertainties of a set-up
constexpr double kWrongSize = 0.2e-3;  // m, of a radius or length that is not known

const readings::Group& group_of(const Calibration& calibration, std::size_t group) {
  return calibration.readings.groups[group];
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

std::string outlier_sentence(const Calibration& calibration, const Outlier& outlier) {
  const Observation& one = calibration.observations.all[outlier.observation];
  const readings::Group& group = group_of(calibration, one.group);
  return fmt::format(
      "{}: reading of \"{}\" is off by {}, {:.1f} times its standard uncertainty; it is used: "
      "check it at the machine, or remove it",
      readings::place_of(group, group.rows[one.row]), group.name,
      in_unit(calibration.adjustment.residuals[outlier.observation], group),
      std::abs(outlier.standardized));
}

std::string ratio_sentence(const readings::Group& group, const GroupResult& result) {
  return fmt::format(
      "{}: the residuals are {:.1f} times those expected from its uncertainty of {}; check the "
      "uncertainty, the form of the errors (knots, a grid over another axis) and the set-up",
      placed_name(group), std::sqrt(result.ratio()), in_unit(result.uncertainty, group));
}

std::string small_ratio_sentence(const readings::Group& group, const GroupResult& result) {
  return fmt::format(
      "{}: the residuals are {:.3g} times those expected from its uncertainty of {}: readings in a "
      "larger unit than stated (mm for um), copied rows, or an uncertainty stated too large",
      placed_name(group), std::sqrt(result.ratio()), in_unit(result.uncertainty, group));
}

// Residuals that are far too large, or far too small.
void add_ratio_warnings(const Calibration& calibration, std::vector<std::string>& out) {
  constexpr double kFew = 10.0, kTooSmall = 0.04;  // redundancy; variance: a fifth
  for (std::size_t g = 0; g < calibration.adjustment.groups.size(); ++g) {
    const GroupResult& result = calibration.adjustment.groups[g];
    const readings::Group& group = group_of(calibration, g);
    const double spread = std::sqrt(2.0 / std::max(result.redundancy, 1e-9));
    if (result.redundancy > 0.5 && result.ratio() > kWrongRatio &&
        result.ratio() > 1.0 + kSignificant * spread) {
      out.push_back(ratio_sentence(group, result));
    } else if (group.uncertainty && result.redundancy >= kFew && result.ratio() < kTooSmall) {
      out.push_back(small_ratio_sentence(group, result));
    }
  }
}

// Rows that equal an earlier one in every number.
void add_copied_rows(const readings::Group& group, std::vector<std::string>& out) {
  std::map<std::vector<double>, const readings::Reading*> rows;
  int copies = 0;
  const readings::Reading* first = nullptr;
  const readings::Reading* copied = nullptr;
  for (const readings::Reading& row : group.rows) {
    std::vector<double> numbers(row.Q.begin(), row.Q.end());
    numbers.insert(numbers.end(), row.direction.begin(), row.direction.end());
    numbers.insert(numbers.end(), row.deviation.begin(), row.deviation.end());
    numbers.push_back(row.run);
    numbers.push_back(static_cast<double>(row.sphere));
    const auto [found, is_new] = rows.try_emplace(std::move(numbers), &row);
    if (is_new) continue;
    if (copies++ > 0) continue;
    first = &row;
    copied = found->second;
  }
  if (copies == 0) return;
  out.push_back(fmt::format(
      "{}: equals line {} in every value{}; it is used: remove copied rows",
      readings::place_of(group, *first), copied->line,
      copies == 1 ? "" : fmt::format("; so do {} more rows with earlier ones", copies - 1)));
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
        fmt::format("{}: {} of {} runs are missing at the target of this line: measure them; "
                    "existing readings are used",
                    readings::place_of(group, *rows.front()), missing, runs));
  }
}

bool has_temperature(const readings::Group& group) {
  return std::any_of(group.rows.begin(), group.rows.end(),
                     [](const readings::Reading& row) { return !std::isnan(row.temperature); });
}

// Positions of an axis that all rows approach from the same side.
bool is_one_way(const readings::Group& group) {
  if (group.kind != readings::Kind::positioning || !group.axis) return false;
  bool up = false, down = false;
  for (const readings::Reading& row : group.rows) {
    for (const int direction : row.direction) {
      up |= direction > 0;
      down |= direction < 0;
    }
  }
  return !(up && down);
}

bool is_known_one_way(const Calibration& calibration, const readings::Group& group) {
  const auto& axes = calibration.one_way;
  return std::find(axes.begin(), axes.end(), *group.axis) != axes.end();
}

// Columns that nothing uses, runs that are missing, directions that nobody has measured.
void add_reading_warnings(const Calibration& calibration, std::vector<std::string>& out) {
  for (const readings::Group& group : calibration.readings.groups) {
    if (group.directions_unused) {
      out.push_back(
          fmt::format("{}: the column direction is not used; readings of kind {} define it only if "
                      "a single rotary axis moves",
                      placed_name(group), readings::kKinds[static_cast<std::size_t>(group.kind)]));
    }
    if (has_temperature(group) && !group.expansion) {
      out.push_back(
          fmt::format("{}: its column temperature_degC is not used; a table expansion corrects "
                      "lengths to 20 degC",
                      placed_name(group)));
    }
    add_missing_runs(group, out);
    add_copied_rows(group, out);
    if (is_one_way(group) && !is_known_one_way(calibration, group)) {
      out.push_back(
          fmt::format("{}: {} is read in one direction only; its lost motion comes from "
                      "the other groups",
                      placed_name(group), letter(*group.axis)));
    }
  }
  for (const Axis axis : calibration.one_way) {
    const auto& groups = calibration.readings.groups;
    const auto first = std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
      return group.kind == readings::Kind::positioning && group.axis == axis;
    });
    out.push_back(fmt::format(
        "{}: positions of {} are read in one direction, or their rows do not state the direction: "
        "lost motion of {} is unknown; add a column direction, and runs in the other direction",
        placed_name(*first), letter(axis), letter(axis)));
  }
}

}  // namespace

void refuse_contradictions(const Calibration& calibration) {
  if (calibration.suspects.empty()) return;
  std::vector<std::string> sentences;
  for (const Suspect& suspect : calibration.suspects) {
    sentences.push_back(suspect_sentence(calibration, suspect));
  }
  throw InputError({calibration.readings.path},
                   fmt::format("readings contradict each other, no machine is written: {}; correct "
                               "or remove them, or use --accept-contradictions",
                               fmt::join(sentences, "; ")));
}

std::vector<std::string> warnings(const Calibration& calibration) {
  std::vector<std::string> out;
  for (const Suspect& suspect : calibration.suspects) {
    out.push_back(suspect_sentence(calibration, suspect));
  }
  add_reading_warnings(calibration, out);
  add_set_up_warnings(calibration, out);
  add_ratio_warnings(calibration, out);
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

}  // namespace servomill::sim::calibration
