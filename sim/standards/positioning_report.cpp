#include "sim/standards/positioning_report.h"

#include <fmt/format.h>

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

std::vector<ReportColumn> target_table(const PositioningTest& test) {
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
  return columns;
}

}  // namespace

Report positioning_report(const PositioningFile& file) {
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
  out.columns = target_table(file.test);
  out.remarks = file.remarks;
  for (std::string& one : departures(file.test)) out.remarks.push_back(std::move(one));
  return out;
}

}  // namespace servomill::sim::standards
