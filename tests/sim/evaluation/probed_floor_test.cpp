/// Floors with marks of single teeth, and their roughness, on the virtual CMM.
#include <gtest/gtest.h>

#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"
#include "sim/run/run.h"
#include "sim/run/run_output.h"

namespace servomill::sim::evaluation::probed_floor_test {
namespace {

double value_of(const run::RunOutput& output, const std::string& quantity, const std::string& probe,
                const std::string& one) {
  for (const auto& row : output.comparison) {
    if (row.quantity == quantity && row.case_name == one && row.sections == probe) return row.value;
  }
  ADD_FAILURE() << "no " << quantity << " of " << probe << " in " << one;
  return 0.0;
}

// c = 73 um, a head that leans by 1 mrad in the feed: saw teeth of c tan(theta) with Ra of a
// quarter; with run-out each turn has a valley deeper by the eccentricity and a tooth longer by it.
TEST(ProbedFloor, OfALeaningSpindleHasSawTeeth) {
  const model::Scenario scenario =
      input::read_scenario(SERVOMILL_SOURCE_DIR "/scenarios/parts/floor_marks.toml");
  const run::RunOutput output = run::run_scenario(scenario, {});
  constexpr double kShare = 0.025;  // points that meet no peak
  EXPECT_NEAR(value_of(output, "roughness_Rz", "first", "leaning"), 0.073, kShare * 0.073);
  EXPECT_NEAR(value_of(output, "roughness_Ra", "first", "leaning"), 0.073 / 4.0, kShare * 0.073);
  EXPECT_NEAR(value_of(output, "roughness_Rz", "second", "leaning"), 0.123, kShare * 0.123);
  EXPECT_LT(value_of(output, "roughness_Rz", "first", "square"), 1e-6);
}

}  // namespace
}  // namespace servomill::sim::evaluation::probed_floor_test
