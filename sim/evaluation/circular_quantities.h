/// The quantities of circular tests of one case, from its recorded path.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/evaluation/case_samples.h"
#include "sim/metrology/circular_test.h"
#include "sim/metrology/section_circle.h"

namespace servomill::sim {

struct QuantitySpec;

/// Every turn, and every pair of turns, is evaluated once, however many quantities ask for it.
class CircularQuantities {
 public:
  /// @param samples  must outlive this
  explicit CircularQuantities(CaseSamples& samples) : samples_(samples) {}

  /// In the unit of quantity_info; NaN where a section is no turn of a circle.
  /// @pre quantity_info(spec.name).circles > 0; the case has a recording
  double value(const QuantitySpec& spec);

 private:
  // A section as a circle and the true path there.
  struct Turn {
    SectionCircle circle;
    std::vector<Eigen::Vector2d> path;  // m
    std::optional<CircularTurn> evaluated = {};
  };

  std::optional<Turn> find_turn(const std::string& section);
  std::optional<Turn>& turn(const std::string& section);
  const BidirectionalCircle& both(const std::vector<std::string>& sections);

  CaseSamples& samples_;
  std::map<std::string, std::optional<Turn>> turns_;
  std::map<std::vector<std::string>, BidirectionalCircle> pairs_;
};

}  // namespace servomill::sim
