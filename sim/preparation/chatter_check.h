/// Chatter of the cuts of a program, and what regeneration needs of the machine.
#pragma once

#include <Eigen/Core>
#include <map>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "plant/cutting/chatter_stability.h"
#include "plant/cutting/engagement.h"
#include "plant/kinematics/chain.h"
#include "plant/structure/inertial_compliance.h"
#include "plant/vocabulary/input_error.h"
#include "sim/model/forward.h"

namespace servomill::sim::preparation {

/// Frequency of the fastest mode of the tool point (1/s); 0: there is none.
double highest_mode(const model::MachineSettings& machine);

/// Chips regenerate by vibration across the tool or, of a machine without modes that vibrate, by
/// its static compliance.
/// @param start  Q, where the program begins
/// @throws InputError at [cutting] if the case is to be cut with regeneration and its machine has
///         neither across the tool
void refuse_regeneration(const model::Scenario& scenario, const model::CaseSpec& spec,
                         const Joints& start);

/// Stability of the engagements along a program. Equal ones (within 1 deg and 1 % of depth) are
/// computed once.
class ChatterCheck {
 public:
  /// @param modes  of the tool point; none: nothing is checked. All arguments must outlive this
  ChatterCheck(const std::vector<plant::StructuralMode>& modes,
               const plant::CuttingCoefficients& coefficients, const plant::MachineChain& chain)
      : modes_(modes), K_(coefficients), chain_(chain) {}

  /// A cut in a line of the program.
  /// @param frame  of the cutter, in W
  /// @param turns  1/s, of the spindle, > 0
  /// @param Q      joints (5; m, rad)
  void add(int line, int tool, const plant::Cutter& cutter, const plant::CutterFrame& frame,
           std::span<const plant::EngagedArc> arcs, double turns, const Joints& Q);

  /// Lines in which vibrations grow, the first five of them, and the number of others.
  std::vector<Fault> warnings(const std::string& file) const;

 private:
  struct Unstable {
    int tool = 0;
    double turns = 0.0;      // 1/s
    double excess = 0.0;     // depth over that of the limit of stability
    double frequency = 0.0;  // 1/s
    bool is_flip = false;
  };
  using Key = std::tuple<int, double, std::vector<int>>;

  Unstable stability_of(const plant::PeriodicCut& cut,
                        std::span<const plant::ChatterMode> modes) const;

  const std::vector<plant::StructuralMode>& modes_;
  const plant::CuttingCoefficients& K_;
  const plant::MachineChain& chain_;
  std::map<Key, Unstable> known_;
  std::map<int, Unstable> lines_;  // the worst of each
  double fastest_left_out_ = 0.0;  // 1/s, of the spindle, among cuts that were not examined
};

}  // namespace servomill::sim::preparation
