#include "plant/geometry/linear_axis_kernel.h"

#include "plant/geometry/linear_axis_many_poses.h"
#include "plant/geometry/linear_axis_one_pose.h"

namespace servomill::plant {
namespace {

template <Parts has>
LinearAxisKernel kernel() {
  return {&one<has>, &many<has>, &lanes<has>};
}

}  // namespace

template <>
LinearAxisKernel make_linear_axis_kernel<SERVOMILL_LEVEL>(const LinearAxisProgram& of) {
  if (!of.functions.is_cubic) {
    return of.functions.has_angles ? kernel<Parts{Way::small, true, true, true}>()
                                   : kernel<Parts{Way::small, false, false, true}>();
  }
  if (!of.functions.has_angles) return kernel<Parts{Way::cubic, false, false, true}>();
  if (of.has_levers) {
    return of.has_constants ? kernel<Parts{Way::cubic, true, true, true}>()
                            : kernel<Parts{Way::cubic, true, true, false}>();
  }
  return of.has_constants ? kernel<Parts{Way::cubic, true, false, true}>()
                          : kernel<Parts{Way::cubic, true, false, false}>();
}

}  // namespace servomill::plant
