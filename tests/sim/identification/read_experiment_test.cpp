#include "sim/identification/experiment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "tests/sim/identification/axis_experiment.h"
#include "tests/text.h"

namespace servomill::sim::identification::read_experiment_test {
namespace {

constexpr const char* kMass = "[[estimate]]\nkey = \"axis.X.moving_mass\"\n";

class ReadExperiment : public testing::Test {
 protected:
  ReadExperiment() { files_.write_recording(recorded(ramps(0.5), {small_axis(), small_loop()})); }
  std::string faults(const std::string& rest) {
    return fault_messages([&] { read_experiment(files_.write(rest)); });
  }
  AxisExperiment files_;
};

TEST_F(ReadExperiment, TakesStartsFromTheMachineInItsUnits) {
  const Experiment e = read_experiment(files_.write(kMass));
  ASSERT_EQ(e.estimates.size(), 1u);
  EXPECT_EQ(e.estimates[0].start, 95.0);
  EXPECT_EQ(e.estimates[0].unit, "kg");
  ASSERT_EQ(e.records.size(), 1u);
  EXPECT_EQ(e.records[0].record.size(), 500u);
  EXPECT_EQ(e.records[0].joint, 0);
}

TEST_F(ReadExperiment, RefusesKeysThatAreNowhere) {
  EXPECT_EQ(faults("[[estimate]]\nkey = \"axis.X.backlash\"\n"),
            "estimate[0]: axis.X.backlash is not in the machine or the loop; add start = \"VALUE "
            "UNIT\"\n");
  EXPECT_EQ(faults(std::string(kMass) + kMass),
            "estimate[1]: axis.X.moving_mass is estimated twice\n");
}

TEST_F(ReadExperiment, RefusesChannelsThatAreNotThereWithTheNearest) {
  const std::string other =
      "[[recording]]\nfile = \"recording.csv\"\naxis.X = { command = \"q\", "
      "feedback = \"yy\" }\n";
  EXPECT_EQ(faults(other + kMass), "recording[1].axis.X.feedback = \"yy\"; is not a channel of " +
                                       files_.path("recording.csv") +
                                       "; did you mean 'y'?; it has q, y, F\n");
}

TEST_F(ReadExperiment, NamesTheFaultsOfEachRecording) {
  const auto recording = [](const std::string& feedback) {
    return "[[recording]]\nfile = \"recording.csv\"\naxis.X = { command = \"q\", feedback = \"" +
           feedback + "\" }\n";
  };
  const std::string found = faults(recording("yy") + recording("y") + recording("zz") + kMass);
  EXPECT_NE(found.find("recording[1].axis.X.feedback = \"yy\"; is not a channel"),
            std::string::npos)
      << found;
  EXPECT_NE(found.find("recording[3].axis.X.feedback = \"zz\"; is not a channel"),
            std::string::npos)
      << found;
  EXPECT_EQ(std::count(found.begin(), found.end(), '\n'), 2) << found;
}

TEST_F(ReadExperiment, RefusesUnitsOfAnotherQuantity) {
  const std::string other =
      "[[recording]]\nfile = \"recording.csv\"\naxis.X = { command = \"q\", "
      "feedback = \"F\" }\n";
  EXPECT_EQ(faults(other + kMass),
            "recording[1].axis.X.feedback = \"F\"; has the unit 'N' in the file, which is not a "
            "unit of length; write { channel = \"F\", unit = \"...\", factor = ... }\n");
}

TEST_F(ReadExperiment, RefusesAFeedbackOfTheWrongSign) {
  Record wrong = recorded(ramps(0.5), {small_axis(), small_loop()});
  for (double& y : wrong.feedback) y = -y;
  files_.write_recording(wrong);
  EXPECT_NE(faults(kMass).find("one of them has the wrong sign; set factor = -1"),
            std::string::npos);
}

TEST_F(ReadExperiment, RefusesAFeedbackInAnotherUnit) {
  Record wrong = recorded(ramps(0.5), {small_axis(), small_loop()});
  for (double& y : wrong.feedback) y *= 1000.0;
  files_.write_recording(wrong);
  EXPECT_NE(faults(kMass).find("one of them has the wrong unit"), std::string::npos);
}

TEST_F(ReadExperiment, RefusesARecordingWithoutMotion) {
  Record still = recorded(ramps(0.5), {small_axis(), small_loop()});
  still.feedback.assign(still.size(), 0.25);
  files_.write_recording(still);
  EXPECT_NE(faults(kMass).find("does not move: its feedback is 0.25 from 0 to 0.499 s; the "
                               "identification requires motion"),
            std::string::npos);
}

TEST_F(ReadExperiment, RefusesValidationAlone) {
  std::ofstream(files_.path("only.toml")) << R"(machine = "machine.toml"
[loop]
period_ms = 1.0
position_gain = "160 1/s"
velocity_gain = "8557 N s/m"
[[recording]]
file = "recording.csv"
use = "validation"
axis.X = { command = "q", feedback = "y" }
[[estimate]]
key = "axis.X.moving_mass"
)";
  EXPECT_EQ(fault_messages([&] { read_experiment(files_.path("only.toml")); }),
            "all recordings are for validation; none is left for estimation\n");
}

TEST_F(ReadExperiment, GapsAreLeftOutAndSaid) {
  const Record whole = recorded(ramps(0.5), {small_axis(), small_loop()});
  std::ofstream file(files_.path("recording.csv"));
  file << "time [s],q [m],y [m],F [N]\n";
  file.precision(17);
  for (std::size_t k = 0; k < whole.size(); ++k) {
    if (k > 200 && k < 230) continue;
    file << 1e-3 * static_cast<double>(k) << ',' << whole.command[k] << ',' << whole.feedback[k]
         << ',' << whole.force[k] << '\n';
  }
  file.close();
  const Experiment e = read_experiment(files_.write(kMass));
  ASSERT_EQ(e.records[0].record.omitted.size(), 1u);
  EXPECT_EQ(e.records[0].record.omitted[0].end - e.records[0].record.omitted[0].begin, 30u);
  ASSERT_EQ(e.records[0].notes.size(), 1u);
  EXPECT_NE(e.records[0].notes[0].find("gap at 0.2 s, excluded"), std::string::npos);
}

TEST_F(ReadExperiment, ClippedCurrentIsSaidWithItsChannelAndTime) {
  Record clipped = recorded(ramps(0.5), {small_axis(), small_loop()});
  for (double& force : clipped.force) force = std::clamp(force, -60.0, 60.0);
  files_.write_recording(clipped);
  const Experiment e = read_experiment(files_.write(kMass));
  ASSERT_FALSE(e.records[0].notes.empty());
  EXPECT_NE(e.records[0].notes[0].find("recording.csv: F is clipped at 60 in "), std::string::npos)
      << e.records[0].notes[0];
  EXPECT_NE(e.records[0].notes[0].find("first at time 0."), std::string::npos);
}

TEST_F(ReadExperiment, SlowRecordingsAreInterpolatedToTheLoop) {
  const Record whole = recorded(ramps(0.5), {small_axis(), small_loop()});
  Record slow = whole;
  slow.command.clear();
  slow.feedback.clear();
  slow.force.clear();
  for (std::size_t k = 0; k < whole.size(); k += 4) {
    slow.command.push_back(whole.command[k]);
    slow.feedback.push_back(whole.feedback[k]);
    slow.force.push_back(whole.force[k]);
  }
  slow.period = 4e-3;
  files_.write_recording(slow);
  const Experiment e = read_experiment(files_.write(kMass));
  EXPECT_EQ(e.records[0].record.size(), 497u);
  EXPECT_NE(e.records[0].notes.at(0).find("interpolated to the 1 ms of the loop"),
            std::string::npos);
}

}  // namespace
}  // namespace servomill::sim::identification::read_experiment_test
