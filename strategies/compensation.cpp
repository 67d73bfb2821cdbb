#include "strategies/compensation.h"

#include <array>

namespace servomill::strategies {
namespace {

constexpr std::array<std::string_view, 2> kWords = {"1", "converged"};
constexpr double kConverged = 1e-13;  // m
constexpr int kMaxIterations = 50;    // contraction by |E'|, of the order of 1e-2

// d with d = -offset(Q + d). On the set point it is the non-ideal inverse: F_ni(Q + d) = F_i(Q). On
// a reading it is the error at the position that was programmed, Q + d.
Eigen::Vector3d converged_removal(const Belief& b, const Joints& Q) {
  Eigen::Vector3d d = -b.model.joint_offset(Q, b.p_ST);
  for (int n = 0; n < kMaxIterations; ++n) {
    Joints shifted = Q;
    shifted.head<3>() += d;
    const Eigen::Vector3d next = -b.model.joint_offset(shifted, b.p_ST);
    const double change = (next - d).cwiseAbs().maxCoeff();
    d = next;
    if (change < kConverged) break;
  }
  return d;
}

}  // namespace

const ParameterSpec kIterationsSpec = {
    .name = "iterations",
    .help = "1: one step, as the paper; converged: exact where a displacement changes the error",
    .default_text = "1",
    .is_number = false,
    .words = kWords};

Iterations iterations_of(const Parameters& parameters) {
  return parameters.word("iterations") == "converged" ? Iterations::converged : Iterations::one;
}

Eigen::Vector3d set_point_displacement(const Belief& b, Sign sign, Iterations iterations,
                                       const Joints& Q) {
  if (sign == Sign::generate) return b.model.joint_offset(Q, b.p_ST);
  if (iterations == Iterations::one) return -b.model.joint_offset(Q, b.p_ST);
  return converged_removal(b, Q);
}

Eigen::Vector3d feedback_displacement(const Belief& b, Sign sign, Iterations iterations,
                                      const Joints& Q) {
  if (sign == Sign::correct) return b.model.joint_offset(Q, b.p_ST);
  if (iterations == Iterations::one) return -b.model.joint_offset(Q, b.p_ST);
  return converged_removal(b, Q);
}

}  // namespace servomill::strategies
