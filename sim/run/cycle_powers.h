/// Powers of one cycle of a program, as a day repeats them.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace servomill::sim::engine {
struct HeatCourse;
}  // namespace servomill::sim::engine

namespace servomill::sim::run {

/// Mean powers of some time of a cycle.
struct PowerStep {
  double length = 0.0;    // s
  Eigen::VectorXd power;  // W, of each body
};

/// Powers of a cycle over steps of about a second; none: of a machine without heat.
std::vector<PowerStep> averaged(const engine::HeatCourse& cycle);

}  // namespace servomill::sim::run
