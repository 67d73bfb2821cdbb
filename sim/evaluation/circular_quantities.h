/// The quantities of circular tests of one case, from its recorded path.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/evaluation/case_samples.h"
#include "sim/evaluation/quantity.h"
#include "sim/metrology/circular_test.h"
#include "sim/metrology/section_circle.h"

namespace servomill::sim::evaluation {

/// Entries of this family, in QuantityEntry::circles 1 or 2.
std::span<const QuantityEntry> circular_quantities();

/// Every turn, and every pair of turns, is evaluated once, however many quantities ask for it, and
/// no further than they do.
class CircularQuantities {
 public:
  /// @param samples  must outlive this
  explicit CircularQuantities(CaseSamples& samples) : samples_(samples) {}

  /// A section as a circle and the true path there.
  struct Turn {
    metrology::SectionCircle circle;
    std::vector<Eigen::Vector2d> path;  // m
    std::optional<metrology::LeastSquaresTurn> evaluated = {};
    std::optional<metrology::RadialRange> range = {};  // about the least-squares centre, m
    std::optional<double> zone_width = {};             // m, of the minimum zone
  };

  /// One turn, evaluated; nullptr where the section is no turn of a circle.
  /// @pre the case has a recording
  const Turn* evaluated(const std::string& section);
  /// Radial deviations of one turn about its least-squares centre; nullptr as above.
  /// @pre the case has a recording
  const metrology::RadialRange* range(const std::string& section);
  /// Width of the minimum zone of one turn (m); nullopt as above.
  /// @pre the case has a recording
  std::optional<double> zone_width(const std::string& section);
  /// Two turns together; nullptr where one of the two sections is no turn of a circle.
  /// @pre the case has a recording
  const metrology::BidirectionalCircle* both(const std::vector<std::string>& sections);

 private:
  std::optional<Turn> find_turn(const std::string& section);
  std::optional<Turn>& turn(const std::string& section);

  CaseSamples& samples_;
  std::map<std::string, std::optional<Turn>> turns_;
  std::map<std::vector<std::string>, metrology::BidirectionalCircle> pairs_;
};

}  // namespace servomill::sim::evaluation
