#include "plant/heat/thermal_network.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <utility>

namespace servomill::plant {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Conductances between the bodies, those to the surroundings on the diagonal (W/K): G T is the heat
// that leaves the bodies where the surroundings are at 0.
MatrixXd conductance_matrix(const ThermalParams& params) {
  const auto n = static_cast<Index>(params.bodies.size());
  MatrixXd G = MatrixXd::Zero(n, n);
  for (const ThermalLink& link : params.links) {
    G(link.from, link.from) += link.conductance;
    G(link.to, link.to) += link.conductance;
    G(link.from, link.to) -= link.conductance;
    G(link.to, link.from) -= link.conductance;
  }
  for (const ThermalLink& link : params.surface_links) G(link.from, link.from) += link.conductance;
  return G;
}

// Bodies from which heat gets to surroundings.
std::vector<bool> connected(const ThermalParams& params) {
  std::vector<bool> out(params.bodies.size(), false);
  for (const ThermalLink& link : params.surface_links) {
    if (link.conductance > 0.0) out[static_cast<std::size_t>(link.from)] = true;
  }
  // One more body is reached in each pass at least: as many passes as bodies suffice for any order
  // of the links.
  for (std::size_t pass = 0; pass < params.bodies.size(); ++pass) {
    for (const ThermalLink& link : params.links) {
      const auto a = static_cast<std::size_t>(link.from), b = static_cast<std::size_t>(link.to);
      if (link.conductance > 0.0 && (out[a] || out[b])) out[a] = out[b] = true;
    }
  }
  return out;
}

// (1 - e^-x) / x and (x - 1 + e^-x) / x^2: the response to a constant and to a rising input.
// Differences of nearly equal numbers where a body is slow against the step: expm1, and below
// kSeries the series, whose first neglected term, x^6 / 8!, is below the rounding of 1/2.
double constant_response(double x) { return x < 1e-8 ? 1.0 - 0.5 * x : -std::expm1(-x) / x; }
double rising_response(double x) {
  constexpr double kSeries = 1e-2;
  if (x > kSeries) return (x + std::expm1(-x)) / (x * x);
  return 0.5 - x / 6.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0 * (1.0 - x / 7.0))));
}

}  // namespace

double Surroundings::temperature(double t) const {
  return mean + amplitude * std::cos(2.0 * std::numbers::pi * (t - warmest_at) / period);
}

std::vector<std::string> implausible(const ThermalParams& params) {
  std::vector<std::string> out;
  for (const ThermalBody& body : params.bodies) {
    if (!(body.capacity > 0.0))
      out.push_back(fmt::format("{} must have a capacity > 0", body.name));
  }
  const auto name = [&](int body) { return params.bodies[static_cast<std::size_t>(body)].name; };
  const auto check = [&](const ThermalLink& link, const std::string& to) {
    if (link.conductance >= 0.0) return;
    out.push_back(fmt::format("{} to {} must have a conductance >= 0", name(link.from), to));
  };
  for (const ThermalLink& link : params.links) check(link, name(link.to));
  for (const ThermalLink& link : params.surface_links) {
    check(link, params.surroundings[static_cast<std::size_t>(link.to)].name);
  }
  const std::vector<bool> is_connected = connected(params);
  for (std::size_t i = 0; i < params.bodies.size(); ++i) {
    if (is_connected[i]) continue;
    out.push_back(
        fmt::format("{} must be connected with the surroundings, directly or through "
                    "other bodies",
                    params.bodies[i].name));
  }
  return out;
}

ThermalNetwork::ThermalNetwork(ThermalParams params) : params_(std::move(params)) {
  const auto n = static_cast<Index>(params_.bodies.size());
  C_.resize(n);
  for (Index i = 0; i < n; ++i) C_[i] = params_.bodies[static_cast<std::size_t>(i)].capacity;
  surface_ = MatrixXd::Zero(n, static_cast<Index>(params_.surroundings.size()));
  for (const ThermalLink& link : params_.surface_links) {
    surface_(link.from, link.to) += link.conductance;
  }
  // C dT/dt = -G T + P becomes symmetric in C^1/2 T, so that its eigenvalues are real and its
  // eigenvectors orthogonal: no complex modes, and no inverse of an ill-conditioned matrix of
  // eigenvectors.
  const VectorXd root = C_.cwiseSqrt();
  const MatrixXd G = conductance_matrix(params_);
  const MatrixXd scaled = root.cwiseInverse().asDiagonal() * G * root.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> modes(scaled);
  decay_ = modes.eigenvalues();
  to_modes_ = modes.eigenvectors().transpose() * root.asDiagonal();
  from_modes_ = root.cwiseInverse().asDiagonal() * modes.eigenvectors();
  heat_to_modes_ = modes.eigenvectors().transpose() * root.cwiseInverse().asDiagonal();
  modes_.resize(n);
  heat_.resize(n);
  change_.resize(n);
  outside_.resize(surface_.cols());
  outside_after_.resize(surface_.cols());
  T_ = settled(VectorXd::Zero(n), 0.0);
}

void ThermalNetwork::set_surroundings(double t, VectorXd& out) const {
  for (Index k = 0; k < out.size(); ++k) {
    out[k] = params_.surroundings[static_cast<std::size_t>(k)].temperature(t);
  }
}

VectorXd ThermalNetwork::settled(const VectorXd& power, double t) const {
  VectorXd mean(surface_.cols());
  for (Index k = 0; k < mean.size(); ++k) {
    mean[k] = params_.surroundings[static_cast<std::size_t>(k)].mean;
  }
  VectorXd modes = (heat_to_modes_ * (power + surface_ * mean)).cwiseQuotient(decay_);
  for (Index k = 0; k < surface_.cols(); ++k) {
    const Surroundings& around = params_.surroundings[static_cast<std::size_t>(k)];
    const double w = 2.0 * std::numbers::pi / around.period;
    const VectorXd excitation = heat_to_modes_ * surface_.col(k) * around.amplitude;
    for (Index i = 0; i < modes.size(); ++i) {
      // Each mode is a first-order lag: gain 1 / |decay + i w|, phase atan(w / decay).
      const double lag = std::atan2(w, decay_[i]);
      modes[i] +=
          excitation[i] / std::hypot(decay_[i], w) * std::cos(w * (t - around.warmest_at) - lag);
    }
  }
  return from_modes_ * modes;
}

void ThermalNetwork::advance(double t, double h, const VectorXd& power) {
  // Linear within the step, which leaves the second derivative of a daily cosine: (w h)^2 / 8 of
  // the amplitude.
  set_surroundings(t, outside_);
  set_surroundings(t + h, outside_after_);
  heat_.noalias() = surface_ * outside_;
  heat_ += power;
  outside_after_ -= outside_;
  change_.noalias() = surface_ * outside_after_;
  modes_.noalias() = to_modes_ * T_;
  for (Index i = 0; i < modes_.size(); ++i) {
    const double x = decay_[i] * h;
    modes_[i] =
        std::exp(-x) * modes_[i] + h * (constant_response(x) * heat_to_modes_.row(i).dot(heat_) +
                                        rising_response(x) * heat_to_modes_.row(i).dot(change_));
  }
  T_.noalias() = from_modes_ * modes_;
}

double ThermalNetwork::inflow(double t) const {
  VectorXd outside(surface_.cols());
  set_surroundings(t, outside);
  return (surface_ * outside).sum() - (surface_.rowwise().sum()).dot(T_);
}

}  // namespace servomill::plant
