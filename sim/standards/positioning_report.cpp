#include "sim/standards/positioning_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "plant/vocabulary/units.h"

namespace servomill::sim::standards {
namespace {

std::string headline(const PositioningTest& test) {
  const double unit = test.angular ? deg : mm;
  std::string runs;
  if (!test.bidirectional()) {
    const bool up = test.up.cols() > 0;
    const auto count = up ? test.up.cols() : test.down.cols();
    runs = fmt::format("{} run{} {}", count, count == 1 ? "" : "s", up ? "upwards" : "downwards");
  } else if (test.up.cols() == test.down.cols()) {
    runs =
        fmt::format("{} run{} in both directions", test.up.cols(), test.up.cols() == 1 ? "" : "s");
  } else {
    runs = fmt::format("{} runs upwards, {} downwards", test.up.cols(), test.down.cols());
  }
  return fmt::format("{} targets from {:.6g} to {:.6g} {}, {}", test.targets.size(),
                     test.targets[0] / unit, test.targets[test.targets.size() - 1] / unit,
                     test.angular ? "deg" : "mm", runs);
}

ReportTable target_table(const PositioningTest& test) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const Dimension dimension = test.angular ? Dimension::angle : Dimension::length;
  std::vector<ReportColumn> columns;
  for (const char* name :
       {"target", "x_up", "x_down", "mean", "B", "s_up", "s_down", "R_up", "R_down", "R"}) {
    columns.push_back({name, dimension, columns.empty(), {}});
  }
  for (const PositioningTarget& one : evaluate_targets(test)) {
    const Approach none{kNone, kNone};
    const Approach up = one.up.value_or(none), down = one.down.value_or(none);
    std::size_t k = 0;
    for (const double value :
         {one.target, up.mean, down.mean, one.mean, one.B, up.s, down.s, up.R(), down.R(), one.R}) {
      columns[k++].values.push_back(value);
    }
  }
  return {"target", true, {}, std::move(columns)};
}

// U of every source alone, for the bi-directional parameters (or those of the one direction).
ReportTable budget_table(const PositioningTest& test, const PositioningUncertainty& uncertainty) {
  using enum Positioning;
  std::vector<Positioning> shown = {B, R, M, E, A};
  if (!test.bidirectional()) {
    shown =
        test.up.cols() > 0 ? std::vector{R_up, E_up, A_up} : std::vector{R_down, E_down, A_down};
  }
  ReportTable out{"U (k = 2) of each source", false, {}, {}};
  for (const std::string_view name : kSourceNames) out.rows.emplace_back(name);
  for (const Positioning which : shown) {
    ReportColumn column{std::string(kPositioningNames[static_cast<std::size_t>(which)]),
                        test.angular ? Dimension::angle : Dimension::length,
                        false,
                        {}};
    for (const PositioningValues& source : uncertainty.alone) {
      column.values.push_back(at(source, which));
    }
    out.columns.push_back(std::move(column));
  }
  return out;
}

// Parameters whose U is not stated, by what is missing for it.
void report_missing(const PositioningTest& test, const PositioningContributions& contributions,
                    Report& out) {
  std::vector<std::pair<std::string, std::vector<std::string>>> missing;
  for (std::size_t k = 0; k < kPositioningParameters; ++k) {
    if (std::isnan(out.values[k].value)) continue;
    const auto keys = missing_for(contributions, test.angular, static_cast<Positioning>(k));
    if (keys.empty()) continue;
    const std::string text = fmt::format("{}", fmt::join(keys, ", "));
    auto found = std::find_if(missing.begin(), missing.end(),
                              [&](const auto& one) { return one.first == text; });
    if (found == missing.end()) found = missing.insert(found, {text, {}});
    found->second.push_back(out.values[k].symbol);
  }
  for (const auto& [keys, symbols] : missing) {
    out.remarks.push_back(
        fmt::format("U of {} cannot be stated without {}", fmt::join(symbols, ", "), keys));
  }
}

}  // namespace

Report positioning_report(const PositioningFile& file,
                          const std::optional<UncertaintyInput>& uncertainty) {
  Report out;
  out.standard = "ISO 230-2";
  out.name = file.name;
  out.headline = headline(file.test);
  const PositioningValues values = positioning_parameters(evaluate_targets(file.test));
  for (std::size_t k = 0; k < kPositioningParameters; ++k) {
    ReportValue one;
    one.symbol = kPositioningNames[k];
    one.meaning = kPositioningMeanings[k];
    one.value = values[k];
    one.dimension = file.test.angular ? Dimension::angle : Dimension::length;
    out.values.push_back(std::move(one));
  }
  out.tables.push_back(target_table(file.test));
  out.remarks = file.remarks;
  if (uncertainty) {
    const PositioningUncertainty found =
        positioning_uncertainty(file.test, uncertainty->contributions, uncertainty->settings);
    for (std::size_t k = 0; k < kPositioningParameters; ++k) out.values[k].U = found.U[k];
    out.tables.push_back(budget_table(file.test, found));
    report_missing(file.test, uncertainty->contributions, out);
  }
  for (std::string& one : departures(file.test)) out.remarks.push_back(std::move(one));
  return out;
}

void add_periodic_error(const PositioningTest& test, double period, Report& report) {
  const Dimension dimension = test.angular ? Dimension::angle : Dimension::length;
  for (const auto& [deviations, name] :
       {std::pair(&test.up, "up"), std::pair(&test.down, "down")}) {
    if (deviations->cols() == 0) continue;
    const PeriodicError error = periodic_error(test, *deviations, period);
    report.values.push_back({fmt::format("P_{}", name),
                             fmt::format("periodic positioning error, {}wards", name), error.P,
                             dimension});
    report.values.push_back({fmt::format("P_amplitude_{}", name), "amplitude of its first harmonic",
                             error.amplitude, dimension});
  }
}

}  // namespace servomill::sim::standards
