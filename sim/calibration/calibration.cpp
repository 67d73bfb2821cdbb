#include "sim/calibration/calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "sim/calibration/short_waves.h"
#include "sim/calibration/sought_grids.h"
#include "sim/metrology/location_errors.h"

namespace servomill::sim::calibration {
namespace {

using plant::ErrorName;

constexpr std::size_t kMaxTargets = 51;  // knots, where readings stand in as many places
constexpr int kDefaultKnots = 17;        // where they stand in more
constexpr double kSamePlace = 1e-6;      // m, rad
constexpr double kSignificant = 3.0;     // standard uncertainties of a reversal

bool is_sought(const CalibrationSettings& settings, const ErrorName& name) {
  const auto& errors = settings.errors;
  return errors.empty() || std::find(errors.begin(), errors.end(), name) != errors.end();
}

// Places of one joint among the readings, ascending; of the groups that are about its axis, if any.
std::vector<double> places_of(const readings::Readings& readings, const Observations& observations,
                              Axis axis, int joint) {
  std::vector<double> own, all;
  for (const Observation& one : observations.all) {
    for (const Pose& pose : one.poses) {
      all.push_back(pose.Q[joint]);
      if (readings.groups[one.group].axis == axis) own.push_back(pose.Q[joint]);
    }
  }
  const auto distinct = [](std::vector<double> places) {
    std::sort(places.begin(), places.end());
    std::vector<double> out;
    for (const double place : places) {
      if (out.empty() || place > out.back() + kSamePlace) out.push_back(place);
    }
    return out;
  };
  all = distinct(std::move(all));
  own = distinct(std::move(own));
  if (own.size() < 2 || own.size() > kMaxTargets) {
    if (all.size() <= 1) return all;
    if (own.size() < 2 && all.size() <= std::size_t(kDefaultKnots)) return all;
    return {all.front(), all.back()};
  }
  // the knots reach as far as any reading
  if (all.front() < own.front() - kSamePlace) own.insert(own.begin(), all.front());
  if (all.back() > own.back() + kSamePlace) own.push_back(all.back());
  return own;
}

std::vector<double> equally_spaced(double lower, double upper, int count) {
  std::vector<double> out;
  for (int i = 0; i < count; ++i) out.push_back(lower + (upper - lower) * i / (count - 1));
  return out;
}

FunctionForm form_of(const FormSettings& asked, const std::vector<double>& places) {
  FunctionForm form;
  form.lower = places.front();
  form.upper = places.back();
  form.degree = asked.degree.value_or(0);
  form.periods = asked.periods;
  form.reversal_degree = asked.reversal_degree.value_or(-1);
  form.reversal_distance = asked.reversal_distance.value_or(form.reversal_distance);
  if (asked.knots) {
    form.knots = *asked.knots;
  } else if (asked.number_of_knots) {
    if (*asked.number_of_knots > 0) {
      form.knots = equally_spaced(form.lower, form.upper, *asked.number_of_knots);
    }
  } else if (!asked.degree && asked.periods.empty()) {
    form.knots = places.size() > 2 ? places : equally_spaced(form.lower, form.upper, kDefaultKnots);
  }
  if (!form.knots.empty()) {
    form.lower = std::min(form.lower, form.knots.front());
    form.upper = std::max(form.upper, form.knots.back());
  }
  return form;
}

FormSettings settings_of(const CalibrationSettings& settings, const ErrorName& name) {
  for (const auto& [of, form] : settings.forms) {
    if (of == name) return form;
  }
  if (name.is_location) return {};
  return is_linear(name.axis) ? settings.form_linear : settings.form_rotary;
}

// True if readings approach places of a joint in both directions.
bool is_read_both_ways(const Observations& observations, int joint) {
  bool up = false, down = false;
  for (const Observation& one : observations.all) {
    for (const Pose& pose : one.poses) {
      up = up || pose.direction[std::size_t(joint)] > 0;
      down = down || pose.direction[std::size_t(joint)] < 0;
    }
  }
  return up && down;
}

// Axes whose positions are read, but in one direction only.
std::vector<Axis> one_way_axes(const readings::Readings& readings, const Observations& observations,
                               const JointLayout& layout) {
  std::vector<Axis> out;
  for (const Axis axis : kAllAxes) {
    const bool is_read = std::any_of(
        readings.groups.begin(), readings.groups.end(), [&](const readings::Group& group) {
          return group.kind == readings::Kind::positioning && group.axis == axis;
        });
    if (is_read && !is_read_both_ways(observations, *layout.joint_of(axis))) out.push_back(axis);
  }
  return out;
}

// The mean of every function belongs to set-up or location; the slope of a straightness, too.
bool is_without_slope(const ErrorName& name) {
  return is_linear(name.axis) && is_linear(name.direction) && name.direction != name.axis;
}

bool is_left_out(const std::vector<Axis>& axes, Axis axis) {
  return std::find(axes.begin(), axes.end(), axis) != axes.end();
}

/// @param without_reversal  axes whose reversal is not looked for unless a form asks for it
std::vector<SoughtFunction> sought_functions(const readings::Readings& readings,
                                             const Observations& observations,
                                             const plant::MachineChain& chain,
                                             const CalibrationSettings& settings,
                                             const std::vector<Axis>& without_reversal) {
  std::vector<SoughtFunction> out;
  for (const Axis axis : kAllAxes) {
    const auto joint = chain.layout.joint_of(axis);
    if (!joint) continue;
    const std::vector<double> places = places_of(readings, observations, axis, *joint);
    if (places.size() < 2) continue;  // the axis has not moved
    const bool both_ways = is_read_both_ways(observations, *joint);
    for (const Axis direction : kAllAxes) {
      const ErrorName name{direction, axis, false};
      if (!is_sought(settings, name) || plant::why_meaningless(name, chain.layout)) continue;
      FormSettings asked = settings_of(settings, name);
      // lost motion is one of the axis along itself; of its other errors where a form asks for it
      const bool tries = both_ways && direction == axis && !asked.reversal_degree;
      if (tries && !is_left_out(without_reversal, axis)) asked.reversal_degree = 0;
      SoughtFunction function{
          .name = name, .basis = FunctionBasis(form_of(asked, places), is_without_slope(name))};
      function.size = asked.size.value_or(function.size);
      function.has_own_knots =
          asked.knots || asked.number_of_knots || asked.degree || !asked.periods.empty();
      out.push_back(std::move(function));
    }
  }
  return out;
}

// Component errors that are looked for, of axes that stand still in all readings.
std::vector<ErrorName> unmoved_errors(const readings::Readings& readings,
                                      const Observations& observations, const JointLayout& layout,
                                      const CalibrationSettings& settings) {
  std::vector<ErrorName> out;
  for (const Axis axis : kAllAxes) {
    const auto joint = layout.joint_of(axis);
    if (!joint || places_of(readings, observations, axis, *joint).size() > 1) continue;
    for (const Axis direction : kAllAxes) {
      const ErrorName name{direction, axis, false};
      if (is_sought(settings, name) && !plant::why_meaningless(name, layout)) out.push_back(name);
    }
  }
  return out;
}

// Axes whose reversal no form asks for, and which is none: a program that is corrected for it would
// have a step wherever the axis turns.
std::vector<Axis> axes_without_reversal(const Adjustment& adjustment,
                                        const CalibrationSettings& settings) {
  std::vector<Axis> out;
  for (const SoughtFunction& function : adjustment.unknowns.functions) {
    const auto reversal = reversal_of(adjustment, function);
    if (!reversal || settings_of(settings, function.name).reversal_degree) continue;
    const auto& [value, uncertainty] = *reversal;
    if (!(std::abs(value) > kSignificant * uncertainty)) out.push_back(function.name.axis);
  }
  return out;
}

// Takes turning points of axes without lost motion as any other reading.
void forget_turning_points(Observations& observations, const std::vector<Axis>& axes) {
  for (Observation& one : observations.all) {
    std::erase_if(one.set_up, [&](const SetUpPart& part) {
      const auto& turning = observations.set_up[part.unknown].turning;
      return turning && is_left_out(axes, *turning);
    });
  }
}

std::vector<Outlier> outliers_of(const Adjustment& adjustment) {
  std::vector<Outlier> out;
  const double limit = outlier_limit(adjustment.standardized.size());
  for (std::size_t i = 0; i < adjustment.standardized.size(); ++i) {
    const double z = adjustment.standardized[i];
    if (std::abs(z) > limit) out.push_back({i, z});
  }
  std::sort(out.begin(), out.end(), [](const Outlier& a, const Outlier& b) {
    return std::abs(a.standardized) > std::abs(b.standardized);
  });
  return out;
}

}  // namespace

std::vector<ErrorName> sought_locations(const plant::MachineChain& chain,
                                        const std::array<Axis, 2>& frame) {
  const auto turn = [](Axis about, Axis of) {
    return ErrorName{static_cast<Axis>(index_of(about) + index_of(Axis::A)), of, true};
  };
  const Axis first = frame[0], second = frame[1];
  const auto third = static_cast<Axis>(3 - index_of(first) - index_of(second));
  std::vector<ErrorName> out;
  for (const ErrorName& name : {turn(third, second), turn(second, third), turn(first, third)}) {
    if (!plant::why_meaningless(name, chain.layout)) out.push_back(name);
  }
  for (const ErrorName& name : metrology::location_errors(chain)) {
    if (!is_linear(name.axis)) out.push_back(name);
  }
  return out;
}

std::optional<std::pair<double, double>> reversal_of(const Adjustment& adjustment,
                                                     const SoughtFunction& function) {
  const FunctionForm& form = function.basis.form();
  if (form.reversal_degree < 0) return std::nullopt;
  const int n = function.basis.size();
  const double middle = 0.5 * (form.lower + form.upper);
  const Eigen::RowVectorXd step =
      function.basis.row(middle, 1.0) - function.basis.row(middle, -1.0);
  const Eigen::MatrixXd C = adjustment.covariance.block(function.first, function.first, n, n);
  return std::pair{step.dot(adjustment.values.segment(function.first, n)),
                   std::sqrt(std::max(0.0, (step * C * step.transpose())(0)))};
}

double outlier_limit(std::size_t n) {
  return std::sqrt(2.0 * std::log(static_cast<double>(std::max<std::size_t>(n, 1)) / 1e-3));
}

Calibration calibrate(readings::Readings readings, const plant::MachineChain& chain,
                      const CalibrationSettings& asked) {
  Calibration out{.readings = std::move(readings),
                  .settings = asked,
                  .observations = {},
                  .adjustment = {},
                  .outliers = {},
                  .suspects = {},
                  .smoothness = {},
                  .one_way = {},
                  .unmoved = {}};
  out.observations = observations_of(out.readings, chain);
  out.one_way = one_way_axes(out.readings, out.observations, chain.layout);
  const CalibrationSettings& settings = out.settings;
  out.unmoved = unmoved_errors(out.readings, out.observations, chain.layout, settings);
  std::vector<SoughtLocation> locations;
  for (const ErrorName& name : sought_locations(chain, settings.frame)) {
    if (!is_sought(settings, name)) continue;
    SoughtLocation location{.name = name};
    location.size = settings_of(settings, name).size.value_or(location.size);
    locations.push_back(location);
  }
  const std::vector<SoughtGrid> grids =
      sought_grids(out.readings, out.observations, chain, settings);
  out.smoothness = choose_smoothness(out.settings, [&](const CalibrationSettings& tried) {
    return adjust(out.readings, out.observations, chain, locations,
                  sought_functions(out.readings, out.observations, chain, tried, {}), grids,
                  {.robust = tried.robust, .predicts = true});
  });
  std::vector<SoughtFunction> functions =
      sought_functions(out.readings, out.observations, chain, settings, {});
  const AdjustmentOptions options{.robust = settings.robust};
  const auto adjusted = [&](const Observations& observations) {
    return adjust(out.readings, observations, chain, locations, functions, grids, options);
  };
  out.adjustment = adjusted(out.observations);
  const std::vector<Axis> none = axes_without_reversal(out.adjustment, settings);
  if (!none.empty()) {
    forget_turning_points(out.observations, none);
    functions = sought_functions(out.readings, out.observations, chain, settings, none);
    out.adjustment = adjusted(out.observations);
  }
  if (!out.adjustment.converged) {
    throw InputError({out.readings.path},
                     "the adjustment does not converge: readings have the wrong positions or "
                     "errors of millimetres; remove groups to find them");
  }
  out.adjustment.short_waves = short_waves(out.adjustment);
  out.outliers = outliers_of(out.adjustment);
  out.suspects = contradictions(
      out.readings, out.observations, out.adjustment,
      [&](const Observations& observations) { return adjusted(observations).squares; });
  return out;
}

namespace {

// Enough places to show the shortest period.
int places_for(const FunctionForm& form, int points) {
  // Twelve points show a sine within 3.5 % of its amplitude (1 - cos(pi/12)).
  constexpr double kEachPeriod = 12.0;
  constexpr double kMax = 2000.0;
  double most = points;
  for (const double period : form.periods) {
    most = std::max(most, kEachPeriod * (form.upper - form.lower) / period);
  }
  return static_cast<int>(std::min(most, kMax));
}

}  // namespace

std::vector<KnownFunction> functions_along_travel(const Adjustment& adjustment, int points) {
  std::vector<KnownFunction> out;
  for (std::size_t f = 0; f < adjustment.unknowns.functions.size(); ++f) {
    const SoughtFunction& function = adjustment.unknowns.functions[f];
    const double wave = adjustment.short_waves[f];
    const int n = function.basis.size();
    const Eigen::MatrixXd C = adjustment.covariance.block(function.first, function.first, n, n);
    if (C.isZero(0.0)) continue;
    const FunctionForm& form = function.basis.form();
    KnownFunction known{
        .name = function.name, .s = {}, .value = {}, .sigma = {}, .expected = {}, .reversal = {}};
    for (const double s : equally_spaced(form.lower, form.upper, places_for(form, points))) {
      const Eigen::RowVectorXd row = function.basis.row(s, 0.0);
      known.s.push_back(s);
      known.value.push_back(row * adjustment.values.segment(function.first, n));
      const double between =
          wave == 0.0 ? 0.0 : wave * wave * interpolation_variance(function.basis, s);
      known.sigma.push_back(std::sqrt(std::max(0.0, (row * C * row.transpose())(0)) + between));
      known.expected.push_back(function.size * row.norm());
    }
    known.reversal = reversal_of(adjustment, function);
    out.push_back(std::move(known));
  }
  return out;
}

}  // namespace servomill::sim::calibration
