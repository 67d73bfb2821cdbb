#include "plant/geometry/grid_function.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "plant/vocabulary/units.h"

namespace servomill::plant {
namespace {

using Eigen::Index;

std::size_t degree_of(GridInterpolation interpolation, std::size_t points) {
  constexpr std::size_t kCubic = 3;
  return interpolation == GridInterpolation::linear ? 1 : std::min(kCubic, points - 1);
}

// Knots that leave as many B-splines as points: all inner positions but those next to the ends,
// across which a cubic is one polynomial (not-a-knot).
std::vector<double> knots_of(const std::vector<double>& at, std::size_t degree) {
  std::vector<double> knots(degree + 1, at.front());
  const std::size_t skipped = (degree + 2) / 2;
  for (std::size_t i = skipped; i + skipped < at.size(); ++i) knots.push_back(at[i]);
  knots.insert(knots.end(), degree + 1, at.back());
  return knots;
}

// First knot of the interval that q lies in, between the ends.
std::size_t interval_of(const std::vector<double>& knots, std::size_t degree, double q) {
  const auto begin = knots.begin() + static_cast<std::ptrdiff_t>(degree + 1);
  const auto end = knots.end() - static_cast<std::ptrdiff_t>(degree + 1);
  return static_cast<std::size_t>(std::upper_bound(begin, end, q) - knots.begin()) - 1;
}

// The degree + 1 B-splines that are not zero in an interval, by their recurrence.
void b_splines(const std::vector<double>& t, std::size_t interval, std::size_t degree, double q,
               std::span<double> out) {
  out[0] = 1.0;
  for (std::size_t d = 1; d <= degree; ++d) {
    double carried = 0.0;
    for (std::size_t r = 0; r < d; ++r) {
      const double right = t[interval + 1 + r], left = t[interval + 1 + r - d];
      const double share = out[r] / (right - left);
      out[r] = carried + (right - q) * share;
      carried = (q - left) * share;
    }
    out[d] = carried;
  }
}

std::optional<std::string> axis_fault(const GridPoints& points, std::size_t k, double unit) {
  const char axis = letter(points.axes[k]);
  if (std::count(points.axes.begin(), points.axes.end(), points.axes[k]) > 1) {
    return fmt::format("names axis {} twice", axis);
  }
  const std::vector<double>& at = points.at[k];
  if (at.size() < 2) {
    return fmt::format("has {} positions of {}; must have at least 2", at.size(), axis);
  }
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (!std::isfinite(at[i])) return fmt::format("has a position of {} that is not finite", axis);
    if (i > 0 && !(at[i] > at[i - 1])) {
      return fmt::format("{:g} follows {:g} among the positions of {}; positions must increase",
                         at[i] / unit, at[i - 1] / unit, axis);
    }
  }
  return std::nullopt;
}

constexpr double kClosed = 1e-12;  // m, rad; rounding

// Errors that repeat must end as they begin.
std::optional<std::string> repetition_fault(const GridPoints& points, std::size_t k) {
  std::size_t stride = 1;
  for (std::size_t j = k + 1; j < points.at.size(); ++j) stride *= points.at[j].size();
  const std::size_t last = stride * (points.at[k].size() - 1), block = stride + last;
  for (std::size_t begin = 0; begin < points.error.size(); begin += block) {
    for (std::size_t i = begin; i < begin + stride; ++i) {
      if (std::abs(points.error[i] - points.error[i + last]) <= kClosed) continue;
      return fmt::format(
          "ends at {:g} um or urad where it begins at {:g} um or urad; over {}, which repeats, "
          "both must be equal",
          points.error[i + last] / um, points.error[i] / um, letter(points.axes[k]));
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> grid_fault(const GridPoints& points,
                                      std::span<const double> coordinate_units) {
  const std::size_t arguments = points.axes.size();
  if (arguments == 0 || arguments > GridFunction::kMaxArguments) {
    return fmt::format("names {} axes; must name 1 to {}", arguments, GridFunction::kMaxArguments);
  }
  if (points.at.size() != arguments) {
    return fmt::format("has positions of {} axes and names {} axes; the numbers must be equal",
                       points.at.size(), arguments);
  }
  std::size_t combinations = 1;
  for (std::size_t k = 0; k < arguments; ++k) {
    if (auto fault = axis_fault(points, k, coordinate_units[k])) return fault;
    combinations *= points.at[k].size();
  }
  if (points.error.size() != combinations) {
    return fmt::format("has {} errors for {} combinations of positions; must have one for each",
                       points.error.size(), combinations);
  }
  if (!std::all_of(points.error.begin(), points.error.end(),
                   [](double e) { return std::isfinite(e); })) {
    return "has an error that is not finite";
  }
  for (std::size_t k = 0; k < points.repeats.size(); ++k) {
    if (!points.repeats[k]) continue;
    if (auto fault = repetition_fault(points, k)) return fault;
  }
  return std::nullopt;
}

GridFunction::GridFunction(GridPoints points)
    : points_(std::move(points)), coefficients_(points_.error) {
  for (const std::vector<double>& at : points_.at) {
    Spline& spline = splines_.emplace_back();
    spline.points = at.size();
    spline.degree = degree_of(points_.interpolation, at.size());
    spline.knots = knots_of(at, spline.degree);
    const std::size_t k = splines_.size() - 1;
    spline.repeats = k < points_.repeats.size() && points_.repeats[k];
  }
  std::size_t stride = 1;
  for (auto spline = splines_.rbegin(); spline != splines_.rend(); ++spline) {
    spline->stride = stride;
    stride *= spline->points;
  }
  assert(coefficients_.size() == stride);
  for (std::size_t k = 0; k < splines_.size(); ++k) {
    if (splines_[k].degree > 1) find_coefficients(k);  // of degree 1 they are the values
  }
}

// Along one axis: B-splines at the points times coefficients = values.
void GridFunction::find_coefficients(std::size_t axis) {
  const Spline& spline = splines_[axis];
  const auto n = static_cast<Index>(spline.points);
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    const Active active = active_at(spline, points_.at[axis][static_cast<std::size_t>(i)]);
    for (std::size_t j = 0; j < active.number; ++j) {
      B(i, static_cast<Index>(active.first + j)) = active.value[j];
    }
  }
  const Eigen::PartialPivLU<Eigen::MatrixXd> solver(B);
  const std::size_t stride = spline.stride, block = stride * spline.points;
  using Line = Eigen::Map<Eigen::VectorXd, 0, Eigen::InnerStride<>>;
  for (std::size_t begin = 0; begin < coefficients_.size(); begin += block) {
    for (std::size_t i = 0; i < stride; ++i) {
      Line line(coefficients_.data() + begin + i, n,
                Eigen::InnerStride<>(static_cast<Index>(stride)));
      const Eigen::VectorXd values = line;
      line = solver.solve(values);
    }
  }
}

bool GridFunction::depends_on(Axis axis) const {
  return std::find(axes().begin(), axes().end(), axis) != axes().end();
}

double GridFunction::Spline::reduced(double q) const {
  const double from = knots.front(), to = knots.back();
  if (!repeats || (q >= from && q <= to)) return q;
  return q - (to - from) * std::floor((q - from) / (to - from));
}

GridFunction::Active GridFunction::active_at(const Spline& spline, double q) const {
  const double within = std::clamp(spline.reduced(q), spline.knots.front(), spline.knots.back());
  const std::size_t interval = interval_of(spline.knots, spline.degree, within);
  Active out{interval - spline.degree, spline.degree + 1, {}};
  b_splines(spline.knots, interval, spline.degree, within, out.value);
  return out;
}

// Derivatives of the B-splines: differences of those one degree lower.
GridFunction::Active GridFunction::slopes_at(const Spline& spline, double q) const {
  const std::vector<double>& t = spline.knots;
  q = spline.reduced(q);
  const std::size_t degree = spline.degree;
  if (q < t.front() || q > t.back()) return {0, degree + 1, {}};
  const std::size_t interval = interval_of(t, degree, q);
  Basis lower{};
  b_splines(t, interval, degree - 1, q, lower);
  Active out{interval - degree, degree + 1, {}};
  for (std::size_t r = 0; r < degree; ++r) {
    const double slope = static_cast<double>(degree) * lower[r] /
                         (t[interval + 1 + r] - t[interval + 1 + r - degree]);
    out.value[r] -= slope;
    out.value[r + 1] += slope;
  }
  return out;
}

// Over all products of B-splines that are not zero, as an odometer counts them.
double GridFunction::sum(std::span<const Active> active) const {
  std::array<std::size_t, kMaxArguments> at{};
  const std::size_t last = active.size() - 1;
  double total = 0.0;
  while (true) {
    double product = 1.0;
    std::size_t place = 0;
    for (std::size_t k = 0; k < last; ++k) {
      product *= active[k].value[at[k]];
      place += (active[k].first + at[k]) * splines_[k].stride;
    }
    place += active[last].first;
    double line = 0.0;
    for (std::size_t j = 0; j < active[last].number; ++j) {
      line += active[last].value[j] * coefficients_[place + j];
    }
    total += product * line;
    std::size_t k = last;
    while (k > 0 && ++at[k - 1] == active[k - 1].number) at[--k] = 0;
    if (k == 0) return total;
  }
}

double GridFunction::value(std::span<const double> arguments) const {
  assert(arguments.size() == splines_.size());
  std::array<Active, kMaxArguments> active;
  for (std::size_t k = 0; k < arguments.size(); ++k) {
    active[k] = active_at(splines_[k], arguments[k]);
  }
  return sum({active.data(), arguments.size()});
}

double GridFunction::derivative(std::span<const double> arguments, std::size_t by) const {
  assert(arguments.size() == splines_.size() && by < arguments.size());
  std::array<Active, kMaxArguments> active;
  for (std::size_t k = 0; k < arguments.size(); ++k) {
    active[k] =
        k == by ? slopes_at(splines_[k], arguments[k]) : active_at(splines_[k], arguments[k]);
  }
  return sum({active.data(), arguments.size()});
}

double GridFunction::value(const AxisWords& q) const {
  std::array<double, kMaxArguments> arguments{};
  for (std::size_t k = 0; k < axes().size(); ++k) arguments[k] = q[index_of(axes()[k])];
  return value(std::span(arguments).first(axes().size()));
}

bool GridFunction::is_zero() const {
  return std::all_of(points_.error.begin(), points_.error.end(), [](double e) { return e == 0.0; });
}

GridFunction GridFunction::scaled(double factor) const {
  GridFunction out = *this;
  for (double& e : out.points_.error) e *= factor;
  for (double& c : out.coefficients_) c *= factor;
  return out;
}

}  // namespace servomill::plant
