#include "plant/geometry/volumetric_evaluation.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cassert>

#include "plant/geometry/axis_steps.h"

namespace servomill::plant {
namespace {

using Eigen::Vector3d;

static_assert(kMachineJoints == kJoints && kErrorComponents == kErrorDirections);
static_assert(kLinearAxes == kLinearJoints);
static_assert(sizeof(Joints) == kMachineJoints * sizeof(double));  // poses lie without gaps

VolumetricKernel kernel_of(SimdLevel level, bool in_frames) {
  const auto make = [in_frames](SimdLevel of) {
    return at_simd_level(of, [&]<SimdLevel l>() { return make_volumetric_kernel<l>(in_frames); });
  };
  VolumetricKernel kernel = make(level);
  if (level == SimdLevel::avx512) {
    // The axes of one pose fill half a register of AVX-512, whose use slows the processor down.
    const VolumetricKernel narrow = make(SimdLevel::avx2);
    kernel.tool = narrow.tool;
    kernel.error = narrow.error;
    kernel.offset = narrow.offset;
  }
  return kernel;
}

LinearAxisKernel linear_axis_kernel_of(const LinearAxisProgram& program, SimdLevel level) {
  return at_simd_level(level, [&]<SimdLevel l>() { return make_linear_axis_kernel<l>(program); });
}

}  // namespace

// --- preparation --------------------------------------------------------------------------------

VolumetricEvaluation::VolumetricEvaluation(const MachineChain& chain, const ErrorModel& errors,
                                           SimdLevel level)
    : kernel_(kernel_of(level, std::any_of(chain.axes.begin(), chain.axes.end(),
                                           [](const ChainAxis& a) { return a.is_inclined; }))),
      functions_(chain.layout),
      linear_axis_functions_(chain.layout) {
  for (auto a = chain.axes.rbegin(); a != chain.axes.rend(); ++a) {
    add(*a, errors);
    if (!is_linear(a->axis)) rotary_.push_back(*a);
  }
  find_ends();
  program_.steps = steps_.data();
  program_.number_of_steps = steps_.size();
  program_.functions = functions_.finish();
  find_linear_axis_path(chain, errors);
  if (has_linear_axes_only_) linear_axis_kernel_ = linear_axis_kernel_of(linear_axis_, level);
}

void VolumetricEvaluation::add(const ChainAxis& axis, const ErrorModel& errors) {
  const AxisFunctions functions = functions_of(axis, errors);
  const auto joint = static_cast<std::size_t>(axis.joint);
  for (std::size_t i = 0; i < kErrorComponents; ++i) {
    functions_.add(joint, i, joint, functions[i]);
    functions_.add_reversals(joint, i, joint, functions[i]);
  }
  const std::vector<VolumetricStep> steps = steps_of(axis, errors, functions);
  steps_.insert(steps_.end(), steps.begin(), steps.end());
  if (is_linear(axis.axis)) return;
  program_.has_turns = true;
  program_.senses[joint - kLinearJoints] = axis.sense == Sense::table ? -1.0 : 1.0;
}

void VolumetricEvaluation::find_ends() {
  const auto behind_last = [&](auto condition) {
    const auto last = std::find_if(steps_.rbegin(), steps_.rend(), condition);
    return static_cast<std::size_t>(steps_.rend() - last);
  };
  program_.linear_end = behind_last(is_shift);
  program_.offset_steps = behind_last([](const VolumetricStep& step) {
    return step.move != VolumetricMove::turn && !is_frame(step);
  });
  const auto end = steps_.begin() + static_cast<std::ptrdiff_t>(program_.offset_steps);
  tip_turns_ = static_cast<std::size_t>(std::count_if(steps_.begin(), end, is_turn));
}

// Turns, which place the tip, and then three linear axes; what follows are turns that do not count.
void VolumetricEvaluation::find_linear_axis_path(const MachineChain& chain,
                                                 const ErrorModel& errors) {
  const std::size_t end = program_.offset_steps;
  if (end < kLinearAxes) return;
  const std::size_t first = end - kLinearAxes;
  for (std::size_t n = 0; n < end; ++n) {
    const VolumetricStep& step = steps_[n];
    const bool is_ideal_turn = step.move == VolumetricMove::turn || is_frame(step);
    if (n < first ? !is_ideal_turn : !is_shift(step)) return;
  }
  has_linear_axes_only_ = true;
  for (std::size_t n = 0; n < kLinearAxes; ++n) {
    linear_axis_.joint[n] = steps_[first + n].joint;
  }
  for (std::size_t n = 0; n < kLinearAxes; ++n) {
    add_linear_axis(n, steps_[first + n], chain, errors);
  }
  linear_axis_.functions = linear_axis_functions_.finish();
  linear_axis_.functions.axes = kLinearAxes;
  lay_out_linear_axis_powers();
  is_plain_ = tip_turns_ == 0 && !linear_axis_functions_.has_tables();
}

void VolumetricEvaluation::add_linear_axis(std::size_t n, const VolumetricStep& step,
                                           const MachineChain& chain, const ErrorModel& errors) {
  const auto& order = linear_axis_.joint;
  const bool is_mirrored = (order[0] + 1) % 3 != order[1];
  const auto functions = functions_of(chain.at(kAllAxes[step.direction]), errors);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = order[i];
    linear_axis_.levers[n].slope[i] = step.lever_slope[k];
    linear_axis_.levers[n].centre[i] = step.centre[k];
    linear_axis_functions_.add(n, i, step.joint, functions[k]);
    linear_axis_functions_.add(n, 3 + i, step.joint,
                               scaled(functions[3 + k], is_mirrored ? -0.5 : 0.5));
  }
  linear_axis_.has_levers = linear_axis_.has_levers || step.has_lever;
}

