#include "sim/calibration/suggestions.h"

#include <gtest/gtest.h>

#include "sim/calibration/make_up.h"
#include "sim/calibration/plan_candidates.h"
#include "sim/model/machine.h"
#include "tests/sim/calibration/shop.h"

namespace servomill::sim::calibration::suggestions_test {
namespace {

using plant::operator""_err;

model::MachineSettings gantry_machine() {
  model::MachineSettings machine;
  machine.chain = gantry();
  machine.nc.upper << 1.0, 1.0, 1.0, 0.0, 0.0;
  return machine;
}

Calibration calibrated(readings::Readings all) {
  make_up(all, gantry(), {}, 3);
  CalibrationSettings settings;
  settings.form_linear.degree = 3;
  return calibrate(std::move(all), gantry(), settings);
}

readings::Readings without(const std::string& name) {
  readings::Readings out = shop_readings();
  std::erase_if(out.groups, [&](const readings::Group& group) {
    return group.name.find(name) != std::string::npos;
  });
  return out;
}

// The set-up that a sentence names.
readings::Group candidate_of(const std::string& sentence) {
  PlanSettings settings;
  for (std::size_t k = 0; k < kPlanInstruments.size(); ++k) {
    settings.instruments.push_back(static_cast<PlanInstrument>(k));
  }
  for (const PlannedSetUp& one : plan_candidates(gantry_machine(), settings)) {
    if (sentence.find(one.group.name + " (") != std::string::npos) return one.group;
  }
  ADD_FAILURE() << sentence << " names no set-up";
  return {};
}

TEST(Suggestions, AreNoneWhereEverythingIsKnown) {
  EXPECT_TRUE(suggestions(calibrated(shop_readings()), gantry_machine()).empty());
}

// Taken, the set-up determines what it was to determine, and nothing is left to suggest.
TEST(Suggestions, WhenTakenTellWhatTheyWereTo) {
  for (const char* const missing : {"square XY", "square YZ", "X positioning"}) {
    readings::Readings some = without(missing);
    const std::vector<std::string> sentences = suggestions(calibrated(some), gantry_machine());
    ASSERT_EQ(sentences.size(), 1u) << missing;
    some.groups.push_back(candidate_of(sentences[0]));
    EXPECT_TRUE(suggestions(calibrated(some), gantry_machine()).empty())
        << missing << ": " << sentences[0];
  }
}

TEST(Suggestions, NameWhatNoSingleSetUpTells) {
  readings::Readings circle;
  circle.groups = {candidate_of("circle XY at X 500, Y 500, Z 500, tool 100 mm (")};
  const std::vector<std::string> sentences = suggestions(calibrated(circle), gantry_machine());
  ASSERT_FALSE(sentences.empty());
  EXPECT_TRUE(sentences.back().ends_with("servomill plan-calibration finds a combination"))
      << sentences.back();
}

}  // namespace
}  // namespace servomill::sim::calibration::suggestions_test
