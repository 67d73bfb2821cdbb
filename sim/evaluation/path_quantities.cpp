#include "sim/evaluation/path_quantities.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include "plant/vocabulary/tool_axis.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/statistic.h"
#include "sim/evaluation/vector_at.h"
#include "sim/model/scenario.h"
#include "sim/records/row_thinning.h"

namespace servomill::sim {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kUmPerMm = 1000.0;
constexpr double kMsPerS = 1000.0;
constexpr double kSamePlace = 1e-6;  // mm; recorded places are rounded

// Value of a recording at a row; rows are asked for in rising order. Empty: was not recorded.
using AtRow = std::function<double(std::size_t)>;

AtRow column_of(const CaseData& one, std::string_view name, char label) {
  const auto column = one.servo->column(name, label);
  if (!column) return {};
  return [&servo = *one.servo, c = *column](std::size_t row) { return servo.at(row, c); };
}

bool is_thinned(const CaseData& one) { return one.servo->column(kSamples).has_value(); }

// Reads values of another case at a given arc length, which is asked for in rising order.
class AlongPath {
 public:
  AlongPath(const Series& series, AtRow value)
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
  const Series& series_;
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

// meas(case) - meas(base) at equal s, um
AtRow trajectory_difference(const CaseData& one, const CaseData& base, char axis) {
  return length_difference(one, base, "meas_linear", "programmed_linear", axis);
}

// |p_WT(case) - p_WT(base)| at equal s, um
AtRow tool_difference(const CaseData& one, const CaseData& base) {
  std::array<AtRow, 3> axes;
  for (std::size_t i = 0; i < 3; ++i) {
    axes[i] = length_difference(one, base, "tool_position_true", "tool_position_nominal", "XYZ"[i]);
    if (!axes[i]) return {};
  }
  return [axes = std::move(axes)](std::size_t row) {
    double distance = 0.0;
    for (const AtRow& axis : axes) distance = std::hypot(distance, axis(row));
    return distance;
  };
}

AtRow tool_tip_deviation(const CaseData& one) {
  return [&servo = *one.servo, first = *one.servo->column("tool_deviation", 'X')](std::size_t row) {
    return vector_at(servo, row, first).norm();
  };
}

// urad
AtRow tool_axis_deviation(const CaseData& one) {
  return [&servo = *one.servo, nominal = *one.servo->column("tool_axis_nominal", 'I'),
          actual = *one.servo->column("tool_axis_true", 'I')](std::size_t row) {
    return angle_between(vector_at(servo, row, nominal), vector_at(servo, row, actual)) / urad;
  };
}

// Signed values of the quantities with a path signal.
AtRow signed_value(const QuantitySpec& spec, const CaseData& one, const CaseData* base) {
  if (spec.name == "following_error") return column_of(one, "following_error_linear", spec.axis);
  if (spec.name == "tool_deviation") return column_of(one, "tool_deviation", spec.axis);
  assert(base != nullptr);
  AtRow difference = trajectory_difference(one, *base, spec.axis);
  if (spec.name == "trajectory_difference") return difference;
  return minus(std::move(difference), column_of(one, "imposed_linear", spec.axis));
}

AtRow value_of(const QuantitySpec& spec, const CaseData& one, const CaseData* base) {
  if (has_path_signal(spec.name)) return signed_value(spec, one, base);
  if (spec.name == "tool_tip_deviation") return tool_tip_deviation(one);
  if (spec.name == "tool_axis_deviation") return tool_axis_deviation(one);
  if (spec.name == "contour_error") return column_of(one, "contour_error", '\0');
  assert(spec.name == "tool_difference" && base != nullptr);
  return tool_difference(one, *base);
}

double statistic_of(std::string_view name, const AtRow& value, const RowRanges& rows) {
  if (!value) return kNone;
  Statistic statistic(name);
  rows.for_each([&](std::size_t row) { statistic.add(value(row)); });
  return statistic.value();
}

// A statistic of all samples of a thinned recording; none if its rows do not tell of the quantity.
std::optional<double> statistic_of_samples(const QuantitySpec& spec, const CaseData& one,
                                           const RowRanges& rows) {
  const std::string signal = spec.name == "following_error" ? "following_error_linear" : spec.name;
  const auto told = [&](const char* what) { return column_of(one, signal + what, spec.axis); };
  const AtRow least = told("_least"), greatest = told("_greatest");
  const AtRow mean = told("_mean"), rms = told("_rms");
  const AtRow samples = column_of(one, kSamples, '\0');
  if (!least || !greatest || !mean || !rms || !samples) return std::nullopt;
  Statistic statistic(spec.statistic);
  rows.for_each([&](std::size_t row) {
    statistic.add(least(row), greatest(row), mean(row), rms(row), samples(row));
  });
  return statistic.value();
}

// tau with residual = -tau d(imposed)/dt in the least-squares sense, ms
double response_time(const CaseData& one, const AtRow& residual, const AtRow& imposed,
                     const RowRanges& rows) {
  const std::size_t time = *one.servo->column("time");
  double re = 0.0, ee = 0.0;
  rows.for_each([&](std::size_t row) {
    if (row == 0 || row + 1 >= one.servo->rows()) return;
    const double de = (imposed(row + 1) - imposed(row - 1)) /
                      (one.servo->at(row + 1, time) - one.servo->at(row - 1, time));
    re += residual(row) * de;
    ee += de * de;
  });
  return ee > 0.0 ? -re / ee * kMsPerS : kNone;
}

// The two that look at the imposed curve beside its residual.
double of_imposed_curve(const QuantitySpec& spec, const CaseData& one, const CaseData& base,
                        const RowRanges& rows) {
  QuantitySpec residual = spec;
  residual.name = "imposed_curve_residual";
  const AtRow difference = signed_value(residual, one, &base);
  const AtRow imposed = column_of(one, "imposed_linear", spec.axis);
  if (!difference || !imposed) return kNone;
  if (spec.name == "response_time") return response_time(one, difference, imposed, rows);
  assert(spec.name == "brought_out");
  return 100.0 * (1.0 - statistic_of("max", difference, rows) / statistic_of("max", imposed, rows));
}

// The tool stands from one place to another (mm) if both are the same but for rounding.
bool stands(double s, double later) { return later - s < 1e-7; }

}  // namespace

bool has_path_signal(std::string_view quantity) {
  return quantity == "imposed_curve_residual" || quantity == "trajectory_difference" ||
         quantity == "tool_deviation" || quantity == "following_error";
}

struct PathSignal::Parts {
  Parts(const QuantitySpec& spec, const CaseData& one, const CaseData* base)
      : rows(CaseSamples(one).rows(spec.sections)),
        at(rows),
        s(column_of(one, "s", '\0')),
        value(signed_value(spec, one, base)) {
    for (const char axis : std::string_view("ABC")) {
      if (AtRow ref = column_of(one, "ref_rotary", axis)) rotary.push_back(std::move(ref));
    }
  }

