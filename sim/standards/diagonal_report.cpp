#include "sim/standards/diagonal_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace servomill::sim::standards {

Report diagonal_report(const std::vector<PositioningFile>& diagonals) {
  using enum Positioning;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  constexpr std::array kShown = {E, R, B, A, M};
  constexpr std::size_t kParameters = 4;  // of these, of all diagonals
  constexpr std::size_t kOfBody = 4, kOfFace = 2;
  Report out;
  out.standard = "ISO 230-6";
  out.name = fmt::format("{} diagonals", diagonals.size());
  out.headline = "parameters of each diagonal, and the largest";
  ReportTable table{"diagonal", false, {}, {}};
  for (const Positioning which : kShown) {
    table.columns.push_back({std::string(kPositioningNames[static_cast<std::size_t>(which)]),
                             Dimension::length,
                             false,
                             {}});
  }
  std::array<double, kParameters> largest{};
  for (const PositioningFile& diagonal : diagonals) {
    table.rows.push_back(diagonal.name);
    const PositioningValues one = positioning_parameters(evaluate_targets(diagonal.test));
    for (std::size_t k = 0; k < kShown.size(); ++k) {
      const double value = at(one, kShown[k]);
      table.columns[k].values.push_back(value);
      if (k >= kParameters) continue;
      largest[k] =
          std::isnan(value) || std::isnan(largest[k]) ? kNone : std::max(largest[k], value);
    }
    for (const std::string& remark : diagonal.remarks) out.remarks.push_back(remark);
    for (const std::string& remark : departures(diagonal.test)) {
      out.remarks.push_back(fmt::format("{}: {}", diagonal.name, remark));
    }
  }
  constexpr std::array<std::string_view, kParameters> kMeanings = {
      "diagonal systematic deviation", "diagonal repeatability", "diagonal reversal error",
      "diagonal positioning accuracy"};
  for (std::size_t k = 0; k < kParameters; ++k) {
    out.values.push_back(
        {fmt::format("{}_d", kPositioningNames[static_cast<std::size_t>(kShown[k])]),
         std::string(kMeanings[k]), largest[k]});
  }
  out.tables.push_back(std::move(table));
  if (diagonals.size() != kOfBody && diagonals.size() != kOfFace) {
    out.remarks.push_back(
        fmt::format("{} of the diagonals are given; ISO 230-6 requires {} of the "
                    "body or {} of a face",
                    diagonals.size(), kOfBody, kOfFace));
  }
  return out;
}

}  // namespace servomill::sim::standards
