/// Responses of the axes of a machine to an offset of their setpoints that is fed forward by its
/// differences over a position period.
#pragma once

#include <array>
#include <complex>
#include <optional>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/ticks.h"
#include "sim/model/forward.h"

namespace servomill::sim::preparation {

/// Response P of the slide or table from the exact sampled loops
/// (sim/frequency/frequency_response.h); or of the tip, which a structure that gives way to
/// acceleration moves in addition,
///
///     P (1 + sum of k_jj w^2 G_j(j w)),   G_j = 1 or that of a mode (inertial_compliance.h)
///
/// without what one axis does to another. Tabulated up to half the rate of the position loop,
/// finely where loops or structure ring, and linear in between.
class OffsetResponses {
 public:
  OffsetResponses() = default;  // ideal axes: 1
  /// @param joints         that are asked for
  /// @param reading_delay  ticks between the scale and what the position loop reads
  /// @param tip_at         joints (5; m, rad) where the structure gives way; nullopt: of the slide
  OffsetResponses(const model::MachineSettings& machine, const std::vector<int>& joints,
                  Tick reading_delay, const std::optional<Joints>& tip_at);

  /// @param f  Hz, >= 0; beyond the table its last value
  std::complex<double> at(int joint, double f) const;

 private:
  std::vector<double> f_;  // Hz, rising
  std::array<std::vector<std::complex<double>>, kJoints> P_;
};

}  // namespace servomill::sim::preparation
