/// Every structure of up to three linear and two rotary axes, and random centres for its axes.
#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include "plant/kinematics/chain.h"

namespace servomill::plant {

/// All subsets of axes, in all orders, with the bed at all places.
inline std::vector<Structure> all_structures() {
  std::vector<Structure> all;
  for (unsigned subset = 0; subset < 64; ++subset) {
    std::vector<Axis> axes;
    for (const Axis a : kAllAxes) {
      if (subset >> index_of(a) & 1U) axes.push_back(a);
    }
    if (std::count_if(axes.begin(), axes.end(), [](Axis a) { return !is_linear(a); }) > 2) continue;
    do {
      for (std::size_t bed = 0; bed <= axes.size(); ++bed) {
        Structure structure;
        for (std::size_t i = 0; i < axes.size(); ++i) {
          structure.axes.push_back({axes[i], i < bed ? Side::workpiece : Side::tool});
        }
        if (bed % 2 == 0) structure.spindle = Axis::C;
        all.push_back(structure);
      }
    } while (std::next_permutation(axes.begin(), axes.end()));
  }
  return all;
}

/// Reproducible numbers in [-1, 1): the generator is fixed by the standard, the mapping by us.
class Uniform {
 public:
  explicit Uniform(unsigned seed) : engine_(seed) {}
  double operator()() { return static_cast<double>(engine_()) / 2147483648.0 - 1.0; }
  Eigen::Vector3d vector() {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return {x, y, z};
  }

 private:
  std::mt19937 engine_;
};

/// The chain with centres within 0.3 m of the origin and random senses.
inline MachineChain random_chain(const Structure& structure, Uniform& random) {
  MachineChain chain = make_chain(structure);
  for (ChainAxis& a : chain.axes) {
    a.centre = 0.3 * random.vector();
    if (!is_linear(a.axis) && random() < 0.0) a.sense = Sense::table;
  }
  return chain;
}

/// The same with rotary axes that point anywhere.
inline MachineChain random_inclined_chain(const Structure& structure, Uniform& random) {
  MachineChain chain = random_chain(structure, random);
  for (ChainAxis& a : chain.axes) {
    if (!is_linear(a.axis)) incline(a, random.vector());
  }
  return chain;
}

/// Joints within 0.4 m and 2 rad, 0 for axes that the machine lacks.
inline Joints random_joints(const MachineChain& chain, Uniform& random) {
  Joints Q = Joints::Zero();
  for (const ChainAxis& a : chain.axes) Q[a.joint] = (is_linear(a.axis) ? 0.4 : 2.0) * random();
  return Q;
}

}  // namespace servomill::plant
