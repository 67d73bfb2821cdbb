/// The arithmetic of VolumetricModel in general, compiled for each instruction set
/// (plant/vocabulary/simd.h).
///
/// The tool travels through a list of steps, from the spindle to the workpiece. A fault, the errors
/// of one axis, moves it by
///
///     p <- R (p - c) + c + w       k <- R k
///
/// The quantities that do not depend on the tool, w and R, are computed for all axes first: for one
/// pose with the axes in lanes, for many with the poses in lanes. Both run the same formulas with
/// the same roundings, so that a pose has the same bits alone and among others. Machines with AVX2
/// and with AVX-512 agree in every bit; the baseline, which rounds a b + c twice, differs by
/// rounding.
///
/// The offset of most machines needs less: linear_axis_kernel.h.
#pragma once

#include <cstddef>
#include <cstdint>

#include "plant/vocabulary/lanes.h"
#include "plant/vocabulary/simd.h"

namespace servomill::plant {

inline constexpr std::size_t kMachineJoints = 5;
inline constexpr std::size_t kTurnedJoints = 2;     // the last ones
inline constexpr std::size_t kErrorComponents = 6;  // along X, Y, Z, about A, B, C

/// Turns below this use the first two terms of their sine, whose next one is below 1e-16: those of
/// the linear-axis path (linear_axis_kernel.h).
inline constexpr double kSmallTurn = 2e-4;  // rad

/// Turns below this use series of three terms, whose next one is below 1e-16: all that the errors
/// of a machine amount to. The linear-axis path has no use for them.
inline constexpr double kSeriesTurn = 5e-3;  // rad

enum class VolumetricMove : std::uint8_t {
  shift,         // an ideal linear axis
  turn,          // an ideal rotary axis
  tilted_turn,   // a rotary axis with location errors; ideal for the ideal tool
  faulty_shift,  // a linear axis with errors; ideal for the ideal tool
  fault,         // errors of a rotary axis before or after its turn; nothing for the ideal tool
  enter_frame,   // p <- R^T (p - c): what follows is that of an inclined axis, in its own frame
  leave_frame    // p <- R p + c
};

/// p <- M p + d, k <- M k: the numbers of M, row by row, and of d (m), then gaps.
inline constexpr std::size_t kMotionNumbers = 16;

struct VolumetricStep {
  VolumetricMove move;
  bool has_angles, has_lever;     // a fault: turns the tool; c or lever_slope is not 0
  std::uint8_t direction, joint;  // 0, 1, 2: along X, Y, Z or about A, B, C; place in Joints
  double centre[3];               // m, c: where the lever of a fault and a turn begin at q = 0
  double lever_slope[3];          // m/m: c moves by -lever_slope q (workpiece side)
  double R[3][3];                 // of a frame: its orientation
  // of a tilted turn: its motion is still + cosine turning[0] + sine turning[1]
  double still[kMotionNumbers], turning[2][kMotionNumbers];
};

/// Eight waves sin(omega q + phase).
struct VolumetricWaves {
  LaneArray omega, phase;  // 1/m or 1, rad
  std::uint8_t axis[kLaneWidth];
};

/// Contribution of one wave to one error.
struct VolumetricHarmonic {
  std::size_t wave;  // 8 x block + lane
  std::size_t component;
  LaneArray amplitude;  // m or rad; lanes: axes, 0 in all but that of the wave
};

/// The coefficients of a power of q, or other numbers: [component], lanes: axes.
struct VolumetricPower {
  LaneArray e[kErrorComponents];
};

/// Polynomials and harmonics of axes, which are counted as the program that uses them does.
struct VolumetricFunctions {
  const VolumetricPower* polynomial;  // c0, c1, ...
  std::size_t degree;                 // >= 3
  const VolumetricWaves* waves;
  std::size_t number_of_waves;
  const VolumetricHarmonic* harmonics;  // in the order of their waves; behind the last one stands
                                        // one of a wave that there is not
  std::size_t axes;                     // 1 + the last axis that has errors, or 0
  bool has_angles;                      // some error is an angle
  bool has_terms;                       // beyond polynomials: harmonics or tables
  bool is_cubic;                        // degree 3, no terms
};

/// A machine and its errors. Points into memory of its owner.
struct VolumetricProgram {
  const VolumetricStep* steps;  // in the order in which they move the tool
  std::size_t number_of_steps;
  std::size_t offset_steps;       // without the last ones, ideal turns, which offsets undo at once
  std::size_t linear_end;         // behind the last linear step: no other shift follows
  VolumetricFunctions functions;  // counted as joints
  bool has_turns;
  double senses[kTurnedJoints];  // -1 where the joint counts the turn of a table
};

/// Inputs of the kernel: values of tables.
struct OnePoseData {
  VolumetricPower tables;  // lanes: joints
};
struct EightPosesData {
  VolumetricPower tables[kMachineJoints];  // lanes: poses
};

/// Q: joints of one pose (5), or of `blocks` times eight poses one behind the other. p_ST: tip in
/// the spindle nose (3). Data: one, or one for each block; may be null where the program has
/// no tables. out: offset 3; tool 6 (tip, axis); error 6 (of the tip, of the axis)
/// per pose.
struct VolumetricKernel {
  using One = void (*)(const VolumetricProgram&, const OnePoseData*, const double* Q,
                       const double* p_ST, double* out);
  using Many = void (*)(const VolumetricProgram&, const EightPosesData*, const double* Q,
                        std::size_t blocks, const double* p_ST, double* out);
  One tool, error, offset;
  Many tools, errors, offsets;
};

/// @param in_frames  for programs that enter frames; those that do not are faster without
template <SimdLevel level>
VolumetricKernel make_volumetric_kernel(bool in_frames);

template <>
VolumetricKernel make_volumetric_kernel<SimdLevel::baseline>(bool in_frames);
#ifdef SERVOMILL_X86
template <>
VolumetricKernel make_volumetric_kernel<SimdLevel::avx2>(bool in_frames);
template <>
VolumetricKernel make_volumetric_kernel<SimdLevel::avx512>(bool in_frames);
#endif

}  // namespace servomill::plant
