/// Quantities that a scenario asks of its cases.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plant/geometry/error_name.h"
#include "plant/vocabulary/input_error.h"
#include "sim/model/tolerance.h"

namespace servomill::sim::metrology {
class TriangleMesh;  // sim/metrology/triangle_mesh.h
}  // namespace servomill::sim::metrology

namespace servomill::sim::model {

/// Ball in the spindle and sensors on the table, as a quantity needs them.
struct BallSpec {
  std::vector<Eigen::Vector3d> bar_centres;    // m, in the workpiece: of a ball bar, for each of
                                               // the sections; none: a nest of three sensors
  bool tcp_is_known = false;                   // the ball lies where the program has the tip
  std::optional<plant::ErrorName> error = {};  // location_error: which
};

/// Features of the probed part that a quantity needs.
struct PartSpec {
  std::vector<std::string> probes;  // features, each the name of a [[probe]]
  bool minimum_zone = true;         // of the fit, where there is a choice; else least squares
  std::shared_ptr<const metrology::TriangleMesh>
      nominal;  // of a best fit; none: to the faces at the probes
};

/// One line of the comparison, for one or several cases.
struct QuantitySpec {
  std::string name;       // one of quantity_names()
  char axis = '\0';       // X, Y, Z, ...; '\0' where the quantity has none
  std::string statistic;  // max, rms, mean, range
  std::vector<std::string> cases;
  std::string baseline;               // case compared with, for differences
  std::vector<std::string> sections;  // of the program; empty: all
  Place sections_place;
  std::string reference;  // the paper's number with unit, or empty
  std::string basis;      // fitted, predicted, assumed, upper_bound or empty
  std::optional<Tolerance> tolerance = {};
  std::optional<BallSpec> ball = {};
  std::optional<PartSpec> part = {};
};

}  // namespace servomill::sim::model
