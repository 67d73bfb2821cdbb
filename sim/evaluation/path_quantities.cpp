#include "sim/evaluation/path_quantities.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "plant/vocabulary/tool_axis.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/case_evaluation.h"
#include "sim/evaluation/statistic.h"
#include "sim/evaluation/vector_at.h"
#include "sim/model/scenario.h"
#include "sim/records/row_thinning.h"

namespace servomill::sim::evaluation {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kUmPerMm = 1000.0;
constexpr double kMsPerS = 1000.0;
constexpr double kSamePlace = 1e-6;  // mm; recorded places are rounded

bool is_thinned(const CaseData& one) { return one.servo->column(records::kSamples).has_value(); }

// Reads values of another case at a given arc length, which is asked for in rising order.
class AlongPath {
 public:
  AlongPath(const records::Series& series, AtRow value)
      : series_(series), value_(std::move(value)), s_(*series.column("s")) {}

  double at(double s) {
    const std::size_t rows = series_.rows();
    while (row_ + 1 < rows && series_.at(row_ + 1, s_) <= s) ++row_;
    if (row_ + 1 == rows) return value_(row_);
    const double s0 = series_.at(row_, s_), s1 = series_.at(row_ + 1, s_);
    const double weight = std::clamp((s - s0) / (s1 - s0), 0.0, 1.0);
    return (1.0 - weight) * value_(row_) + weight * value_(row_ + 1);
  }