void VolumetricEvaluation::lay_out_linear_axis_powers() {
  for (std::size_t power = 0; power <= linear_axis_.functions.degree; ++power) {
    LinearAxisPower& p = linear_axis_powers_.emplace_back(LinearAxisPower{});
    const VolumetricPower& from = linear_axis_.functions.polynomial[power];
    for (std::size_t axis = 0; axis < kLinearAxes; ++axis) {
      for (std::size_t i = 0; i < 3; ++i) {
        p.shift[axis][i] = from.e[i][axis];
        p.half_turn[axis][i] = from.e[3 + i][axis];
        if (power > 0) continue;
        linear_axis_.has_constants =
            linear_axis_.has_constants || p.shift[axis][i] != 0.0 || p.half_turn[axis][i] != 0.0;
      }
    }
  }
  linear_axis_.powers = linear_axis_powers_.data();
}

// --- evaluation ---------------------------------------------------------------------------------

void VolumetricEvaluation::one_with_tables(VolumetricKernel::One call, const Joints& Q,
                                           const Vector3d& p_ST, double* out) const {
  OnePoseData data{};
  functions_.tables_at([&](std::size_t joint) { return Q[static_cast<int>(joint)]; },
                       [&](std::size_t axis, std::size_t component, double value) {
                         data.tables.e[component][axis] += value;
                       });
  call(program_, &data, Q.data(), p_ST.data(), out);
}

void VolumetricEvaluation::one_with_reversals(VolumetricKernel::One call, const Joints& Q,
                                              const Vector3d& p_ST,
                                              std::span<const double> directions,
                                              double* out) const {
  assert(directions.size() == plays().size());
  OnePoseData data{};
  const auto at = [&](std::size_t joint) { return Q[static_cast<int>(joint)]; };
  const auto add = [&](std::size_t axis, std::size_t component, double value) {
    data.tables.e[component][axis] += value;
  };
  functions_.tables_at(at, add);
  functions_.reversals_at(at, directions, add);
  call(program_, &data, Q.data(), p_ST.data(), out);
}

void VolumetricEvaluation::eight_with_tables(VolumetricKernel::Many call, const Joints* Q,
                                             const Vector3d& p_ST, double* out) const {
  EightPosesData data{};
  for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
    functions_.tables_at([&](std::size_t joint) { return Q[lane][static_cast<int>(joint)]; },
                         [&](std::size_t axis, std::size_t component, double value) {
                           data.tables[axis].e[component][lane] += value;
                         });
  }
  call(program_, &data, Q->data(), 1, p_ST.data(), out);
}

namespace {

// Calls f(poses, number of blocks, out) for all whole blocks of eight, and for what is left with
// its last pose repeated.
template <class F>
void in_blocks(std::span<const Joints> Q, std::size_t numbers, double* out, F f) {
  const std::size_t blocks = Q.size() / kLaneWidth, rest = Q.size() % kLaneWidth;
  if (blocks > 0) f(Q.data(), blocks, out);
  if (rest == 0) return;
  std::array<Joints, kLaneWidth> filled;
  filled.fill(Q.back());
  std::copy(Q.end() - static_cast<std::ptrdiff_t>(rest), Q.end(), filled.begin());
  std::array<double, kLaneWidth * 6> result;
  f(filled.data(), std::size_t{1}, result.data());
  std::copy_n(result.begin(), rest * numbers, out + blocks * kLaneWidth * numbers);
}

constexpr std::size_t kTool = 6, kOffset = 3;  // numbers

}  // namespace

void VolumetricEvaluation::many(VolumetricKernel::Many call, std::size_t numbers,
                                std::span<const Joints> Q, const Vector3d& p_ST,
                                double* out) const {
  in_blocks(Q, numbers, out, [&](const Joints* poses, std::size_t blocks, double* to) {
    if (!functions_.has_tables()) {
      call(program_, nullptr, poses->data(), blocks, p_ST.data(), to);
      return;
    }
    for (std::size_t n = 0; n < blocks; ++n) {
      eight_with_tables(call, poses + n * kLaneWidth, p_ST, to + n * kLaneWidth * numbers);
    }
  });
}

