#include "plant/drives/prepared_drives.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unsupported/Eigen/MatrixFunctions>
#include <utility>

#include "plant/drives/drive_kernel.h"

namespace servomill::plant {
namespace {

enum Row : int { kCurrent = 0, kVelocity = 3, kPosition = 4, kCommand = 5 };

using Matrix7l = Eigen::Matrix<long double, 7, 7>;

// [A B; 0 0] h -> exp: the first rows hold exp(A h) and the integral that multiplies the input.
// Computed in variables of equal size (all m/s or m/s^2) and in long double: in SI the entries span
// eight decades, and a slide at rest under load would creep by what the exponential loses.
Eigen::Matrix<double, 5, 7> hold_matrix(const FeedDriveParams& p, double h) {
  const double stiffness = p.is_rigid() ? 0.0 : p.k;
  const double omega = std::sqrt(stiffness / p.M) + 1.0;
  Eigen::Matrix<double, 7, 1> scale;
  scale << 1.0, 1.0 / p.r, 1.0 / omega, 1.0, 1.0 / omega, 1.0, p.M;
  Matrix7l generator = Matrix7l::Zero();
  generator.topRows<5>() = drive_equations(p).cast<long double>() * static_cast<long double>(h);
  const Eigen::Matrix<long double, 7, 1> S = scale.cast<long double>();
  const Matrix7l scaled = S.cwiseInverse().asDiagonal() * generator * S.asDiagonal();
  Matrix7l E = S.asDiagonal() * Matrix7l(scaled.exp()) * S.cwiseInverse().asDiagonal();
  if (p.current_is_command()) {
    E.row(kCurrent).setZero();
    E(kCurrent, kCommand) = 1.0L;
  }
  return E.topRows<5>().cast<double>();
}

}  // namespace

PreparedDrive::PreparedDrive(const FeedDriveParams& drive, double period, std::vector<Tick> lengths,
                             std::vector<Stretch> with_stops)
    : params(drive),
      base_period(period),
      steps(std::move(lengths)),
      stretches(std::move(with_stops)) {
  std::map<Tick, Eigen::Matrix<double, 5, 7>> known;
  const auto held = [&](Tick half_ticks) -> const Eigen::Matrix<double, 5, 7>& {
    const auto [at, is_new] = known.try_emplace(half_ticks);
    if (is_new) {
      at->second = hold_matrix(params, 0.5 * static_cast<double>(half_ticks) * base_period);
    }
    return at->second;
  };
  Tick longest = 0;
  for (const Tick step : steps) {
    longest = std::max(longest, step);
    hold.push_back({held(2 * step), held(step).row(kVelocity)});
  }
  for (const Stretch& stretch : stretches) {
    for (const Tick stop : stretch.stops) {
      stops.push_back({held(2 * stop).row(kPosition), {}});
    }
  }
  if ((params.is_linear() && !params.on_bed()) || steps.empty()) return;
  exact.emplace(params, base_period, longest, Resolution{.tolerance = params.solver_tolerance});
  if (!smooth()) return;
  const PropagatorSeries<5> series(drive_equations(params));
  for (const Tick step : steps) {
    whole.push_back(series.over(static_cast<long double>(step) * base_period));
  }
  auto to = stops.begin();
  for (const Stretch& stretch : stretches) {
    for (const Tick stop : stretch.stops) {
      to++->parabola = series.position_at(static_cast<long double>(stop) * base_period,
                                          static_cast<long double>(stretch.step) * base_period);
    }
  }
  for (int n = 0; (1 << n) <= longest << Ladder::kDepth; ++n) {
    rungs.push_back(
        series.over(std::ldexp(static_cast<long double>(base_period), n - Ladder::kDepth)));
  }
}

bool PreparedDrive::smooth() const {
  const FrictionKind kind = params.friction.kind;
  return (kind == FrictionKind::regularised || kind == FrictionKind::lugre) && params.gap == 0.0 &&
         params.cogging.T == 0.0 && !params.on_bed();
}

std::shared_ptr<const PreparedDrive> PreparedDrives::get(const FeedDriveParams& params,
                                                         double base_period,
                                                         const std::vector<Tick>& steps,
                                                         const std::vector<Stretch>& stretches) {
  const auto find = [&] {
    const auto found = std::find_if(drives_.begin(), drives_.end(), [&](const auto& drive) {
      return drive->params == params && drive->base_period == base_period &&
             drive->steps == steps && drive->stretches == stretches;
    });
    return found == drives_.end() ? nullptr : *found;
  };
  {
    const std::lock_guard lock(mutex_);
    if (auto drive = find()) return drive;
  }
  auto drive = std::make_shared<const PreparedDrive>(params, base_period, steps, stretches);
  const std::lock_guard lock(mutex_);
  if (drives_.size() < most_) {
    drives_.push_back(drive);
  } else if (most_ > 0) {
    drives_[oldest_] = drive;
    oldest_ = (oldest_ + 1) % most_;
  }
  return drive;
}

}  // namespace servomill::plant