 private:
  const records::Series& series_;
  AtRow value_;
  std::size_t s_;
  std::size_t row_ = 0;
};

AtRow minus(AtRow one, AtRow other) {
  if (!one || !other) return {};
  return [a = std::move(one), b = std::move(other)](std::size_t row) { return a(row) - b(row); };
}

// Value of a case minus that of the base case at equal s.
AtRow difference_along_path(const CaseData& one, const CaseData& base, AtRow mine, AtRow theirs) {
  if (!mine || !theirs || base.servo->rows() == 0) return {};
  return [&servo = *one.servo, s = *one.servo->column("s"), mine = std::move(mine),
          there = AlongPath(*base.servo, std::move(theirs))](std::size_t row) mutable {
    return mine(row) - there.at(servo.at(row, s));
  };
}

// Between the rows of a thinned recording a path is not straight, but its deviation from the
// programmed one is even: where that is the same for both cases (but for a shift), deviations are
// compared.
struct Programmed {
  AtRow mine, theirs;
  double shift = 0.0;  // programmed place of the case minus that of the base case
};

std::optional<Programmed> programmed_of_both(const CaseData& one, const CaseData& base,
                                             std::string_view name, char label) {
  if (!is_thinned(one) || !is_thinned(base)) return std::nullopt;
  Programmed out{column_of(one, name, label), column_of(base, name, label)};
  if (!out.mine || !out.theirs || one.servo->rows() == 0 || base.servo->rows() == 0) {
    return std::nullopt;
  }
  out.shift = out.mine(0) - out.theirs(0);
  const double at_end = out.mine(one.servo->rows() - 1) - out.theirs(base.servo->rows() - 1);
  if (std::abs(at_end - out.shift) > kSamePlace) return std::nullopt;
  return out;
}

// Column of a case minus that of the base case at equal s, um.
AtRow length_difference(const CaseData& one, const CaseData& base, std::string_view name,
                        std::string_view programmed_name, char axis) {
  AtRow mine = column_of(one, name, axis), theirs = column_of(base, name, axis);
  double shift = 0.0;
  if (auto programmed = programmed_of_both(one, base, programmed_name, axis)) {
    mine = minus(std::move(mine), std::move(programmed->mine));
    theirs = minus(std::move(theirs), std::move(programmed->theirs));
    shift = programmed->shift;
  }
  AtRow difference = difference_along_path(one, base, std::move(mine), std::move(theirs));
  if (!difference) return {};
  return [difference = std::move(difference), shift](std::size_t row) {
    const double length = difference(row);
    return (shift == 0.0 ? length : length + shift) * kUmPerMm;
  };
}

AtRow following_error(const model::QuantitySpec& spec, const CaseData& one, const CaseData*) {
  return column_of(one, "following_error_linear", spec.axis);
}

AtRow tool_deviation(const model::QuantitySpec& spec, const CaseData& one, const CaseData*) {
  return column_of(one, "tool_deviation", spec.axis);
}

AtRow contour_error(const model::QuantitySpec&, const CaseData& one, const CaseData*) {
  return column_of(one, "contour_error", '\0');
}

// meas(case) - meas(base) at equal s, um
AtRow trajectory_difference(const model::QuantitySpec& spec, const CaseData& one,
                            const CaseData* base) {
  assert(base != nullptr);
  return length_difference(one, *base, "meas_linear", "programmed_linear", spec.axis);
}

AtRow imposed_error_residual(const model::QuantitySpec& spec, const CaseData& one,
                             const CaseData* base) {
  return minus(trajectory_difference(spec, one, base), column_of(one, "imposed_linear", spec.axis));
}

// |p_WT(case) - p_WT(base)| at equal s, um
AtRow tool_difference(const model::QuantitySpec&, const CaseData& one, const CaseData* base) {
  assert(base != nullptr);
  std::array<AtRow, 3> axes;
  for (std::size_t i = 0; i < 3; ++i) {
    axes[i] =
        length_difference(one, *base, "tool_position_true", "tool_position_nominal", "XYZ"[i]);
    if (!axes[i]) return {};
  }
  return [axes = std::move(axes)](std::size_t row) {
    double distance = 0.0;
    for (const AtRow& axis : axes) distance = std::hypot(distance, axis(row));
    return distance;
  };
}

AtRow tcp_deviation(const model::QuantitySpec&, const CaseData& one, const CaseData*) {
  return [&servo = *one.servo, first = *one.servo->column("tool_deviation", 'X')](std::size_t row) {
    return vector_at(servo, row, first).norm();
  };
}

// urad
AtRow tool_axis_deviation(const model::QuantitySpec&, const CaseData& one, const CaseData*) {
  return [&servo = *one.servo, nominal = *one.servo->column("tool_axis_nominal", 'I'),
          actual = *one.servo->column("tool_axis_true", 'I')](std::size_t row) {
    return angle_between(vector_at(servo, row, nominal), vector_at(servo, row, actual)) / urad;
  };
}

double statistic_of(std::string_view name, const AtRow& value, const RowRanges& rows) {
  if (!value) return kNone;
  Statistic statistic(name);
  rows.for_each([&](std::size_t row) { statistic.add(value(row)); });
  return statistic.value();
}

// A statistic of all samples of a thinned recording; none if its rows do not tell of the signal.
std::optional<double> statistic_of_samples(const model::QuantitySpec& spec, std::string_view signal,
                                           const CaseData& one, const RowRanges& rows) {
  const auto between_rows = [&](const char* what) {
    return column_of(one, std::string(signal) + what, spec.axis);
  };
  const AtRow least = between_rows("_min"), greatest = between_rows("_max");
  const AtRow mean = between_rows("_mean"), rms = between_rows("_rms");
  const AtRow samples = column_of(one, records::kSamples, '\0');
  if (!least || !greatest || !mean || !rms || !samples) return std::nullopt;
  Statistic statistic(spec.statistic);
  rows.for_each([&](std::size_t row) {
    statistic.add(least(row), greatest(row), mean(row), rms(row), samples(row));
  });
  return statistic.value();
}

// tau with residual = -tau d(imposed)/dt in the least-squares sense, ms
double lag_time(const CaseData& one, const AtRow& residual, const AtRow& imposed,
                const RowRanges& rows) {
  const std::size_t time = *one.servo->column("time");
  const auto window = one.servo->column("window");
  double re = 0.0, ee = 0.0;
  rows.for_each([&](std::size_t row) {
    if (row == 0 || row + 1 >= one.servo->rows()) return;
    if (!follows(*one.servo, window, row) || !follows(*one.servo, window, row + 1)) return;
    const double de = (imposed(row + 1) - imposed(row - 1)) /
                      (one.servo->at(row + 1, time) - one.servo->at(row - 1, time));
    re += residual(row) * de;
    ee += de * de;
  });
  return ee > 0.0 ? -re / ee * kMsPerS : kNone;
}

// Rows at which a case is compared with its base, and what is to be said of them.
struct ComparedRows {
  RowRanges rows;
  std::string note;
};

ComparedRows compared_rows(const model::QuantitySpec& spec, CaseEvaluation& one,
                           const CaseData* base) {
  const RowRanges& all = one.samples.rows(spec.sections);
  ComparedRows out{base != nullptr ? rows_with_counterpart(one.data, *base, all) : all,
                   is_thinned(one.data) ? "at the recorded rows (record.period_ms)" : ""};
  if (out.rows.size() < all.size()) {
    out.note += fmt::format("{}{} of {} rows are not compared: {} has no rows there",
                            out.note.empty() ? "" : "; ", all.size() - out.rows.size(), all.size(),
                            base->name);
  }
  return out;
}

using Signal = AtRow (*)(const model::QuantitySpec&, const CaseData&, const CaseData*);

// Statistic of a value along the path.
// @tparam kRecorded  name of the recorded signal; nullptr: that of the quantity
template <Signal kValue, const char* kRecorded = nullptr>
QuantityValue along_path(const model::QuantitySpec& spec, CaseEvaluation& compared,
                         const CaseData* base) {
  const CaseData& one = compared.data;
  if (base == nullptr) {
    const RowRanges& rows = compared.samples.rows(spec.sections);
    std::string_view signal = spec.name;
    if constexpr (kRecorded != nullptr) signal = kRecorded;
    if (const auto of_samples = statistic_of_samples(spec, signal, one, rows)) return {*of_samples};
  }
  const ComparedRows at = compared_rows(spec, compared, base);
  return {statistic_of(spec.statistic, kValue(spec, one, base), at.rows), at.note};
}

double realised_share(const CaseData&, const AtRow& residual, const AtRow& imposed,
                      const RowRanges& rows) {
  return 100.0 * (1.0 - statistic_of("max", residual, rows) / statistic_of("max", imposed, rows));
}

// Looks at the imposed curve beside its residual.
template <double (*kValue)(const CaseData&, const AtRow&, const AtRow&, const RowRanges&)>
QuantityValue of_imposed_curve(const model::QuantitySpec& spec, CaseEvaluation& compared,
                               const CaseData* base) {
  const CaseData& one = compared.data;
  const AtRow residual = imposed_error_residual(spec, one, base);
  const AtRow imposed = column_of(one, "imposed_linear", spec.axis);
  const ComparedRows at = compared_rows(spec, compared, base);
  QuantityValue out{.note = at.note};
  if (residual && imposed) out.value = kValue(one, residual, imposed, at.rows);
  return out;
}

QuantityValue cycle_time(const model::QuantitySpec&, CaseEvaluation& one, const CaseData*) {
  return {one.data.duration};
}

QuantityValue blocks(const model::QuantitySpec&, CaseEvaluation& one, const CaseData*) {
  return {one.data.blocks};
}

constexpr char kFollowingError[] = "following_error_linear";
constexpr std::string_view kResidual = "imposed_error_residual";

// signals that the quantities read; programmed_linear only where rows are thinned
constexpr std::string_view kTrajectory[] = {"meas_linear", "programmed_linear"};
constexpr std::string_view kImposed[] = {"meas_linear", "programmed_linear", "imposed_linear"};
constexpr std::string_view kDeviation[] = {"tool_deviation"};
constexpr std::string_view kAxes[] = {"tool_axis_nominal", "tool_axis_true"};
constexpr std::string_view kContour[] = {"contour_error"};
constexpr std::string_view kTips[] = {"tool_position_true", "tool_position_nominal"};
constexpr std::string_view kFollowing[] = {kFollowingError};
constexpr std::span<const std::string_view> kNoSignals = {};

constexpr QuantityEntry kQuantities[] = {
    {.name = kResidual,
     .unit = "um",
     .help =
         "trajectory (scale) minus that of the baseline minus the imposed displacement, at equal s",
     .axes = "XYZ",
     .has_statistic = true,
     .needs_baseline = true,
     .needs_imposed = true,
     .evaluate = along_path<imposed_error_residual>,
     .reads = kImposed,
     .signal = imposed_error_residual},
    {.name = "realised_ratio",
     .unit = "%",
     .help = "1 - largest imposed_error_residual / largest imposed displacement",
     .axes = "XYZ",
     .needs_baseline = true,
     .needs_imposed = true,
     .evaluate = of_imposed_curve<realised_share>,
     .reads = kImposed,
     .derived_from = kResidual},
    {.name = "lag_time",
     .unit = "ms",
     .help =
         "delay that best explains the imposed_error_residual, by least squares over its samples",
     .axes = "XYZ",
     .needs_baseline = true,
     .needs_imposed = true,
     .evaluate = of_imposed_curve<lag_time>,
     .reads = kImposed,
     .derived_from = kResidual},
    {.name = "trajectory_difference",
     .unit = "um",
     .help = "trajectory (scale) minus that of the baseline, at equal s",
     .axes = "XYZ",
     .has_statistic = true,
     .needs_baseline = true,
     .evaluate = along_path<trajectory_difference>,
     .reads = kTrajectory,
     .signal = trajectory_difference},
    {.name = "following_error",
     .unit = "um",
     .help = "setpoint minus position feedback",
     .axes = "XYZ",
     .has_statistic = true,
     .evaluate = along_path<following_error, kFollowingError>,
     .reads = kFollowing,
     .signal = following_error,
     .is_of_servo = true},
    {.name = "tool_deviation",
     .unit = "um",
     .help = "true minus nominal tool centre point at equal s, in the workpiece",
     .axes = "XYZ",
     .has_statistic = true,
     .evaluate = along_path<tool_deviation>,
     .reads = kDeviation,
     .signal = tool_deviation},
    {.name = "tcp_deviation",
     .unit = "um",
     .help = "distance of the true from the nominal tool centre point at equal s",
     .has_statistic = true,
     .evaluate = along_path<tcp_deviation>,
     .reads = kDeviation},
    {.name = "tool_axis_deviation",
     .unit = "urad",
     .help = "angle between the true and the nominal tool axis at equal s",
     .has_statistic = true,
     .evaluate = along_path<tool_axis_deviation>,
     .reads = kAxes},
    {.name = "contour_error",
     .unit = "um",
     .help = "distance of the true tool centre point to the nominal path",
     .has_statistic = true,
     .evaluate = along_path<contour_error>,
     .reads = kContour},
    {.name = "tool_difference",
     .unit = "um",
     .help = "distance of the true tool centre point from that of the baseline, at equal s",
     .has_statistic = true,
     .needs_baseline = true,
     .evaluate = along_path<tool_difference>,
     .reads = kTips},
    {.name = "cycle_time",
     .unit = "s",
     .help = "duration of the program that the NC runs",
     .evaluate = cycle_time,
     .is_of_program = true,
     .reads = kNoSignals},
    {.name = "blocks",
     .unit = "1",
     .help = "motion blocks of the program that the NC runs",
     .evaluate = blocks,
     .is_of_program = true,
     .reads = kNoSignals},
};

}  // namespace

std::span<const QuantityEntry> path_quantities() { return kQuantities; }

}  // namespace servomill::sim::evaluation
