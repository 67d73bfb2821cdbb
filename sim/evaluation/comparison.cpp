#include "sim/evaluation/comparison.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/tool_axis.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/ball_quantities.h"
#include "sim/evaluation/case_samples.h"
#include "sim/evaluation/circular_quantities.h"
#include "sim/evaluation/probe_quantities.h"
#include "sim/model/scenario.h"
#include "sim/system/text_table.h"

namespace servomill::sim {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kUmPerMm = 1000.0;
constexpr double kMsPerS = 1000.0;

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

// Reads a column of another case at a given arc length; s is asked for in rising order.
class AlongPath {
 public:
  AlongPath(const Series& series, std::size_t column)
      : series_(series), column_(column), s_(*series.column("s")) {}

  double at(double s) {
    const std::size_t rows = series_.rows();
    while (row_ + 1 < rows && series_.at(row_ + 1, s_) <= s) ++row_;
    if (row_ + 1 == rows) return series_.at(row_, column_);
    const double s0 = series_.at(row_, s_), s1 = series_.at(row_ + 1, s_);
    const double weight = std::clamp((s - s0) / (s1 - s0), 0.0, 1.0);
    return (1.0 - weight) * series_.at(row_, column_) + weight * series_.at(row_ + 1, column_);
  }

 private:
  const Series& series_;
  std::size_t column_, s_;
  std::size_t row_ = 0;
};

double statistic_of(const std::string& statistic, const std::vector<double>& values) {
  const auto is_none = [](double v) { return std::isnan(v); };
  if (values.empty() || std::any_of(values.begin(), values.end(), is_none)) return kNone;
  const auto n = static_cast<double>(values.size());
  if (statistic == "mean" || statistic == "rms") {
    double sum = 0.0;
    for (const double v : values) sum += statistic == "mean" ? v : v * v;
    return statistic == "mean" ? sum / n : std::sqrt(sum / n);
  }
  if (statistic == "range") {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return *high - *low;
  }
  double largest = 0.0;  // max: by magnitude
  for (const double v : values) largest = std::max(largest, std::abs(v));
  return largest;
}

// meas(case) - meas(base) at equal s, um
std::vector<double> trajectory_difference(const CaseData& one, const CaseData& base, char axis,
                                          const std::vector<std::size_t>& rows) {
  const auto column = one.servo->column("meas_linear", axis);
  const auto base_column = base.servo->column("meas_linear", axis);
  if (!column || !base_column || base.servo->rows() == 0) return {};
  const std::size_t s = *one.servo->column("s");
  AlongPath nominal(*base.servo, *base_column);
  std::vector<double> out;
  out.reserve(rows.size());
  for (const std::size_t row : rows) {
    out.push_back((one.servo->at(row, *column) - nominal.at(one.servo->at(row, s))) * kUmPerMm);
  }
  return out;
}

// |p_WT(case) - p_WT(base)| at equal s, um
std::vector<double> tool_difference(const CaseData& one, const CaseData& base,
                                    const std::vector<std::size_t>& rows) {
  if (base.servo->rows() == 0) return {};
  const std::size_t s = *one.servo->column("s");
  std::vector<double> out(rows.size(), 0.0);
  for (const char axis : std::string_view("XYZ")) {
    const std::size_t column = *one.servo->column("tool_position_true", axis);
    AlongPath there(*base.servo, *base.servo->column("tool_position_true", axis));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double off = one.servo->at(rows[i], column) - there.at(one.servo->at(rows[i], s));
      out[i] = std::hypot(out[i], off * kUmPerMm);
    }
  }
  return out;
}

std::vector<double> column_of(const CaseData& one, std::string_view name, char label,
                              const std::vector<std::size_t>& rows) {
  const auto column = one.servo->column(name, label);
  if (!column) return {};
  std::vector<double> out;
  out.reserve(rows.size());
  for (const std::size_t row : rows) out.push_back(one.servo->at(row, *column));
  return out;
}

Eigen::Vector3d vector_at(const CaseData& one, std::size_t row, std::size_t first) {
  return {one.servo->at(row, first), one.servo->at(row, first + 1), one.servo->at(row, first + 2)};
}

std::vector<double> tool_tip_deviation(const CaseData& one, const std::vector<std::size_t>& rows) {
  const std::size_t first = *one.servo->column("tool_deviation", 'X');
  std::vector<double> out;
  for (const std::size_t row : rows) out.push_back(vector_at(one, row, first).norm());
  return out;
}

// urad
std::vector<double> tool_axis_deviation(const CaseData& one, const std::vector<std::size_t>& rows) {
  const std::size_t nominal = *one.servo->column("tool_axis_nominal", 'I');
  const std::size_t actual = *one.servo->column("tool_axis_true", 'I');
  std::vector<double> out;
  for (const std::size_t row : rows) {
    out.push_back(angle_between(vector_at(one, row, nominal), vector_at(one, row, actual)) / urad);
  }
  return out;
}

// tau with residual = -tau d(imposed)/dt in the least-squares sense, ms
double response_time(const CaseData& one, char axis, const std::vector<std::size_t>& rows,
                     const std::vector<double>& residual) {
  const auto imposed = one.servo->column("imposed_linear", axis);
  const std::size_t time = *one.servo->column("time");
  if (!imposed || residual.size() != rows.size()) return kNone;
  double re = 0.0, ee = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t row = rows[i];
    if (row == 0 || row + 1 >= one.servo->rows()) continue;
    const double de = (one.servo->at(row + 1, *imposed) - one.servo->at(row - 1, *imposed)) /
                      (one.servo->at(row + 1, time) - one.servo->at(row - 1, time));
    re += residual[i] * de;
    ee += de * de;
  }
  return ee > 0.0 ? -re / ee * kMsPerS : kNone;
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

