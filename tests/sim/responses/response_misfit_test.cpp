#include "sim/responses/response_misfit.h"

#include <gtest/gtest.h>

namespace servomill::sim::responses::response_misfit_test {
namespace {

TEST(ResponseMisfit, CountsTheMisfitInNoiseAndInShares) {
  MeasuredResponse response;
  for (const double size : {1.0, 2.0, 4.0}) {
    ResponseLine line;
    line.value = size;
    line.variance = 0.02;
    response.lines.push_back(line);
  }
  const std::vector<Complex> model = {1.1, {2.0, 0.1}, 3.9};
  EXPECT_NEAR(median_misfit(response, model), 0.05, 1e-12);
  EXPECT_NEAR(noise_ratio(response, model, 4), std::sqrt(1.5), 1e-12);
  EXPECT_NEAR(line_weights(response, 0.0)[0], 10.0, 1e-6);
  EXPECT_NEAR(line_weights(response, 0.5)[2], 1.0 / std::sqrt(0.01 + 2.0), 1e-12);
}

}  // namespace
}  // namespace servomill::sim::responses::response_misfit_test
