#include "sim/identification/synthesize.h"

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cassert>
#include <cmath>

#include "plant/vocabulary/input_error.h"

namespace servomill::sim::identification {
namespace {

// A first-order process of that standard deviation.
std::vector<double> coloured_force(std::size_t samples, double period, const NoiseSettings& noise) {
  boost::random::mt19937_64 generator(noise.seed);
  boost::random::normal_distribution<double> normal;
  const double kept = std::exp(-period / noise.force_time);
  const double fresh = std::sqrt(1.0 - kept * kept);
  std::vector<double> out(samples);
  double force = noise.force_rms * normal(generator);
  for (double& sample : out) {
    sample = force;
    force = kept * force + fresh * noise.force_rms * normal(generator);
  }
  return out;
}

}  // namespace

Record synthesize(const Record& motion, const AxisModel& model, const NoiseSettings& noise) {
  assert(!motion.command.empty());
  Record driven = motion;
  driven.feedback.assign(motion.command.size(), 0.0);
  driven.force.clear();
  driven.disturbance = coloured_force(driven.size(), driven.period, noise);
  for (std::size_t k = 0; k < motion.disturbance.size(); ++k) {
    driven.disturbance[k] += motion.disturbance[k];
  }
  AxisModel quantising = model;
  quantising.step = noise.feedback_step;
  std::vector<Simulated> simulated = simulate(driven, {&quantising, 1}, 1);
  if (!simulated.front().resolved || simulated.front().diverges) {
    throw InputError(
        {motion.name},
        simulated.front().diverges
            ? "the motion that is simulated diverges: the loop is unstable"
            : "cannot be simulated: the friction is too stiff for the exact integrator");
  }
  Record out = motion;
  out.feedback = std::move(simulated.front().feedback);
  out.force = std::move(simulated.front().force);
  return out;
}

}  // namespace servomill::sim::identification