// The values that belong to rows of the case; none if something was not recorded.
std::vector<double> signed_values(const QuantitySpec& spec, const CaseData& one,
                                  const CaseData* base, const std::vector<std::size_t>& rows) {
  if (spec.name == "following_error") {
    return column_of(one, "following_error_linear", spec.axis, rows);
  }
  if (spec.name == "tool_deviation") return column_of(one, "tool_deviation", spec.axis, rows);
  assert(base != nullptr);
  std::vector<double> difference = trajectory_difference(one, *base, spec.axis, rows);
  if (spec.name == "trajectory_difference") return difference;
  assert(spec.name == "imposed_curve_residual");
  const std::vector<double> imposed = column_of(one, "imposed_linear", spec.axis, rows);
  if (imposed.size() != difference.size()) return {};
  for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= imposed[i];
  return difference;
}

// Whether the tool stands from one place to another (mm): both are the same but for rounding.
bool stands(double s, double later) { return later - s < 1e-7; }

// What rotary axes have turned at each row since the tool stands there, as a share of all that they
// turn until it moves on.
std::vector<double> turned_while_standing(const CaseData& one, const std::vector<std::size_t>& rows,
                                          const std::vector<double>& s) {
  std::vector<double> out(rows.size(), 0.0);
  for (const char axis : std::string_view("ABC")) {
    const std::vector<double> ref = column_of(one, "ref_rotary", axis, rows);
    for (std::size_t i = 1; i < ref.size(); ++i) out[i] += std::abs(ref[i] - ref[i - 1]);
  }
  for (std::size_t first = 0, end = 0; first < rows.size(); first = end) {
    double turned = 0.0;
    for (end = first; end < rows.size() && (end == first || stands(s[end - 1], s[end])); ++end) {
      out[end] = end == first ? 0.0 : out[end] + out[end - 1];
      turned = out[end];
    }
    for (std::size_t i = first; i < end && turned > 0.0; ++i) out[i] /= turned;
  }
  return out;
}

double evaluate(const QuantitySpec& spec, Compared& compared, const CaseData* base) {
  const CaseData& one = compared.data;
  if (spec.name == "cycle_time") return one.duration;
  if (spec.name == "blocks") return one.blocks;
  if (!one.finished || (base != nullptr && !base->finished)) return kNone;
  if (quantity_info(spec.name).circles > 0) return compared.circles.value(spec);
  const std::vector<std::size_t>& rows = compared.samples.rows(spec.sections);
  if (has_path_signal(spec.name)) {
    return statistic_of(spec.statistic, signed_values(spec, one, base, rows));
  }
  if (spec.name == "tool_tip_deviation") {
    return statistic_of(spec.statistic, tool_tip_deviation(one, rows));
  }
  if (spec.name == "tool_axis_deviation") {
    return statistic_of(spec.statistic, tool_axis_deviation(one, rows));
  }
  if (spec.name == "contour_error") {
    return statistic_of(spec.statistic, column_of(one, "contour_error", '\0', rows));
  }
  assert(base != nullptr);
  if (spec.name == "tool_difference") {
    return statistic_of(spec.statistic, tool_difference(one, *base, rows));
  }
  // the other two look at the imposed curve, too
  QuantitySpec residual = spec;
  residual.name = "imposed_curve_residual";
  const std::vector<double> difference = signed_values(residual, one, base, rows);
  const std::vector<double> imposed = column_of(one, "imposed_linear", spec.axis, rows);
  if (imposed.size() != difference.size()) return kNone;
  if (spec.name == "response_time") return response_time(one, spec.axis, rows, difference);
  assert(spec.name == "brought_out");
  return 100.0 * (1.0 - statistic_of("max", difference) / statistic_of("max", imposed));
}

// A value, or why there is none.
struct Noted {
  double value = kNone;
  std::string note = {};
};

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
                                : Noted{evaluate(spec, one, base)};
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

std::string json_text(const std::string& text) {
  return text.empty() ? "null" : fmt::format("\"{}\"", json_escaped(text));
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

bool has_path_signal(std::string_view quantity) {
  return quantity == "imposed_curve_residual" || quantity == "trajectory_difference" ||
         quantity == "tool_deviation" || quantity == "following_error";
}

PathSignal path_signal(const QuantitySpec& spec, const CaseData& one, const CaseData* base) {
  assert(has_path_signal(spec.name));
  CaseSamples samples(one);
  const std::vector<std::size_t>& rows = samples.rows(spec.sections);
  PathSignal out;
  out.s = column_of(one, "s", '\0', rows);
  out.turned = turned_while_standing(one, rows, out.s);
  out.value = signed_values(spec, one, base, rows);
  return out;
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

std::string json_escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20) {
      out += fmt::format("\\u{:04x}", static_cast<int>(c));
    } else {
      out += c;
    }
  }
  return out;
}

std::string to_json(const ComparisonRow& row) {
  const std::string note =
      row.note.empty() ? "" : fmt::format(R"(, "note": "{}")", json_escaped(row.note));
  return fmt::format(
      R"({{"case": {}, "quantity": {}, "axis": {}, "statistic": {}, "sections": {}, "value": {}, )"
      R"("unit": {}, "reference": {}, "kind": {}{}}})",
      json_text(row.case_name), json_text(row.quantity), json_text(row.axis),
      json_text(row.statistic), json_text(row.sections),
      std::isfinite(row.value) ? fmt::format("{:.9g}", row.value) : "null", json_text(row.unit),
      json_text(row.reference), json_text(row.kind), note);
}

}  // namespace servomill::sim
