/// Misfit of a model to a measured frequency response, and the weights of its lines.
#pragma once

#include <vector>

#include "sim/responses/period_response.h"

namespace servomill::sim::responses {

/// Median of |model - measured| / |measured|. @param model  at each line
double median_misfit(const MeasuredResponse& response, const std::vector<Complex>& model);

/// Root mean square of the misfit over the noise: 1 where noise explains it.
double noise_ratio(const MeasuredResponse& response, const std::vector<Complex>& model,
                   std::size_t parameters);

/// One over the standard deviation of real and imaginary part of each line.
/// @param floor  misfit of the model, relative: keeps lines that are measured best from carrying
///               all the weight
std::vector<double> line_weights(const MeasuredResponse& response, double floor);

}  // namespace servomill::sim::responses
