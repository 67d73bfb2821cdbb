/// Seeded random numbers, directions and rigid motions for tests of fits.
#pragma once

#include <Eigen/Dense>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>

namespace servomill::sim::metrology {

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  double within(double low, double high) { return low + (high - low) * unit_(generator_); }
  Eigen::Vector3d in_cube(double half) {
    const double x = within(-half, half), y = within(-half, half);
    return {x, y, within(-half, half)};
  }
  Eigen::Vector3d direction() {
    const double x = normal_(generator_), y = normal_(generator_);
    return Eigen::Vector3d(x, y, normal_(generator_)).normalized();
  }
  /// Any rotation, and a shift within a cube.
  Eigen::Isometry3d pose(double half) {
    return Eigen::Translation3d(in_cube(half)) * Eigen::AngleAxisd(within(0.0, 3.1), direction());
  }

 private:
  boost::random::mt19937 generator_;
  boost::random::uniform_real_distribution<double> unit_{0.0, 1.0};
  boost::random::normal_distribution<double> normal_{0.0, 1.0};
};

}  // namespace servomill::sim::metrology
