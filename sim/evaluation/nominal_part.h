/// The part as it should be: a mesh that a scenario names.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/metrology/probing_plan.h"
#include "sim/metrology/triangle_mesh.h"

namespace servomill::sim::evaluation {

/// A probe lies on the part where its nominal points are no farther from the mesh: STL files of CAD
/// systems keep chords of arcs well within that.
constexpr double kOffThePart = 0.1e-3;  // m

/// A body in coordinates of the program.
struct NominalPart {
  std::string file;   // as messages name it
  std::string bytes;  // STL
  std::shared_ptr<const metrology::TriangleMesh> mesh;
};

/// A fault for every probe with nominal points that are off the part, or on its surface but not
/// facing as it does.
std::vector<Fault> faults_of_plan(std::span<const metrology::ProbeSpec> plan,
                                  const NominalPart& part);

/// The largest distance (m) of a nominal point from the mesh: what its facets leave.
double largest_distance(std::span<const metrology::ProbeSpec> plan,
                        const metrology::TriangleMesh& mesh);

}  // namespace servomill::sim::evaluation