void VolumetricEvaluation::tools(std::span<const Joints> Q, const Vector3d& p_ST,
                                 double* out) const {
  many(kernel_.tools, kTool, Q, p_ST, out);
}
void VolumetricEvaluation::errors(std::span<const Joints> Q, const Vector3d& p_ST,
                                  double* out) const {
  many(kernel_.errors, kTool, Q, p_ST, out);
}

// --- offsets ------------------------------------------------------------------------------------

template <class Coordinate>
Vector3d VolumetricEvaluation::tip_before_linear_axes(const Coordinate& q,
                                                      const Vector3d& p_ST) const {
  ToolPose tip{p_ST};
  for (std::size_t n = 0; n < tip_turns_; ++n) {
    const ChainAxis& axis = rotary_[n];
    apply(axis, motion_at(axis, q(static_cast<std::size_t>(axis.joint))), tip);
  }
  return tip.p_WT;
}

// q(lane, joint)
template <class Coordinate>
LinearAxisData VolumetricEvaluation::data_of_eight(const Coordinate& q,
                                                   const Vector3d& p_ST) const {
  LinearAxisData data{};
  for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
    const auto at = [&](std::size_t joint) { return q(lane, joint); };
    const Vector3d tip = tip_before_linear_axes(at, p_ST);
    for (std::size_t i = 0; i < kOffset; ++i) data.tip[i][lane] = tip[static_cast<int>(i)];
    linear_axis_functions_.tables_at(at,
                                     [&](std::size_t axis, std::size_t component, double value) {
                                       data.tables[axis].e[component][lane] += value;
                                     });
  }
  return data;
}

void VolumetricEvaluation::offset(const Joints& Q, const Vector3d& p_ST, double* out) const {
  if (is_plain_) {
    plain_offset(Q, p_ST, out);
    return;
  }
  if (!has_linear_axes_only_) {
    one(kernel_.offset, Q, p_ST, out);
    return;
  }
  const auto at = [&](std::size_t joint) { return Q[static_cast<int>(joint)]; };
  VolumetricPower tables{};
  linear_axis_functions_.tables_at(at, [&](std::size_t axis, std::size_t component, double value) {
    tables.e[component][axis] += value;
  });
  const Vector3d tip = tip_before_linear_axes(at, p_ST);
  linear_axis_kernel_.one(linear_axis_, &tables, tip.data(), Q.data(), out);
}

void VolumetricEvaluation::offsets(std::span<const Joints> Q, const Vector3d& p_ST,
                                   double* out) const {
  if (has_linear_axes_only_) {
    linear_axis_offsets(Q, p_ST, out);
  } else {
    many(kernel_.offsets, kOffset, Q, p_ST, out);
  }
}

void VolumetricEvaluation::linear_axis_offsets(std::span<const Joints> Q, const Vector3d& p_ST,
                                               double* out) const {
  in_blocks(Q, kOffset, out, [&](const Joints* poses, std::size_t blocks, double* to) {
    if (is_plain_) {
      linear_axis_kernel_.many(linear_axis_, nullptr, p_ST.data(), poses->data(), blocks, to);
      return;
    }
    for (std::size_t n = 0; n < blocks; ++n, poses += kLaneWidth, to += kOffset * kLaneWidth) {
      const LinearAxisData data = data_of_eight(
          [&](std::size_t lane, std::size_t joint) { return poses[lane][static_cast<int>(joint)]; },
          p_ST);
      linear_axis_kernel_.many(linear_axis_, &data, p_ST.data(), poses->data(), 1, to);
    }
  });
}

void VolumetricEvaluation::offsets(const LaneArray (&Q)[kJoints], const Vector3d& p_ST,
                                   LaneArray (&out)[kLinearJoints]) const {
  if (is_plain_) {
    linear_axis_kernel_.lanes(linear_axis_, nullptr, p_ST.data(), Q, out);
    return;
  }
  if (has_linear_axes_only_) {
    const LinearAxisData data =
        data_of_eight([&](std::size_t lane, std::size_t joint) { return Q[joint][lane]; }, p_ST);
    linear_axis_kernel_.lanes(linear_axis_, &data, p_ST.data(), Q, out);
    return;
  }
  std::array<Joints, kLaneWidth> poses;
  std::array<double, kOffset * kLaneWidth> result;
  for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
    for (std::size_t j = 0; j < kMachineJoints; ++j) poses[lane][static_cast<int>(j)] = Q[j][lane];
  }
  offsets(poses, p_ST, result.data());
  for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
    for (std::size_t i = 0; i < kOffset; ++i) out[i][lane] = result[kOffset * lane + i];
  }
}

}  // namespace servomill::plant
