#include "sim/identification/profile.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "sim/identification/identifiable_part.h"

namespace servomill::sim::identification {
namespace {

constexpr double kEnough = 2e-3;   // of the half-width: far below the digits that are printed
constexpr double kFarthest = 1e3;  // half-widths

// Rise of the sum of squares on the way to one end.
class Side {
 public:
  Side(const Prediction& prediction, const Fit& fit, const Mask& mask, std::size_t parameter,
       double direction, double rise)
      : prediction_(prediction),
        fit_(fit),
        mask_(mask),
        parameter_(parameter),
        direction_(direction),
        rise_(rise),
        least_(fit.residual.squaredNorm()),
        values_(fit.values) {
    const auto [lower, upper] = prediction.bounds(parameter);
    limit_ = direction > 0.0 ? upper - fit.values[parameter] : fit.values[parameter] - lower;
  }

  // @param half  first guess of the distance
  // @param along  change of all values per change of the parameter, of the linear model
  ProfileSide find(double half, const Eigen::VectorXd& along, Profile& out) {
    double inside = 0.0, outside = limit_;  // distances
    bool has_outside = false;
    double reached = 0.0, at = std::min(half, limit_);
    // Bisection in doubt: thirty halvings end at 1e-9 of the first distance.
    constexpr int kMax = 30;
    for (int n = 0; n < kMax; ++n) {
      const auto excess = excess_at(at, along, out);
      if (excess && std::abs(*excess - 1.0) < kEnough) return {ProfileEnd::crossed, value(at)};
      if (!excess) {  // beyond what can be simulated
        outside = at;
        blocked_ = true;
        at = 0.5 * (inside + at);
      } else if (*excess < 1.0) {
        inside = at;
        reached = *excess;
        if (at >= limit_) return {ProfileEnd::bound, value(at)};
        if (at > kFarthest * half) return {ProfileEnd::open, value(at)};
        at = next(inside, reached, has_outside, outside);
      } else {
        outside = at;
        has_outside = true;
        blocked_ = false;
        at = std::clamp(at / *excess, inside + 0.05 * (outside - inside),
                        outside - 0.05 * (outside - inside));
      }
      if (outside - inside < kEnough * half) {
        return {blocked_ ? ProfileEnd::bound : ProfileEnd::crossed, value(inside)};
      }
    }
    return {has_outside ? ProfileEnd::crossed : ProfileEnd::open, value(inside)};
  }

 private:
  double value(double distance) const { return fit_.values[parameter_] + direction_ * distance; }

  // The square root of the rise is nearly in proportion to the distance.
  double next(double inside, double reached, bool has_outside, double outside) const {
    // At most four times as far: flat profiles would jump to where nothing can be simulated.
    const double by_line = inside * std::min(1.0 / std::max(reached, 1e-3), 4.0);
    if (has_outside || blocked_) {
      return std::clamp(by_line, inside + 0.05 * (outside - inside),
                        outside - 0.05 * (outside - inside));
    }
    return std::min(by_line, limit_);
  }

  // Square root of the rise over that of the interval's end.
  std::optional<double> excess_at(double distance, const Eigen::VectorXd& along, Profile& out) {
    Values at = values_;
    // From the last point along the linear model: refits begin next to their minimum and take few
    // simulations.
    const double change = value(distance) - values_[parameter_];
    for (std::size_t p = 0; p < at.size(); ++p) {
      const auto [lower, upper] = prediction_.bounds(p);
      at[p] = std::clamp(at[p] + change * along[static_cast<Eigen::Index>(p)], lower, upper);
    }
    at[parameter_] = value(distance);
    auto sum = fit_others(prediction_, fit_, mask_, parameter_, at);
    if (!sum) return std::nullopt;
    values_ = at;
    constexpr double kRounding = 1e-6;  // of the sum of squares: where a minimiser stops
    if (*sum < least_ * (1.0 - kRounding)) out.finds_better = true;
    const double excess = std::sqrt(std::max(*sum - least_, 0.0) / rise_);
    out.points.push_back({value(distance), excess * excess});
    return excess;
  }

  const Prediction& prediction_;
  const Fit& fit_;
  const Mask& mask_;
  std::size_t parameter_;
  double direction_, rise_, least_, limit_ = 0.0;
  bool blocked_ = false;
  Values values_;  // of the last point: the next begins there
};

}  // namespace

Profile profile(const Prediction& prediction, const Fit& fit, const Uncertainty& uncertainty,
                const Mask& mask, std::size_t parameter) {
  assert(uncertainty.identifiable[parameter]);
  const IdentifiablePart part = identifiable_part(fit.jacobian);
  const auto row = std::find(part.parameters.begin(), part.parameters.end(), parameter);
  const Eigen::MatrixXd inverse = part.back * part.back.transpose();
  const Eigen::Index own = row - part.parameters.begin();
  Profile out;
  out.parameter = parameter;
  // the others follow along the column of (J'J)^-1 in a linear model
  Eigen::VectorXd along = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(fit.values.size()));
  for (std::size_t k = 0; k < part.parameters.size(); ++k) {
    along[static_cast<Eigen::Index>(part.parameters[k])] =
        inverse(static_cast<Eigen::Index>(k), own) / inverse(own, own);
  }
  const double half = uncertainty.half_width(parameter);
  // Rise at which a linear model has the interval of the coloured covariance: white residuals would
  // set it to t^2 times the variance.
  const double rise = half * half / inverse(own, own);
  for (const double direction : {-1.0, 1.0}) {
    Side side(prediction, fit, mask, parameter, direction, rise);
    (direction < 0.0 ? out.lower : out.upper) = side.find(half, along, out);
  }
  out.points.push_back({fit.values[parameter], 0.0});
  std::sort(out.points.begin(), out.points.end(),
            [](const ProfilePoint& a, const ProfilePoint& b) { return a.value < b.value; });
  return out;
}

}  // namespace servomill::sim::identification
