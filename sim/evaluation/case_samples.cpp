#include "sim/evaluation/case_samples.h"

#include <algorithm>
#include <array>
#include <optional>

#include "plant/vocabulary/units.h"

namespace servomill::sim::evaluation {

const RowRanges& CaseSamples::rows(const std::vector<std::string>& sections) {
  const auto known = rows_.find(sections);
  return known != rows_.end() ? known->second
                              : rows_.emplace(sections, find_rows(sections)).first->second;
}

RowRanges CaseSamples::find_rows(const std::vector<std::string>& sections) const {
  const records::Series& series = *data_.servo;
  const std::size_t rapid = *series.column("rapid"), section = *series.column("section");
  std::vector<bool> wanted(data_.sections.size(), sections.empty());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (std::find(sections.begin(), sections.end(), data_.sections[i]) != sections.end()) {
      wanted[i] = true;
    }
  }
  RowRanges rows;
  for (std::size_t row = 0; row < series.rows(); ++row) {
    const auto index = static_cast<std::size_t>(series.at(row, section));
    if (series.at(row, rapid) == 0.0 && index < wanted.size() && wanted[index]) rows.add(row);
  }
  return rows;
}

std::vector<Eigen::Vector3d> CaseSamples::positions(std::string_view name,
                                                    const RowRanges& rows) const {
  std::array<std::optional<std::size_t>, 3> columns;
  for (std::size_t i = 0; i < 3; ++i) columns[i] = data_.servo->column(name, "XYZ"[i]);
  std::vector<Eigen::Vector3d> out;
  if (!columns[0] || !columns[1] || !columns[2]) return out;
  out.reserve(rows.size());
  rows.for_each([&](std::size_t row) {
    out.emplace_back(data_.servo->at(row, *columns[0]) * mm, data_.servo->at(row, *columns[1]) * mm,
                     data_.servo->at(row, *columns[2]) * mm);
  });
  return out;
}

AtRow column_of(const CaseData& one, std::string_view name, char label) {
  const auto column = one.servo->column(name, label);
  if (!column) return {};
  return [&servo = *one.servo, c = *column](std::size_t row) { return servo.at(row, c); };
}

}  // namespace servomill::sim::evaluation
