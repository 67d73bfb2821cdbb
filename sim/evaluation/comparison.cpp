#include "sim/evaluation/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/ball_quantities.h"
#include "sim/evaluation/case_samples.h"
#include "sim/evaluation/circular_quantities.h"
#include "sim/evaluation/path_quantities.h"
#include "sim/evaluation/probe_quantities.h"
#include "sim/evaluation/statistic.h"
#include "sim/model/scenario.h"
#include "sim/system/json.h"
#include "sim/system/text_table.h"

namespace servomill::sim {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

constexpr std::array<QuantityInfo, 38> kQuantities = {{
    {"imposed_curve_residual", "um",
     "trajectory (scale) minus that of the base case minus the imposed displacement, at equal s",
     true, "XYZ", true, true, true},
    {"brought_out", "%", "1 - largest imposed_curve_residual / largest imposed displacement", true,
     "XYZ", false, true, true},
    {"response_time", "ms",
     "delay that explains the imposed_curve_residual best, by least squares over its samples", true,
     "XYZ", false, true, true},
    {"trajectory_difference", "um", "trajectory (scale) minus that of the base case, at equal s",
     true, "XYZ", true, true, false},
    {"following_error", "um", "set point minus position that the NC reads", true, "XYZ", true,
     false, false},
    {"tool_deviation", "um", "true minus nominal tool centre point at equal s, in the workpiece",
     true, "XYZ", true, false, false},
    {"tool_tip_deviation", "um",
     "distance of the true from the nominal tool centre point at equal s", false, "", true, false,
     false},
    {"tool_axis_deviation", "urad", "angle between the true and the nominal tool axis at equal s",
     false, "", true, false, false},
    {"contour_error", "um", "distance of the true tool centre point to the nominal path", false, "",
     true, false, false},
    {"tool_difference", "um",
     "distance of the true tool centre point from that of the base case, at equal s", false, "",
     true, true, false},
    {"cycle_time", "s", "duration of the program that the NC runs", false, "", false, false, false},
    {"blocks", "1", "motion blocks of the program that the NC runs", false, "", false, false,
     false},
    {"circular_deviation", "um",
     "ISO 230-4 G: smallest radial separation of two concentric circles around the true path",
     false, "", false, false, false, 1},
    {"circular_deviation_least_squares", "um",
     "G about the least-squares centre: range of the radial deviation", false, "", false, false,
     false, 1},
    {"bidirectional_circular_deviation", "um",
     "ISO 230-4 G(b): the same as G around the paths of both directions", false, "", false, false,
     false, 2},
    {"radial_deviation_max", "um",
     "ISO 230-4 F max: largest deviation from the nominal radius, about the least-squares centre",
     false, "", false, false, false, 1},
    {"radial_deviation_min", "um",
     "ISO 230-4 F min: smallest deviation from the nominal radius, about the least-squares centre",
     false, "", false, false, false, 1},
    {"mean_bidirectional_radial_deviation", "um",
     "ISO 230-4 D: nominal radius minus that of the least-squares circle of both directions", false,
     "", false, false, false, 2},
    {"reversal_spike", "um",
     "larger one of the two excursions where the axis reverses on a circle; outward positive", true,
     "XYZ", false, false, false, 1},
    {"reversal_step", "um",
     "larger one of the two steps of the radius where the axis reverses on a circle", true, "XYZ",
     false, false, false, 1},
    {"circle_squareness", "urad",
     "(D45 - D135) / (2 R) of a circle, mean of both directions; positive: less than 90 deg", false,
     "", false, false, false, 2},
    {"radial_ball_deviation", "um",
     "R-test: a ball in the spindle relative to the table, away from the rotary axis that turns",
     false, "", true, false, false, 0, true},
    {"axial_ball_deviation", "um", "R-test: the same along that axis", false, "", true, false,
     false, 0, true},
    {"tangential_ball_deviation", "um", "R-test: the same in the sense in which the axis counts",
     false, "", true, false, false, 0, true},
    {"ball_bar_deviation", "um",
     "ISO 10791-6 BK4: length of a ball bar between centre_mm of [[quantity.bar]] and the tip, "
     "minus its nominal",
     false, "", true, false, false, 0, true},
    {"location_error", "um",
     "identified by a nest of sensors, or by each [[quantity.bar]]; angles in urad", false, "",
     false, false, false, 0, true},
    {"probed_deviation", "um",
     "probed points along their normals, minus nominal; with a base case minus those of it", false,
     "", true, false, false, 0, false, 1},
    {"probed_imposed_residual", "um",
     "the same minus those of the base case minus the imposed displacement along the normals",
     false, "", true, true, true, 0, false, 1},
    {"probed_position", "um",
     "fitted centre of a probed circle or cylinder, else mean of the points, minus nominal", true,
     "XYZ", false, false, false, 0, false, 1},
    {"straightness", "um", "of a probed line: smallest distance of two parallels around it", false,
     "", false, false, false, 0, false, 1, true},
    {"flatness", "um", "of a probed plane: smallest distance of two parallel planes around it",
     false, "", false, false, false, 0, false, 1, true},
    {"plane_rotation", "deg",
     "turn of the least-squares plane of a probed plane about an axis, out of nominal", true, "XYZ",
     false, false, false, 0, false, 1},
    {"roundness", "um", "of a probed circle: smallest radial separation of two circles around it",
     false, "", false, false, false, 0, false, 1, true},
    {"cylindricity", "um",
     "of a probed cylinder: smallest radial separation of two coaxial cylinders around it", false,
     "", false, false, false, 0, false, 1, true},
    {"diameter", "um", "least-squares diameter of a probed circle or cylinder, minus nominal",
     false, "", false, false, false, 0, false, 1},
    {"angle", "um/m",
     "between two probed lines (from_mm to to_mm) or planes (normals), least squares, minus "
     "nominal",
     false, "", false, false, false, 0, false, 2},
    {"squareness", "um/m", "the same of features at right angles; positive: more than 90 deg",
     false, "", false, false, false, 0, false, 2},
    {"distortion", "um",
     "probed points of all features (or those of `probes`) from the part (`part.stl`; without one "
     "from the planes through their nominal points) after best fit",
     false, "", true, false, false, 0, false, kEveryProbe},
}};

double statistic_of(const std::string& name, const std::vector<double>& values) {
  Statistic statistic(name);
  for (const double v : values) statistic.add(v);
  return statistic.value();
}

// A case with what several quantities look at.
struct Compared {
  explicit Compared(const CaseData& data_in)
      : data(data_in), samples(data_in), circles(samples), ball(samples) {}
  const CaseData& data;
  CaseSamples samples;
  CircularQuantities circles;
  BallQuantities ball;
};

// A value, or why there is none.
struct Noted {
  double value = kNone;
  std::string note = {};
};

Noted evaluate(const QuantitySpec& spec, Compared& compared, const CaseData* base) {
  const CaseData& one = compared.data;
  if (spec.name == "cycle_time") return {one.duration};
  if (spec.name == "blocks") return {one.blocks};
  if (!one.finished || (base != nullptr && !base->finished)) return {};
  if (quantity_info(spec.name).circles > 0) return {compared.circles.value(spec)};
  PathValue found = path_value(spec, compared.samples, base);
  return {found.value, std::move(found.note)};
}

Noted evaluate_ball(const QuantitySpec& spec, Compared& compared) {
  if (!compared.data.finished) return {};
  if (spec.name == "location_error") {
    const auto [value, why_not] = compared.ball.location(spec);
    return {value, why_not};
  }
  const BallDeviation found = compared.ball.deviation(spec);
  return {statistic_of(spec.statistic, found.d), found.why_not};
}

Noted evaluate_probe(const QuantitySpec& spec, const CaseData& one, const CaseData* base) {
  if (!one.finished || (base != nullptr && !base->finished)) return {};
  if (quantity_info(spec.name).has_statistic) {
    const ProbedDeviations found = probed_deviations(spec, one, base);
    return {statistic_of(spec.statistic, found.d), found.note};
  }
  const ProbedValue found = probed_value(spec, one, base);
  return {found.value, found.note};
}

// Difference of a case and its base that is not what they are compared for: readings that are late
// displace an axis by its speed times that.
std::string unlike(const CaseData& one, const CaseData& base) {
  if (!one.signal_delay || !base.signal_delay) return {};
  if (*one.signal_delay == *base.signal_delay) return {};
  return fmt::format("feedback hardware delays readings by {:g} us, those of {} by {:g} us",
                     *one.signal_delay / us, base.name, *base.signal_delay / us);
}

// Value of a quantity of one case, with a note on it.
Noted answer(const QuantitySpec& spec, Compared& one, const CaseData* base) {
  const QuantityInfo& info = quantity_info(spec.name);
  if (info.needs_base && one.data.name == spec.base) return {kNone, "is compared with itself"};
  Noted found = info.is_of_ball ? evaluate_ball(spec, one)
                : spec.part     ? evaluate_probe(spec, one.data, base)
                                : evaluate(spec, one, base);
  if (found.note.empty() && base != nullptr) found.note = unlike(one.data, *base);
  return found;
}

Compared* find(std::deque<Compared>& cases, std::string_view name) {
  for (Compared& one : cases) {
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

}  // namespace

std::span<const QuantityInfo> quantities() { return kQuantities; }

std::vector<std::string_view> quantity_names() {
  std::vector<std::string_view> out;
  for (const QuantityInfo& info : kQuantities) out.push_back(info.name);
  return out;
}

const QuantityInfo& quantity_info(std::string_view name) {
  const auto found = std::find_if(kQuantities.begin(), kQuantities.end(),
                                  [&](const QuantityInfo& info) { return info.name == name; });
  assert(found != kQuantities.end());
  return *found;
}

std::vector<ComparisonRow> compare(std::span<const QuantitySpec> specs,
                                   std::span<const CaseData> cases) {
  std::deque<Compared> compared;
  for (const CaseData& one : cases) compared.emplace_back(one);
  std::vector<ComparisonRow> rows;
  for (const QuantitySpec& spec : specs) {
    throw_if_interrupted();
    const Compared* base = spec.base.empty() ? nullptr : find(compared, spec.base);
    for (const std::string& name : spec.cases) {
      Compared* one = find(compared, name);
      ComparisonRow row;
      row.case_name = name;
      row.quantity = spec.name;
      if (spec.axis != '\0') row.axis = std::string(1, spec.axis);
      row.statistic = spec.statistic;
      row.sections = fmt::format("{}", fmt::join(spec.sections, ", "));
      row.unit = quantity_info(spec.name).unit;
      if (spec.ball && spec.ball->error) {
        row.axis = plant::to_string(*spec.ball->error);
        row.unit = unit_of_location(*spec.ball->error);
      }
      if (spec.part) row.sections = fmt::format("{}", fmt::join(spec.part->probes, ", "));
      row.reference = spec.reference;
      row.kind = spec.kind;
      const bool missing = one == nullptr || (!spec.base.empty() && base == nullptr);
      Noted found = missing ? Noted{} : answer(spec, *one, base != nullptr ? &base->data : nullptr);
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
                                                  "case", "value", "paper", "kind",
                                                  has_notes ? "note" : ""}};
  for (const ComparisonRow& row : rows) {
    lines.push_back({row.quantity, row.axis, row.statistic, row.sections, row.case_name,
                     number(row.value) + " " + (row.unit == "1" ? "" : row.unit), row.reference,
                     row.kind, row.note});
  }
  return text_table(std::move(lines), 4, {5});
}

std::string to_json(const ComparisonRow& row) {
  JsonObject out;
  out.text_or_null("case", row.case_name)
      .text_or_null("quantity", row.quantity)
      .text_or_null("axis", row.axis)
      .text_or_null("statistic", row.statistic)
      .text_or_null("sections", row.sections)
      .number("value", row.value)
      .text_or_null("unit", row.unit)
      .text_or_null("reference", row.reference)
      .text_or_null("kind", row.kind);
  if (!row.note.empty()) out.text("note", row.note);
  return out.line();
}

}  // namespace servomill::sim
