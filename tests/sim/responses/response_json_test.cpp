#include "sim/responses/response_json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace servomill::sim::responses::response_json_test {
namespace {

ResponseRecord one_line() {
  ResponseRecord record;
  record.recording = "sweep.csv";
  record.input = {"current", "A"};
  record.output = {"angle", "rad"};
  record.response.lines.push_back({.frequency = 10.0, .value = {0.0, -2.0}, .variance = 0.25});
  record.response.lines.back().radius_95 = 0.5;
  record.response.periods = 4;
  return record;
}

TEST(ResponseJson, HasLinesWithTheirUncertainty) {
  EXPECT_EQ(to_json(one_line()),
            R"({"recording": "sweep.csv", "input": "current", "output": "angle", )"
            R"("unit": "rad/A", "periods": 4, "lines_per_estimate": 1, "unexcited_lines": 0, )"
            R"("lines": [{"frequency_Hz": 10, "magnitude": 2, "phase_deg": -90, )"
            R"("radius_95": 0.5, "variance": 0.25}], )"
            R"("extremes": [], "two_mass": null, "rational": null})");
}

TEST(ResponseJson, HasNoNumberForWhatWasNotFound) {
  ResponseRecord record = one_line();
  record.response.periods = 0;  // taken as it is, without periods
  record.rational.emplace();
  record.rational->poles.push_back({.frequency = 5.0, .damping = 1.0});
  const std::string json = to_json(record);
  EXPECT_NE(json.find(R"("periods": null)"), std::string::npos);
  EXPECT_NE(json.find(R"("damping": 1, "U_damping": null)"), std::string::npos) << json;
  EXPECT_NE(json.find(R"("dead_time_s": null, "U_dead_time_s": null)"), std::string::npos);
}

}  // namespace
}  // namespace servomill::sim::responses::response_json_test
