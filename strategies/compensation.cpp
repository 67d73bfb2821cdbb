#include "strategies/compensation.h"

#include <algorithm>
#include <array>

#include "plant/vocabulary/lanes.h"

namespace servomill::strategies {
namespace {

constexpr std::array<std::string_view, 2> kWords = {"1", "converged"};
constexpr double kConverged = 1e-13;  // m
constexpr int kMaxIterations = 50;    // contraction by |E'|, of the order of 1e-2
constexpr std::size_t kTogether = kLaneWidth;

// -offset(Q) of each.
void removals(const Belief& b, std::span<const Joints> Q, std::span<Eigen::Vector3d> d) {
  b.model.joint_offsets(Q, b.p_ST, d);
  for (Eigen::Vector3d& one : d) one = -one;
}

// d with d = -offset(Q + d). On the set point it is the non-ideal inverse: F_ni(Q + d) = F_i(Q). On
// a reading it is the error at the position that was programmed, Q + d. What has converged stays.
void converged_removals(const Belief& b, std::span<const Joints> Q, std::span<Eigen::Vector3d> d) {
  std::array<Joints, kTogether> shifted;
  std::array<Eigen::Vector3d, kTogether> next;
  std::array<bool, kTogether> open{};
  const std::size_t count = Q.size();
  std::fill_n(open.begin(), count, true);
  removals(b, Q, d);
  for (int n = 0; n < kMaxIterations; ++n) {
    for (std::size_t k = 0; k < count; ++k) {
      shifted[k] = Q[k];
      shifted[k].head<3>() += d[k];
    }
    removals(b, {shifted.data(), count}, {next.data(), count});
    for (std::size_t k = 0; k < count; ++k) {
      if (!open[k]) continue;
      open[k] = !((next[k] - d[k]).cwiseAbs().maxCoeff() < kConverged);
      d[k] = next[k];
    }
    if (std::none_of(open.begin(), open.end(), [](bool one) { return one; })) break;
  }
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
  Eigen::Vector3d d;
  converged_removals(b, {&Q, 1}, {&d, 1});
  return d;
}

void feedback_displacements(const Belief& b, Sign sign, Iterations iterations,
                            std::span<const Joints> Q, std::span<Eigen::Vector3d> out) {
  if (sign == Sign::correct) return b.model.joint_offsets(Q, b.p_ST, out);
  if (iterations == Iterations::one) return removals(b, Q, out);
  for (std::size_t first = 0; first < Q.size(); first += kTogether) {
    const std::size_t count = std::min(kTogether, Q.size() - first);
    converged_removals(b, Q.subspan(first, count), out.subspan(first, count));
  }
}

}  // namespace servomill::strategies
