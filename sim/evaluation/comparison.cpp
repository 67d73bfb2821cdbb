#include "sim/evaluation/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/case_evaluation.h"
#include "sim/evaluation/quantity.h"
#include "sim/evaluation/r_test_quantities.h"
#include "sim/model/scenario.h"
#include "sim/system/json.h"
#include "sim/system/text_table.h"

namespace servomill::sim::evaluation {
namespace {

// Difference of a case and its base that is not what they are compared for: readings that are late
// displace an axis by its speed times that.
std::string unlike(const CaseData& one, const CaseData& base) {
  if (!one.signal_delay || !base.signal_delay) return {};
  if (*one.signal_delay == *base.signal_delay) return {};
  return fmt::format("the feedback hardware delays readings by {:g} us, those of {} by {:g} us",
                     *one.signal_delay / us, base.name, *base.signal_delay / us);
}

// Values of a recording of some windows: those of shapes need every row, others are of what is
// there.
QuantityValue inside_windows(const model::QuantitySpec& spec, CaseEvaluation& one,
                             const CaseData* base) {
  const QuantityEntry& entry = quantity_entry(spec.name);
  if (entry.is_of_program || rows_left_out(one.data, spec.sections) == 0) {
    return entry.evaluate(spec, one, base);
  }
  if (entry.needs_every_row()) return {.note = "needs every row; record.windows leave out some"};
  if (one.samples.rows(spec.sections).size() == 0) {
    return {.note = "record.windows leave out every row"};
  }
  QuantityValue found = entry.evaluate(spec, one, base);
  const bool has_more = !found.note.empty();
  found.note = "inside record.windows" + std::string(has_more ? "; " : "") + found.note;
  return found;
}

// Value of a quantity of one case, with a note on it.
QuantityValue answer(const model::QuantitySpec& spec, CaseEvaluation& one, const CaseData* base) {
  const QuantityEntry& entry = quantity_entry(spec.name);
  if (entry.needs_baseline && one.data.name == spec.baseline)
    return {.note = "is compared with itself"};
  const bool both_finished = one.data.finished && (base == nullptr || base->finished);
  QuantityValue found;
  if (entry.is_of_program || both_finished) found = inside_windows(spec, one, base);
  if (found.note.empty() && base != nullptr) found.note = unlike(one.data, *base);
  return found;
}

CaseEvaluation* find(std::deque<CaseEvaluation>& cases, std::string_view name) {
  for (CaseEvaluation& one : cases) {
    if (one.data.name == name) return &one;
  }
  return nullptr;
}

std::string number(double value) {
  if (!std::isfinite(value)) return "-";
  const double size = std::abs(value);
  const int decimals = size >= 100.0 ? 1 : size >= 10.0 ? 2 : size >= 0.1 ? 3 : 4;
  return fmt::format("{:.{}f}", value, decimals);
}

// "+-20, met"
std::string shown_tolerance(const ComparisonRow& row) {
  if (!row.tolerance) return {};
  const std::string limits = tolerance_text(*row.tolerance);
  if (!std::isfinite(row.value)) return limits;
  return limits + (row.tolerance->contains(row.value) ? ", met" : ", exceeded");
}

// The tolerance is the sixth cell, where there is one at all.
std::vector<std::vector<std::string>> without_empty_tolerances(
    std::vector<std::vector<std::string>> lines, std::span<const ComparisonRow> rows) {
  const bool has_some =
      std::any_of(rows.begin(), rows.end(), [](const auto& row) { return row.tolerance; });
  if (has_some) return lines;
  for (auto& line : lines) line.erase(line.begin() + 6);
  return lines;
}

}  // namespace

std::string tolerance_text(const model::Tolerance& tolerance) {
  if (tolerance.is_symmetric()) return fmt::format("+-{:g}", tolerance.upper);
  return fmt::format("{:g} to {:g}", tolerance.lower, tolerance.upper);
}

std::vector<ComparisonRow> compare(std::span<const model::QuantitySpec> specs,
                                   std::span<const CaseData> cases) {
  std::deque<CaseEvaluation> compared;
  for (const CaseData& one : cases) compared.emplace_back(one);
  std::vector<ComparisonRow> rows;
  for (const model::QuantitySpec& spec : specs) {
    throw_if_interrupted();
    const CaseEvaluation* base = spec.baseline.empty() ? nullptr : find(compared, spec.baseline);
    for (const std::string& name : spec.cases) {
      CaseEvaluation* one = find(compared, name);
      ComparisonRow row;
      row.case_name = name;
      row.quantity = spec.name;
      if (spec.axis != '\0') row.axis = std::string(1, spec.axis);
      row.statistic = spec.statistic;
      row.sections = fmt::format("{}", fmt::join(spec.sections, ", "));
      row.unit = quantity_entry(spec.name).unit;
      if (spec.ball && spec.ball->error) {
        row.axis = plant::to_string(*spec.ball->error);
        row.unit = unit_of_location(*spec.ball->error);
      }
      if (spec.part) row.sections = fmt::format("{}", fmt::join(spec.part->probes, ", "));
      row.reference = spec.reference;
      row.basis = spec.basis;
      row.tolerance = spec.tolerance;
      const bool missing = one == nullptr || (!spec.baseline.empty() && base == nullptr);
      QuantityValue found =
          missing ? QuantityValue{} : answer(spec, *one, base != nullptr ? &base->data : nullptr);
      row.value = found.value;
      row.note = std::move(found.note);
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

std::string format_table(std::span<const ComparisonRow> rows) {
  const bool has_notes =
      std::any_of(rows.begin(), rows.end(), [](const auto& row) { return !row.note.empty(); });
  std::vector<std::vector<std::string>> lines = {{"quantity", "axis", "statistic", "section",
                                                  "case", "value", "tolerance", "reference",
                                                  "basis", has_notes ? "note" : ""}};
  for (const ComparisonRow& row : rows) {
    lines.push_back({row.quantity, row.axis, row.statistic, row.sections, row.case_name,
                     number(row.value) + " " + (row.unit == "1" ? "" : row.unit),
                     shown_tolerance(row), row.reference, row.basis, row.note});
  }
  return system::text_table(without_empty_tolerances(std::move(lines), rows), 4, {5});
}

std::string to_json(const ComparisonRow& row) {
  system::JsonObject out;
  out.text_or_null("case", row.case_name)
      .text_or_null("quantity", row.quantity)
      .text_or_null("axis", row.axis)
      .text_or_null("statistic", row.statistic)
      .text_or_null("sections", row.sections)
      .number("value", row.value)
      .text_or_null("unit", row.unit)
      .text_or_null("reference", row.reference)
      .text_or_null("basis", row.basis);
  if (!row.note.empty()) out.text("note", row.note);
  if (row.tolerance) {
    const std::vector<std::string> limits = {system::json_number(row.tolerance->lower),
                                             system::json_number(row.tolerance->upper)};
    out.raw("tolerance", system::json_list(limits));
    if (std::isfinite(row.value)) {
      out.boolean("is_within_tolerance", row.tolerance->contains(row.value));
    }
  }
  return out.line();
}

}  // namespace servomill::sim::evaluation
