/// The quantities of tests with a ball in the spindle and sensors on the table, of one case, from
/// its recorded path: R-test and ball bar (ISO 10791-6).
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/evaluation/case_samples.h"
#include "sim/evaluation/quantity.h"
#include "sim/metrology/r_test.h"
#include "sim/model/forward.h"

namespace servomill::sim::evaluation {

/// Entries of this family: QuantityEntry::is_r_test.
std::span<const QuantityEntry> r_test_quantities();

/// Every identification is made once, however many quantities ask for its errors.
class BallQuantities {
 public:
  /// @param samples  must outlive this
  explicit BallQuantities(CaseSamples& samples) : samples_(samples) {}

  /// The recorded path of the tip; empty if it was not recorded.
  /// @pre the case has a recording
  metrology::TipPath path_of(const std::vector<std::string>& sections);
  /// A location error (spec.ball) in unit_of_location; or NaN and why the sections do not tell.
  QuantityValue location(const model::QuantitySpec& spec);

 private:
  struct Identified {
    metrology::LocationFit fit;
    std::string why_not;
  };

  Identified identify(const model::QuantitySpec& spec);

  CaseSamples& samples_;
  std::map<std::string, Identified> identified_;  // by sections and set-up
};

/// Unit of a location error of that name in comparisons.
std::string_view unit_of_location(const plant::ErrorName& name);

}  // namespace servomill::sim::evaluation
