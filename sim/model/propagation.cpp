#include "sim/model/propagation.h"

#include "plant/vocabulary/interrupt.h"

namespace servomill::sim::model {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

plant::ErrorModel with(plant::ErrorModel errors, const std::vector<UncertainPart>& number,
                       plant::ErrorFunction UncertainPart::*side) {
  for (const UncertainPart& part : number) {
    if (part.name.is_location) {
      errors.location(part.name) = (part.*side).value(0.0);
    } else {
      errors.component(part.name) = part.*side;
    }
  }
  return errors;
}

}  // namespace

VectorXd expanded_uncertainty(const FromErrors& numbers, const plant::ErrorModel& errors,
                              const UncertainErrors& identified) {
  Eigen::MatrixXd J(numbers(errors).size(), Index(identified.parts.size()));
  for (std::size_t k = 0; k < identified.parts.size(); ++k) {
    throw_if_interrupted();
    const std::vector<UncertainPart>& one = identified.parts[k];
    J.col(Index(k)) = 0.5 * (numbers(with(errors, one, &UncertainPart::above)) -
                             numbers(with(errors, one, &UncertainPart::below)));
  }
  const VectorXd variances = (J * identified.correlation).cwiseProduct(J).rowwise().sum();
  return kCoverageFactor * variances.cwiseMax(0.0).cwiseSqrt();
}

}  // namespace servomill::sim::model
