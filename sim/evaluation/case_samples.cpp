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
  const auto in_window = series.column("in_window");
  RowRanges rows;
  for (std::size_t row = 0; row < series.rows(); ++row) {
    if (in_window && series.at(row, *in_window) == 0.0) continue;
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

std::size_t rows_left_out(const CaseData& one, const std::vector<std::string>& sections) {
  std::size_t sum = 0;
  for (std::size_t i = 0; i < one.left_out.size(); ++i) {
    const bool counts = sections.empty() ||
                        (i < one.sections.size() && std::find(sections.begin(), sections.end(),
                                                              one.sections[i]) != sections.end());
    if (counts) sum += one.left_out[i];
  }
  return sum;
}

bool follows(const records::Series& series, std::optional<std::size_t> window, std::size_t row) {
  return !window || series.at(row, *window) == series.at(row - 1, *window);
}

RowRanges rows_with_counterpart(const CaseData& one, const CaseData& base, const RowRanges& rows) {
  const records::Series &mine = *one.servo, &theirs = *base.servo;
  const auto window = theirs.column("window");
  if (!window || theirs.rows() == 0) return rows;
  const std::size_t s = *mine.column("s"), s_base = *theirs.column("s");
  RowRanges out;
  std::size_t next = 0;  // of theirs, after s
  rows.for_each([&](std::size_t row) {
    while (next < theirs.rows() && theirs.at(next, s_base) <= mine.at(row, s)) ++next;
    if (next == theirs.rows() || (next > 0 && follows(theirs, window, next))) out.add(row);
  });
  return out;
}

AtRow column_of(const CaseData& one, std::string_view name, char label) {
  const auto column = one.servo->column(name, label);
  if (!column) return {};
  return [&servo = *one.servo, c = *column](std::size_t row) { return servo.at(row, c); };
}

}  // namespace servomill::sim::evaluation
