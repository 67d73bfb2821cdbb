/// Machines of the shop with errors drawn at random, by the conventions of the adjustment.
#pragma once

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <utility>

#include "sim/calibration/calibration.h"
#include "tests/sim/calibration/shop.h"

namespace servomill::sim::calibration {

class Normal {
 public:
  explicit Normal(std::uint64_t seed) : generator_(seed) {}
  double operator()(double sigma) { return sigma * distribution_(generator_); }

 private:
  boost::random::mt19937_64 generator_;
  boost::random::normal_distribution<double> distribution_;
};

struct Truth {
  Eigen::VectorXd values;  // of errors; the set-up is not compared
  plant::ErrorModel errors;
};

inline Truth random_truth(const Unknowns& unknowns, Normal& normal) {
  Truth out;
  out.values = Eigen::VectorXd::Zero(unknowns.size());
  for (std::size_t k = 0; k < unknowns.locations.size(); ++k) {
    const double value = normal(is_linear(unknowns.locations[k].name.direction) ? 8e-6 : 20e-6);
    out.values[unknowns.first_location() + int(k)] = value;
    out.errors.location(unknowns.locations[k].name) = value;
  }
  for (const SoughtFunction& f : unknowns.functions) {
    for (int i = 0; i < f.basis.size(); ++i) out.values[f.first + i] = normal(5e-6);
    out.errors.component(f.name) = f.basis.function(out.values.segment(f.first, f.basis.size()));
  }
  return out;
}

inline Calibration calibrated(readings::Readings readings,
                              const CalibrationSettings& settings = {}) {
  return calibrate(std::move(readings), gantry(), settings);
}

}  // namespace servomill::sim::calibration
