/// Checks the circular tests of a scenario against the circles that its program describes.
#pragma once

#include <Eigen/Core>
#include <map>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/metrology/circular_test.h"
#include "sim/metrology/section_circle.h"

namespace servomill::sim::model {
struct Scenario;
}  // namespace servomill::sim::model

namespace servomill::sim::preparation {

/// A section of a program, looked at as one turn of a circle.
struct CircularSection {
  std::variant<metrology::SectionCircle, metrology::NoCircle> circle;
  metrology::Sense sense = metrology::Sense::counter_clockwise;
};

/// @param positions  nominal tool centre point (in the workpiece, m) at the samples of a section
CircularSection circular_section(const std::vector<Eigen::Vector3d>& positions);

/// Sections that the quantities of a circular test name, each once.
std::set<std::string> circular_section_names(const model::Scenario& scenario);

/// Faults of quantities of a circular test: a section is not one turn of a circle in a principal
/// plane, its samples lie too far apart, an axis does not move in it, or a pair of sections is not
/// one circle in both directions.
/// @param sections  one for each of circular_section_names
std::vector<Fault> circular_faults(const model::Scenario& scenario,
                                   const std::map<std::string, CircularSection>& sections);

}  // namespace servomill::sim::preparation
