#include "sim/compensate/correction.h"

#include <cmath>

#include "plant/vocabulary/units.h"

namespace servomill::sim {
namespace {

const double kSingular = std::sin(1.0 * deg);  // as the strategies have it unless told otherwise

strategies::Belief belief_of(const plant::MachineChain& chain, const plant::ErrorModel& errors) {
  return {.layout = chain.layout, .model = plant::VolumetricModel(chain, errors)};
}

}  // namespace

Correction::Correction(const plant::MachineChain& chain, const plant::ErrorModel& errors,
                       strategies::DisplacedAxes axes)
    : belief_(belief_of(chain, errors)),
      axes_(axes),
      all_(belief_, strategies::Iterations::converged, kSingular) {}

AxisWords Correction::at(const AxisWords& machine) const {
  const Joints Q = belief_.layout.joints(machine);
  AxisWords d = AxisWords::Zero();
  if (axes_ == strategies::DisplacedAxes::all) {
    d = belief_.layout.words(all_.of_set_point(strategies::Sign::correct, Q));
  } else {
    d.head<3>() = strategies::set_point_displacement(belief_, strategies::Sign::correct,
                                                     strategies::Iterations::converged, Q);
  }
  return d;
}

strategies::Leftover Correction::leftover(const AxisWords& machine) const {
  return strategies::uncorrectable(belief_, axes_, kSingular, belief_.layout.joints(machine));
}

}  // namespace servomill::sim
