/// The part that a case left behind, on the CMM.
#pragma once

#include <string>
#include <vector>

#include "sim/metrology/cmm.h"
#include "sim/metrology/probing_plan.h"
#include "sim/records/series.h"

namespace servomill::sim::evaluation {

struct PartSource;  // sim/evaluation/cutter_path.h

/// Result of the CMM for one feature of one case.
struct ProbedFeature {
  std::string name;
  metrology::Feature feature;                 // nominal
  std::vector<double> deviation;              // m along the normals, without error of the CMM; NaN:
                                              // nothing was met
  std::vector<std::vector<double>> measured;  // repetition, point; m
  std::vector<double> imposed;                // m along the normals, where errors are imposed
};

/// Result of the CMM for one case.
struct ProbedPart {
  std::vector<ProbedFeature> features;  // one for each [[probe]]
  std::vector<std::string> notes;  // what was missed, and how well the recorded path resolves it
};

/// Largest distance (m) between the recorded feed motion, straight from row to row, and a parabola
/// through three rows: a T^2 / 8 for an acceleration a and a record period T (0.6 um at 5 m/s^2 and
/// 1 ms), 0 where the tool moves evenly.
double chord_error(const records::Series& servo);

/// Range of the recorded deflection of the structure (m), over all axes: bound of a vibration.
double deflection_range(const records::Series& servo);

/// How many positions of the cutters are in memory, 200 bytes each.
struct PositionsHeld {
  std::size_t most = 500'000;    // of a longer path only what comes near some points at a time
  std::size_t at_once = 60'000;  // then, or twice what a single point has
};

/// Cuts the part and probes it. Depths do not depend on what is held, but for 1 nm.
ProbedPart probe_part(const PartSource& source, const std::vector<metrology::ProbeSpec>& plan,
                      const metrology::Cmm& cmm, const PositionsHeld& held = {});

/// Means of the repetitions along the normals (m); with a base case minus those of it. NaN: one of
/// them met nothing.
std::vector<double> mean_deviations(const ProbedFeature& feature,
                                    const ProbedFeature* base = nullptr);

inline Eigen::Vector3d probed_point(const plant::ProbeTarget& target, double deviation) {
  return target.point + deviation * target.normal;
}

}  // namespace servomill::sim::evaluation