  // Turn of the rotary axes from one row to another.
  double turn(std::size_t from, std::size_t to) const {
    double sum = 0.0;
    for (const AtRow& ref : rotary) sum += std::abs(ref(to) - ref(from));
    return sum;
  }

  // The same from a row until the tool moves on.
  double turn_while_standing(RowRanges::Cursor from) const {
    double sum = 0.0;
    while (!rotary.empty()) {
      const std::size_t row = from.row();
      from.step();
      if (from.is_at_end() || !stands(s(row), s(from.row()))) break;
      sum += turn(row, from.row());
    }
    return sum;
  }

  RowRanges rows;
  RowRanges::Cursor at;
  AtRow s, value;
  std::vector<AtRow> rotary;
  std::optional<std::size_t> before;   // row of the sample before
  double turned = 0.0, to_turn = 0.0;  // since the tool stands; in all until it moves on
};

PathSignal::PathSignal(const QuantitySpec& spec, const CaseData& one, const CaseData* base)
    : parts_(std::make_unique<Parts>(spec, one, base)) {
  assert(has_path_signal(spec.name));
}
PathSignal::PathSignal(PathSignal&&) noexcept = default;
PathSignal::~PathSignal() = default;

std::size_t PathSignal::size() const { return parts_->value ? parts_->rows.size() : 0; }

bool PathSignal::next(PathSample& sample) {
  Parts& p = *parts_;
  if (!p.value || p.at.is_at_end()) return false;
  const std::size_t row = p.at.row();
  sample.s = p.s(row);
  if (p.before && stands(p.s(*p.before), sample.s)) {
    p.turned += p.turn(*p.before, row);
  } else {
    p.turned = 0.0;
    p.to_turn = p.turn_while_standing(p.at);
  }
  sample.turned = p.to_turn > 0.0 ? p.turned / p.to_turn : 0.0;
  sample.value = p.value(row);
  p.before = row;
  p.at.step();
  return true;
}

PathValue path_value(const QuantitySpec& spec, CaseSamples& samples, const CaseData* base) {
  const CaseData& one = samples.data();
  const RowRanges& rows = samples.rows(spec.sections);
  if (base == nullptr) {
    if (const auto of_samples = statistic_of_samples(spec, one, rows)) return {*of_samples};
  }
  const std::string note =
      is_thinned(one) ? "at the rows that are recorded (record.period_ms)" : "";
  if (spec.name == "brought_out" || spec.name == "response_time") {
    assert(base != nullptr);
    return {of_imposed_curve(spec, one, *base, rows), note};
  }
  return {statistic_of(spec.statistic, value_of(spec, one, base), rows), note};
}

}  // namespace servomill::sim
