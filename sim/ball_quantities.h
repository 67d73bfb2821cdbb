/// The quantities of tests with a ball in the spindle and sensors on the table, of one case, from
/// its recorded path: R-test and ball bar (ISO 10791-6).
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sim/case_samples.h"
#include "sim/metrology/location_errors.h"

namespace servomill::sim {

struct BallSpec;
struct QuantitySpec;

/// Every identification is made once, however many quantities ask for its errors.
class BallQuantities {
 public:
  /// @param samples  must outlive this
  explicit BallQuantities(CaseSamples& samples) : samples_(samples) {}

  /// What the sensor says at every sample, um; none, and why in `note`, where the sections are no
  /// such test.
  /// @pre quantity_info(spec.name).is_of_ball with a statistic; the case has a recording
  std::vector<double> deviations(const QuantitySpec& spec, std::string& note);

  /// Of location_error, in unit_of_location; NaN, and why in `note`, where the sections do not
  /// tell.
  double location(const QuantitySpec& spec, std::string& note);

 private:
  // The samples of some sections.
  struct Path {
    std::vector<Joints> Q;                         // of the NC
    std::vector<Eigen::Vector3d> nominal, actual;  // m, tip in the workpiece
  };
  struct Identified {
    LocationFit fit;
    std::string why_not;
  };

  Path path_of(const std::vector<std::string>& sections, const BallSpec& ball);
  Identified identify(const QuantitySpec& spec);

  CaseSamples& samples_;
  std::map<std::string, Identified> identified_;  // by sections and set-up
};

/// Unit of a location error of that name in comparisons.
std::string_view unit_of_location(const plant::ErrorName& name);

}  // namespace servomill::sim
