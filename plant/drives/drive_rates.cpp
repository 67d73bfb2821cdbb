#include "plant/drives/drive_rates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/drives/propagator.h"

namespace servomill::plant {
namespace {

constexpr double kEventLength = 10e-9;  // s: events are located in a sub-step no longer than this
constexpr double kCoastRate = 1e-3;     // rate x finest sub-step: two terms are exact to its cube
constexpr double kFrictionRate = 1e-3;  // the same for the rates of friction, which are solved for

// Rate (1/s) with which friction acts on the slide, and its formula.
struct FrictionRate {
  double rate;
  const char* formula;
};
std::vector<FrictionRate> friction_rates(const FeedDriveParams& p) {
  const FrictionParams& f = p.friction;
  const double M = p.slide_mass();
  std::vector<FrictionRate> rates;
  const double b = std::max(f.b_positive, f.b_negative);
  if (b > 0.0) rates.push_back({b / M, "the viscous friction of a direction, viscous / mass,"});
  if (f.kind == FrictionKind::regularised) {
    rates.push_back(
        {std::max({f.Fs_positive, f.Fs_negative, f.Fc_positive, f.Fc_negative}) / (f.v0 * M),
         "the slope of the regularised friction, breakaway / (regularisation_velocity mass),"});
  }
  if (f.kind == FrictionKind::lugre) {
    rates.push_back(
        {std::sqrt(f.sigma0 / M), "the bristle stiffness, sqrt(bristle_stiffness / mass),"});
    rates.push_back({f.sigma1 / M, "the bristle damping, bristle_damping / mass,"});
    rates.push_back({f.sigma0 * kStribeckEnd * f.vs / least_force(f), "6.5 vs sigma0 / Fc"});
  }
  return rates;
}

}  // namespace

double fastest_rate_of(const FeedDriveParams& p) {
  const auto while_sticking = [&](bool sticking) {
    return p.on_bed() ? fastest_rate<7>(drive_equations_on_bed(p, sticking, false))
                      : fastest_rate<5>(drive_equations(p, sticking, false));
  };
  const double rate = while_sticking(false);
  return p.friction.kind == FrictionKind::set_valued ? std::max(rate, while_sticking(true)) : rate;
}

int halvings_of(const FeedDriveParams& p, double base_period) {
  double finest = std::min(kEventLength, kCoastRate / fastest_rate_of(p));
  for (const FrictionRate& f : friction_rates(p)) finest = std::min(finest, kFrictionRate / f.rate);
  return std::max(0, static_cast<int>(std::ceil(std::log2(base_period / finest))));
}

std::vector<std::string> unrepresentable(const FeedDriveParams& p, double base_period) {
  constexpr double kLongestToFinest = 1000.0;  // sub-steps in a base period
  std::vector<std::string> faults;
  const double limit = kLongestToFinest / base_period;
  const auto demand = [&](double rate, const char* what) {
    if (rate <= limit) return;
    faults.push_back(
        fmt::format("{} gives a rate of {:.3g} 1/s; the exact integrator resolves up to {:.3g} 1/s",
                    what, rate, limit));
  };
  demand(fastest_rate_of(p), "the stiffness or damping of the drive");
  for (const FrictionRate& f : friction_rates(p)) demand(f.rate, f.formula);
  return faults;
}

}  // namespace servomill::plant
