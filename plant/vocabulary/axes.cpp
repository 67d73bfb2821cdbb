#include "plant/vocabulary/axes.h"

namespace servomill {

std::optional<Axis> axis_of(char letter_in) {
  for (const Axis a : kAllAxes) {
    if (letter_in == letter(a) || letter_in == letter(a) + ('a' - 'A')) return a;
  }
  return std::nullopt;
}

std::optional<int> JointLayout::joint_of(Axis a) const {
  for (int j = 0; j < kJoints; ++j) {
    if (axis[static_cast<std::size_t>(j)] == a) return j;
  }
  return std::nullopt;
}

char JointLayout::letter_of(int joint) const {
  const auto& a = axis[static_cast<std::size_t>(joint)];
  return a ? letter(*a) : '-';
}

Joints JointLayout::joints(const AxisWords& words) const {
  Joints Q = Joints::Zero();
  for (int j = 0; j < kJoints; ++j) {
    if (const auto& a = axis[static_cast<std::size_t>(j)]) Q[j] = words[index_of(*a)];
  }
  return Q;
}

AxisWords JointLayout::words(const Joints& Q) const {
  AxisWords out = AxisWords::Zero();
  for (int j = 0; j < kJoints; ++j) {
    if (const auto& a = axis[static_cast<std::size_t>(j)]) out[index_of(*a)] = Q[j];
  }
  return out;
}

}  // namespace servomill
