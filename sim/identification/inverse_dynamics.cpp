#include "sim/identification/inverse_dynamics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/identification/zero_phase.h"
#include "sim/numerics/dense_solver.h"

namespace servomill::sim::identification {
namespace {

using Column = std::vector<double>;

double sign(double v) { return v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : 0.0; }

// Acceleration, speed, direction, and 1 for the offset.
struct Motion {
  Column v, a;
};
Motion motion_of(const Record& record, const InverseDynamicsSettings& settings) {
  const double corner = std::min(settings.position_corner * record.period, 0.45);
  const Column q = zero_phase(record.feedback, corner, settings.order);
  Motion m;
  m.v = derivative(q, record.period);
  m.a = derivative(m.v, record.period);
  return m;
}

std::vector<Column> columns_of(const Motion& m, bool by_direction) {
  const std::size_t n = m.v.size();
  std::vector<Column> columns = {m.a};
  const auto add = [&](auto value) {
    columns.emplace_back(n);
    for (std::size_t k = 0; k < n; ++k) columns.back()[k] = value(m.v[k]);
  };
  if (!by_direction) {
    columns.push_back(m.v);
    add(sign);
    add([](double) { return 1.0; });
    return columns;
  }
  add([](double v) { return std::max(v, 0.0); });
  add([](double v) { return std::min(v, 0.0); });
  add([](double v) { return v > 0.0 ? 1.0 : 0.0; });
  add([](double v) { return v < 0.0 ? -1.0 : 0.0; });
  return columns;
}

// Every `step`-th sample without the ends: filtered signals carry no more.
Eigen::VectorXd thinned(const Column& signal, std::size_t ends, std::size_t step) {
  std::vector<double> out;
  for (std::size_t k = ends; k + ends < signal.size(); k += step) out.push_back(signal[k]);
  return Eigen::VectorXd::Map(out.data(), static_cast<Eigen::Index>(out.size()));
}

// A force is held from its sample on: around a sample acts the mean of its own and the last one.
Column around_samples(const Column& held) {
  Column out = held;
  for (std::size_t k = 1; k < held.size(); ++k) out[k] = 0.5 * (held[k - 1] + held[k]);
  return out;
}

void refuse_idle(const Record& record, const Motion& m) {
  const auto rms = [](const Column& x) {
    double sum = 0.0;
    for (const double one : x) sum += one * one;
    return std::sqrt(sum / static_cast<double>(x.size()));
  };
  if (rms(m.v) == 0.0 || rms(m.a) == 0.0) {
    throw InputError({record.name}, "contains no motion; the identification requires motion");
  }
}

}  // namespace

InverseDynamics inverse_dynamics(const Record& record, bool by_direction,
                                 const InverseDynamicsSettings& settings) {
  if (record.force.empty()) {
    throw InputError({record.name}, "inverse dynamics needs the force or the motor current");
  }
  const Motion m = motion_of(record, settings);
  refuse_idle(record, m);
  const double corner = std::min(settings.force_corner * record.period, 0.45);
  const auto ends = static_cast<std::size_t>(settings.ends / record.period);
  const auto step = static_cast<std::size_t>(std::max(1.0, std::floor(0.25 / corner)));
  if (2 * ends + 64 * step > record.size()) {
    throw InputError({record.name},
                     fmt::format("is too short for inverse dynamics: {:.3g} s",
                                 record.period * static_cast<double>(record.size())));
  }
  const auto filtered = [&](const Column& x) {
    return thinned(zero_phase(x, corner, settings.order), ends, step);
  };
  const std::vector<Column> columns = columns_of(m, by_direction);
  const Eigen::VectorXd force =
      filtered(settings.held ? around_samples(record.force) : record.force);
  Eigen::MatrixXd X(force.size(), static_cast<Eigen::Index>(columns.size()));
  for (Eigen::Index k = 0; k < X.cols(); ++k)
    X.col(k) = filtered(columns[static_cast<std::size_t>(k)]);
  const Eigen::VectorXd values = numerics::least_squares(X, force);
  const Eigen::VectorXd residual = X * values - force;
  InverseDynamics out;
  out.by_direction = by_direction;
  out.held = settings.held;
  out.names =
      by_direction
          ? std::vector<std::string>{"mass", "viscous friction +", "viscous friction -",
                                     "Coulomb friction + and offset",
                                     "Coulomb friction - less offset"}
          : std::vector<std::string>{"mass", "viscous friction", "Coulomb friction", "offset"};
  out.values.assign(values.data(), values.data() + values.size());
  out.uncertainty =
      uncertainty_of(X, residual, {std::vector<char>(static_cast<std::size_t>(force.size()), 1)});
  out.misfit = residual.norm() / force.norm();
  return out;
}

SymmetryTest test_symmetry(const InverseDynamics& by_direction) {
  const Eigen::MatrixXd& C = by_direction.uncertainty.covariance;
  const double difference = by_direction.values[1] - by_direction.values[2];
  return {difference / std::sqrt(C(1, 1) + C(2, 2) - 2.0 * C(1, 2))};
}

}  // namespace servomill::sim::identification
