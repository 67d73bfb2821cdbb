/// The offset of a machine of linear axes only, the rule among machines: X, Y and Z follow each
/// other in any order and on any side of the bed, and no other axis has errors. The tool travels
/// through the three, from the spindle to the workpiece; each shifts the ideal tip P by q along its
/// direction and adds to the deviation D of the true tip. With the shift w and the turn R of its
/// errors, and the lever u from where the axis turns the tool to the true tip,
///
///     u = P + slope q - c + D     D <- w + D + (R - 1) u     P <- P + q
///     (R - 1) u = a b x (u + b x u),  a = 2 - (4/3) |b|^2
///
/// where b is half the vector of angles, as the functions hold it: that is exact to 1e-16 for turns
/// below kSmallTurn. Larger ones go the same way with b tan(t/2)/(t/2) instead of b. The factor a
/// comes last for the first axis and joins b before m is known for the others: nothing waits longer
/// than it must. What is left behind the third axis is the offset: ideal turns behind it are undone
/// at once, ideal turns before it only place the tip.
///
/// Directions are renamed in the order in which the tool passes their axes: axis 0 moves along
/// direction 0. Where that mirrors X Y Z, all angles are counted with the opposite sign.
#pragma once

#include "plant/geometry/volumetric_kernel.h"

namespace servomill::plant {

inline constexpr std::size_t kLinearAxes = 3;

/// The coefficients of a power of q: [axis][direction]. The fourth is 0.
struct LinearAxisPower {
  double shift[kLinearAxes][4];      // m
  double half_turn[kLinearAxes][4];  // rad, of half the angles
};

/// Beginning of the lever of an axis: [direction], the fourth 0.
struct LinearAxisLever {
  double slope[4], centre[4];  // m/m, m
};

/// Points into memory of its owner.
struct LinearAxisProgram {
  std::uint8_t joint[kLinearAxes];  // place in Joints and direction of axes 0, 1, 2
  bool has_levers;                  // slope or c is not 0 for some axis
  bool has_constants;               // some error is not 0 at q = 0
  const LinearAxisPower* powers;    // c0, c1, ...
  LinearAxisLever levers[kLinearAxes];
  VolumetricFunctions functions;  // with half the angles
};

/// Inputs of the kernel for eight poses (lanes: poses): values of tables, and the tip before it
/// passes the first axis (m; X, Y, Z).
struct LinearAxisData {
  VolumetricPower tables[kLinearAxes];
  LaneArray tip[kLinearAxes];
};

/// Q: joints of one pose (5), of `blocks` times eight poses one behind the other, or of eight in
/// lanes ([5]). out: offset along X, Y, Z (m), in the same form.
/// It must not overlap Q. tables, tip: of one pose; no tables: null. data: of eight poses, for one
/// block only; null where there are no tables and the tip is that of all.
struct LinearAxisKernel {
  void (*one)(const LinearAxisProgram&, const VolumetricPower* tables, const double* tip,
              const double* Q, double* out);
  void (*many)(const LinearAxisProgram&, const LinearAxisData* data, const double* tip,
               const double* Q, std::size_t blocks, double* out);
  void (*lanes)(const LinearAxisProgram&, const LinearAxisData* data, const double* tip,
                const LaneArray* Q, LaneArray* out);
};

/// For programs that have what this one has.
template <SimdLevel level>
LinearAxisKernel make_linear_axis_kernel(const LinearAxisProgram& of);

template <>
LinearAxisKernel make_linear_axis_kernel<SimdLevel::baseline>(const LinearAxisProgram& of);
#ifdef SERVOMILL_X86
template <>
LinearAxisKernel make_linear_axis_kernel<SimdLevel::avx2>(const LinearAxisProgram& of);
template <>
LinearAxisKernel make_linear_axis_kernel<SimdLevel::avx512>(const LinearAxisProgram& of);
#endif

}  // namespace servomill::plant
