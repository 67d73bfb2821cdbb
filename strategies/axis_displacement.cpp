#include "strategies/axis_displacement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace servomill::strategies {
namespace {

constexpr std::array<std::string_view, 2> kWords = {"1", "converged"};
constexpr std::array<std::string_view, 2> kAxesWords = {"linear", "all"};
constexpr double kConverged = 1e-13;  // m
constexpr int kMaxIterations = 50;    // contraction by |E'|, of the order of 1e-2
constexpr LaneFlags kOne = {true};

// Offsets of one run and of eight.
void find_offset(const IdentifiedMachine& b, const Joints& Q, Eigen::Vector3d& d) {
  d = b.model.joint_offset(Q, b.p_ST);
}
void find_offset(const IdentifiedMachine& b, const JointLanes& Q, LinearJointLanes& d) {
  b.model.joint_offsets(Q, b.p_ST, d);
}

// -offset(Q)
template <class Poses, class Shifts>
void find_removal(const IdentifiedMachine& b, const Poses& Q, Shifts& d) {
  find_offset(b, Q, d);
  for (auto& joint : d) {
    for (std::size_t k = 0; k < kLanesOf<Shifts>; ++k) {
      lane(joint, k) = -lane(joint, k);
    }
  }
}

// d with d = -offset(Q + d). On the setpoint it is the non-ideal inverse: F_ni(Q + d) = F_i(Q). On
// a reading it is the error at the position that was programmed, Q + d. What has converged stays.
template <class Poses, class Shifts>
void find_converged_removal(const IdentifiedMachine& b, const Poses& Q, LaneFlags open, Shifts& d) {
  Poses shifted;
  Shifts next;
  std::copy(std::begin(Q), std::end(Q), std::begin(shifted));
  find_removal(b, Q, d);
  for (int n = 0; n < kMaxIterations; ++n) {
    for (int j = 0; j < kLinearJoints; ++j) {
      for (std::size_t k = 0; k < kLanesOf<Shifts>; ++k)
        lane(shifted[j], k) = lane(Q[j], k) + lane(d[j], k);
    }
    find_removal(b, shifted, next);
    bool any_open = false;
    for (std::size_t k = 0; k < kLanesOf<Shifts>; ++k) {
      if (!open[k]) continue;
      open[k] = false;
      for (int j = 0; j < kLinearJoints; ++j) {
        open[k] |= !(std::abs(lane(next[j], k) - lane(d[j], k)) < kConverged);
        lane(d[j], k) = lane(next[j], k);
      }
      any_open |= open[k];
    }
    if (!any_open) break;
  }
}

template <class Poses, class Shifts>
void find_feedback_displacement(const IdentifiedMachine& b, Action action, Iterations iterations,
                                const Poses& Q, const LaneFlags& lanes, Shifts& d) {
  if (action == Action::compensate) return find_offset(b, Q, d);
  if (iterations == Iterations::one) return find_removal(b, Q, d);
  find_converged_removal(b, Q, lanes, d);
}

}  // namespace

const ParameterSpec kIterationsSpec = {.name = "iterations",
                                       .help =
                                           "1: single evaluation, as in the paper; converged: "
                                           "exact even where the displacement changes the error",
                                       .default_text = "1",
                                       .is_number = false,
                                       .words = kWords,
                                       .shortcoming = Shortcoming::single_evaluation,
                                       .ideal = "converged"};

const ParameterSpec kAxesSpec = {
    .name = "axes",
    .help = "linear: X, Y, Z correct the position; all: rotary axes also correct the tool axis",
    .default_text = "linear",
    .is_number = false,
    .words = kAxesWords};

const ParameterSpec kSingularSpec = {
    .name = "singular_deg",
    .help =
        "axes = all: closer to a singular direction than this, the correction of the axis that "
        "would rotate far is reduced",
    .unit = "deg",
    .default_text = "1",
    .min = 1e-3,
    .max = 45.0};

DisplacedAxes displaced_axes_of(const Parameters& parameters) {
  return parameters.word("axes") == "all" ? DisplacedAxes::all : DisplacedAxes::linear;
}

Iterations iterations_of(const Parameters& parameters) {
  return parameters.word("iterations") == "converged" ? Iterations::converged : Iterations::one;
}

Eigen::Vector3d setpoint_displacement(const IdentifiedMachine& b, Action action,
                                      Iterations iterations, const Joints& Q) {
  if (action == Action::impose) return b.model.joint_offset(Q, b.p_ST);
  if (iterations == Iterations::one) return -b.model.joint_offset(Q, b.p_ST);
  Eigen::Vector3d d;
  find_converged_removal(b, Q, kOne, d);
  return d;
}

void feedback_displacement(const IdentifiedMachine& b, Action action, Iterations iterations,
                           const Joints& Q, Eigen::Vector3d& d) {
  find_feedback_displacement(b, action, iterations, Q, kOne, d);
}

void feedback_displacement(const IdentifiedMachine& b, Action action, Iterations iterations,
                           const JointLanes& Q, const LaneFlags& lanes, LinearJointLanes& d) {
  find_feedback_displacement(b, action, iterations, Q, lanes, d);
}

}  // namespace servomill::strategies
