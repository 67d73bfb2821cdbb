/// The offset of a straight machine, the rule among machines: X, Y and Z follow each other in any
/// order and on any side of the bed, and no other axis has errors. The tool travels through the
/// three, from the spindle to the workpiece; each shifts the ideal tip P by q along its direction
/// and adds to the deviation D of the true tip. With the shift w and the turn R of its errors
///
///     g = w + (R - 1)(P + slope q - c)     D <- g + D + (R - 1) D     P <- P + q
///
/// where g does not wait for the axes before. What is left behind the third axis is the offset:
/// ideal turns behind it are undone at once, ideal turns before it only place the tip.
///
/// Directions are renamed in the order in which the tool passes their axes: axis 0 moves along
/// direction 0. Where that mirrors X Y Z, all angles are counted with the opposite sign.
#pragma once

#include "plant/geometry/volumetric_kernel.h"

namespace servomill::plant {

inline constexpr std::size_t kStraightAxes = 3;

/// Points into memory of its owner.
struct StraightProgram {
  std::uint8_t joint[kStraightAxes];  // place in Joints and direction of axes 0, 1, 2
  bool has_levers;                    // slope or c is not 0 for some axis
  LaneArray lever_slope[kStraightAxes], lever_centre[kStraightAxes];  // m/m, m; lanes: axes
  VolumetricFunctions functions;
};

/// What the kernel does not compute of eight poses (lanes: poses): values of tables, and the tip
/// before it passes the first axis (m; X, Y, Z).
struct StraightData {
  VolumetricPower tables[kStraightAxes];
  LaneArray tip[kStraightAxes];
};

/// Q: joints of one pose (5), of `blocks` times eight poses one behind the other, or of eight in
/// lanes ([5]). out: offset along X, Y, Z (m), in the same form.
/// tables, tip: of one pose; no tables: null. data: of eight poses, for one block only; null where
/// there are no tables and the tip is that of all.
struct StraightKernel {
  void (*one)(const StraightProgram&, const VolumetricPower* tables, const double* tip,
              const double* Q, double* out);
  void (*many)(const StraightProgram&, const StraightData* data, const double* tip, const double* Q,
               std::size_t blocks, double* out);
  void (*lanes)(const StraightProgram&, const StraightData* data, const double* tip,
                const LaneArray* Q, LaneArray* out);
};

/// For programs with these functions.
template <SimdLevel level>
StraightKernel make_straight_kernel(const VolumetricFunctions& of);

template <>
StraightKernel make_straight_kernel<SimdLevel::baseline>(const VolumetricFunctions& of);
#ifdef SERVOMILL_X86
template <>
StraightKernel make_straight_kernel<SimdLevel::avx2>(const VolumetricFunctions& of);
template <>
StraightKernel make_straight_kernel<SimdLevel::avx512>(const VolumetricFunctions& of);
#endif

}  // namespace servomill::plant
