/// Iterative learning control from recordings of an actual machine: here of a simulated one, so
/// that the offset is known that learning from its runs gives.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "plant/vocabulary/units.h"
#include "sim/model/scenario.h"
#include "sim/records/input_file.h"
#include "sim/run/run_output.h"
#include "sim/run/store.h"
#include "strategies/path_offset.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::recorded_learning_test {
namespace {

namespace fs = std::filesystem;

// A corner, a way back over the same points and a dwell, of lagging axes: 50 mm/s.
const std::string kProgram =
    "G17 G21 G90 G94 G64 P0.01\nG4 P0.3\nG1 X30 F3000\nG1 X10\nG4 P0.2\nG1 Y20\nG4 P0.3\nM30\n";
const std::string kLagging =
    "[machine_override.nc]\nvelocity_feed_forward = 0.9\nacceleration_feed_forward = 0.0\n";
const std::string kEveryPeriod = "[record]\nperiod_ms = 0.2\nresolution_nm = 0.0\n";
const std::string kPlain = "[[case]]\nname = \"plain\"\n";

std::string learning(const std::string& name, const std::string& keys) {
  return fmt::format(
      "[[case]]\nname = \"{}\"\n[[case.strategy]]\ntype = \"learning\"\ncutoff_Hz = 60.0\n{}", name,
      keys);
}

class RecordedLearning : public testing::Test {
 protected:
  RecordedLearning() : folder_(fs::path(testing::TempDir()) / fmt::format("rec_{}", ::getpid())) {
    fs::create_directories(folder_);
  }
  ~RecordedLearning() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  // [[case.strategy.recording]] of a result file.
  std::string recording(const std::string& name, const std::string& one) const {
    return fmt::format("[[case.strategy.recording]]\nfile = \"{}\"\ncase = \"{}\"\n", path(name),
                       one);
  }

  CaseOutput run(const std::string& cases, const std::string& name,
                 const std::string& program = kProgram) const {
    return run_named_case(small_scenario(program, kLagging + kEveryPeriod + cases), name);
  }

  // Runs a case and keeps its result file.
  CaseOutput kept(const std::string& cases, const std::string& name,
                  const std::string& file) const {
    const model::Scenario scenario = small_scenario(kProgram, kLagging + kEveryPeriod + cases);
    CaseOutput out = run_named_case(scenario, name);
    RunStore store(path(file), true, scenario);
    store.add(out);
    store.commit({});
    return out;
  }

  // The positions of a run as a control might export them: from `begin` (s) on its own clock, every
  // so many rows, rounded to 0.1 um.
  void export_csv(
      const CaseOutput& one, const std::string& file, double begin, std::size_t every,
      const std::string& unit = " [mm]",
      const std::function<bool(double)>& is_kept = [](double) { return true; }) const {
    std::ofstream out(path(file));
    out << fmt::format("time [s];x soll{0};x ist{0};y soll{0};y ist{0}\n", unit);
    const records::Series& servo = one.result.servo;
    const auto column = [&](const char* name, char axis) { return *servo.column(name, axis); };
    const std::size_t columns[] = {column("ref_linear", 'X'), column("meas_linear", 'X'),
                                   column("ref_linear", 'Y'), column("meas_linear", 'Y')};
    for (std::size_t n = 0; n < servo.rows(); n += every) {
      const double t = servo.at(n, *servo.column("time"));
      if (!is_kept(t)) continue;
      out << fmt::format("{:.6f}", begin + t);
      for (const std::size_t c : columns) out << fmt::format(";{:.4f}", servo.at(n, c));
      out << "\n";
    }
  }
  // The tip as a grid encoder of X and Y reads it, in coordinates of its own.
  void export_grid(const CaseOutput& one, const std::string& file) const {
    std::ofstream out(path(file));
    out << "time [s];x soll [mm];y soll [mm];grid x [mm];grid y [mm]\n";
    const records::Series& servo = one.result.servo;
    const auto value = [&](std::size_t n, const char* name, char axis) {
      return servo.at(n, *servo.column(name, axis));
    };
    for (std::size_t n = 0; n < servo.rows(); ++n) {
      out << fmt::format("{:.6f};{:.6f};{:.6f};{:.6f};{:.6f}\n", servo.at(n, *servo.column("time")),
                         value(n, "ref_linear", 'X'), value(n, "ref_linear", 'Y'),
                         777.0 + value(n, "tool_position_true", 'X'),
                         -31.5 + value(n, "tool_position_true", 'Y'));
    }
  }
  std::string grid(const std::string& file) const {
    return fmt::format(
        "[[case.strategy.recording]]\nfile = \"{}\"\nsees = \"tip\"\n"
        "measured = {{ X = \"grid x\", Y = \"grid y\" }}\n"
        "reference = {{ X = \"x soll\", Y = \"y soll\" }}\n",
        path(file));
  }
  std::string csv(const std::string& file) const {
    return fmt::format(
        "[[case.strategy.recording]]\nfile = \"{}\"\nmeasured = {{ X = \"x ist\", Y = \"y ist\" "
        "}}\n"
        "reference = {{ X = \"x soll\", Y = \"y soll\" }}\n",
        path(file));
  }

  // Refusal of a case that learns from recordings, without folders.
  std::string refusal(const std::string& keys, const std::string& program = kProgram) const {
    try {
      const model::Scenario scenario =
          small_scenario(program, kLagging + kEveryPeriod + learning("one", keys));
      preparation::PreparedCase prepared(scenario, scenario.cases.front());
      prepared.teach();
    } catch (const InputError& error) {
      std::string text = error.what();
      for (const std::string& folder :
           {folder_.string() + "/", std::string(SERVOMILL_SOURCE_DIR "/scenarios/")}) {
        for (std::size_t at = text.find(folder); at != std::string::npos; at = text.find(folder)) {
          text.erase(at, folder.size());
        }
      }
      return text;
    }
    return "accepted";
  }

  fs::path folder_;
};

// Largest difference of two offsets (m), row by row.
double difference(const LearntRuns& a, const LearntRuns& b) {
  const auto &x = a.lesson.offset->offset, &y = b.lesson.offset->offset;
  EXPECT_EQ(x.size(), y.size());
  double out = 0.0;
  for (std::size_t n = 0; n < std::min(x.size(), y.size()); ++n) {
    out = std::max(out, (x[n] - y[n]).cwiseAbs().maxCoeff());
  }
  return out;
}

double largest(const LearntRuns& a) {
  double out = 0.0;
  for (const Joints& one : a.lesson.offset->offset) out = std::max(out, one.cwiseAbs().maxCoeff());
  return out;
}

const std::string kScales = "sees = \"scales\"\nlimits = \"ignore\"\n";

TEST_F(RecordedLearning, GivesTheOffsetThatTheSameRunGivesWhenItIsSimulated) {
  kept(kPlain, "plain", "run_1.h5");
  const CaseOutput simulated = run(learning("one", kScales + "updates = 1\n"), "one");
  const CaseOutput recorded =
      run(learning("one", "limits = \"ignore\"\n" + recording("run_1.h5", "plain")), "one");
  ASSERT_EQ(recorded.learnt[0].lesson.trials.size(), 1U);
  EXPECT_GT(largest(simulated.learnt[0]), 20 * um);
  EXPECT_LT(difference(simulated.learnt[0], recorded.learnt[0]), 0.02 * um);
  EXPECT_NEAR(recorded.learnt[0].lesson.trials[0].rms, simulated.learnt[0].lesson.trials[0].rms,
              0.01 * um);
}

// The structure gives way to acceleration, which no scale sees.
const std::string kGivesWay =
    "[machine_override.inertial_deflection]\nXX = { gain_um_per_m_s2 = 2.0, frequency_Hz = 48.0, "
    "damping = 0.04 }\n";

TEST_F(RecordedLearning, OfATipGivesTheOffsetOfSimulatedRunsThatSeeIt) {
  kept(kGivesWay + kPlain, "plain", "run_1.h5");
  export_grid(run(kGivesWay + kPlain, "plain"), "grid.csv");
  const std::string tip = "sees = \"tip\"\nlimits = \"ignore\"\nupdates = 1\n";
  const CaseOutput simulated = run(kGivesWay + learning("one", tip), "one");
  const CaseOutput by_scales = run(
      kGivesWay + learning("one", "limits = \"ignore\"\n" + recording("run_1.h5", "plain")), "one");
  const CaseOutput from_file =
      run(kGivesWay + learning("one", "limits = \"ignore\"\n" + recording("run_1.h5", "plain") +
                                          "sees = \"tip\"\n"),
          "one");
  const CaseOutput from_grid =
      run(kGivesWay + learning("one", "limits = \"ignore\"\n" + grid("grid.csv")), "one");
  EXPECT_GT(difference(simulated.learnt[0], by_scales.learnt[0]), 1.0 * um);
  EXPECT_LT(difference(simulated.learnt[0], from_file.learnt[0]), 0.02 * um);
  EXPECT_LT(difference(simulated.learnt[0], from_grid.learnt[0]), 0.03 * um);
  EXPECT_EQ(std::count(from_grid.notes.begin(), from_grid.notes.end(),
                       "case one: strategy learning: axis Z is not recorded and gets no offset"),
            1);
}

TEST_F(RecordedLearning, OfATipNamesWhatItLacks) {
  const auto with = [&](const std::string& channels) {
    return refusal("[[case.strategy.recording]]\nfile = \"grid.csv\"\nsees = \"tip\"\n" + channels);
  };
  EXPECT_EQ(with("measured = { B = \"b\" }\nreference = { X = \"x soll\" }\n"),
            "small.toml:16:12: error: case[0].strategy[0].recording[0].measured = {...}; of a tip "
            "must name channels of X, Y or Z");
  EXPECT_EQ(with("measured = { X = \"grid x\" }\nreference = {}\n"),
            "small.toml:17:13: error: case[0].strategy[0].recording[0].reference = {...}; must "
            "name the channels of the axes that move");
  const std::string mixed = refusal(grid("grid.csv") + csv("run.csv"));
  EXPECT_NE(mixed.find("must see the same in all recordings: scales, tip or part"),
            std::string::npos)
      << mixed;
}

// Recordings need no trial runs, and are learnt from where cases are run as a user runs them.
TEST_F(RecordedLearning, TakesPlaceInARunOfTheScenario) {
  kept(kPlain, "plain", "run_1.h5");
  const model::Scenario scenario = small_scenario(
      kProgram, kLagging + kEveryPeriod + kPlain +
                    learning("one", "limits = \"ignore\"\n" + recording("run_1.h5", "plain")));
  const RunOutput all = run_scenario(scenario, {});
  ASSERT_EQ(all.cases.size(), 2U);
  ASSERT_EQ(all.cases[1].learnt.size(), 1U);
  EXPECT_EQ(all.cases[1].learnt[0].lesson.trials.size(), 1U);
  EXPECT_GT(largest(all.cases[1].learnt[0]), 20 * um);
  EXPECT_EQ(check_scenario(scenario).trial_runs, 0);
}

// The second run is made with the offset that the first has taught.
TEST_F(RecordedLearning, GoesOnFromRunToRun) {
  const std::string from = "limits = \"ignore\"\n";
  kept(kPlain, "plain", "run_1.h5");
  kept(learning("one", from + recording("run_1.h5", "plain")), "one", "run_2.h5");
  const CaseOutput recorded = run(
      learning("two", from + recording("run_1.h5", "plain") + recording("run_2.h5", "one")), "two");
  const CaseOutput simulated = run(learning("two", kScales + "updates = 2\n"), "two");
  const auto &runs = recorded.learnt[0].lesson.trials, &wanted = simulated.learnt[0].lesson.trials;
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_LT(runs[1].rms, 0.2 * runs[0].rms) << "the offset acts";
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(runs[k].rms, wanted[k].rms, 0.05 * um) << k;
  EXPECT_LT(difference(simulated.learnt[0], recorded.learnt[0]), 0.1 * um);
}

// Another clock, another sampling, rounded, longer dwells and a longer standstill around it.
TEST_F(RecordedLearning, TakesRecordingsOfAnyClock) {
  const CaseOutput plain = run(kPlain, "plain");
  export_csv(plain, "run.csv", 17.25, 5);
  const CaseOutput simulated = run(learning("one", kScales + "updates = 1\n"), "one");
  const CaseOutput recorded = run(learning("one", "limits = \"ignore\"\n" + csv("run.csv")), "one");
  EXPECT_LT(difference(simulated.learnt[0], recorded.learnt[0]), 1.0 * um);
  EXPECT_EQ(std::count(recorded.notes.begin(), recorded.notes.end(),
                       "case one: strategy learning: axis Z is not recorded and gets no offset"),
            1);
  for (const Joints& row : recorded.learnt[0].lesson.offset->offset) ASSERT_EQ(row[2], 0.0);
}

TEST_F(RecordedLearning, OfAnotherDwellIsFoundBehindIt) {
  std::string longer = kProgram;
  longer.replace(longer.find("G4 P0.2"), 7, "G4 P0.7");
  export_csv(run(kPlain, "plain", longer), "longer.csv", 0.0, 5);
  const CaseOutput simulated = run(learning("one", kScales + "updates = 1\n"), "one");
  const CaseOutput recorded =
      run(learning("one", "limits = \"ignore\"\n" + csv("longer.csv")), "one");
  EXPECT_LT(difference(simulated.learnt[0], recorded.learnt[0]), 1.5 * um);
}

TEST_F(RecordedLearning, KeepsTheOffsetForTheUser) {
  kept(kPlain, "plain", "run_1.h5");
  const CaseOutput one =
      kept(learning("one", "limits = \"ignore\"\n" + recording("run_1.h5", "plain")), "one",
           "update.h5");
  const records::InputFile file(path("update.h5"));
  const std::string group = "/cases/one/learnt/learning/offset";
  const std::vector<double> time = file.values(group + "/time"), s = file.values(group + "/s"),
                            linear = file.values(group + "/linear");
  const strategies::PathOffset& offset = *one.learnt[0].lesson.offset;
  ASSERT_EQ(time.size(), offset.offset.size());
  ASSERT_EQ(linear.size(), 3 * time.size());
  for (std::size_t n = 0; n < time.size(); n += 7) {
    const double instant = static_cast<double>(n * offset.times->every);
    EXPECT_NEAR(time[n], instant * 0.2 * ms, 1e-12);
    EXPECT_NEAR(linear[3 * n] * um, offset.at(instant)[0], 1e-12);
  }
  EXPECT_NEAR(s.back(), 70.0, 0.1) << "30 mm, 20 mm and 20 mm, corners rounded";
  EXPECT_EQ(file.text(group + "/linear", "units"), "um");
}

TEST_F(RecordedLearning, RefusesARecordingOfAnotherProgram) {
  const CaseOutput plain = run(kPlain, "plain");
  export_csv(plain, "run.csv", 0.0, 5);
  std::string other = kProgram;
  other.replace(other.find("X30"), 3, "X31");
  EXPECT_TRUE(refusal(csv("run.csv"), other)
                  .starts_with("run.csv: error: is not a recording of small.ngc: at "))
      << refusal(csv("run.csv"), other);
}

TEST_F(RecordedLearning, RefusesARecordingAtAnotherFeed) {
  std::string faster = kProgram;
  faster.replace(faster.find("F3000"), 5, "F3600");
  export_csv(run(kPlain, "plain", faster), "fast.csv", 0.0, 5);
  const std::string text = refusal(csv("fast.csv"));
  EXPECT_TRUE(text.starts_with(
      "fast.csv: error: was made at a different feed rate: its feed motion takes "))
      << text;
  EXPECT_TRUE(text.ends_with("; set feed_share")) << text;
}

TEST_F(RecordedLearning, RefusesWhatIsNotWhole) {
  const CaseOutput plain = run(kPlain, "plain");
  export_csv(plain, "end.csv", 0.0, 5, " [mm]", [](double t) { return t < 1.2; });
  EXPECT_TRUE(refusal(csv("end.csv")).starts_with("end.csv: error: ends in line "))
      << refusal(csv("end.csv"));
  export_csv(plain, "begin.csv", 0.0, 5, " [mm]", [](double t) { return t > 0.6; });
  EXPECT_EQ(refusal(csv("begin.csv")),
            "begin.csv: error: begins after the program: it must begin at its start");
  export_csv(plain, "slow.csv", 0.0, 40);
  EXPECT_EQ(refusal(csv("slow.csv")),
            "slow.csv: error: has a sampling period of 8 ms; cutoff_Hz = 60 requires 4.167 ms");
}

TEST_F(RecordedLearning, RefusesWhatIsNotKnown) {
  const CaseOutput plain = run(kPlain, "plain");
  export_csv(plain, "run.csv", 0.0, 5);
  export_csv(plain, "bare.csv", 0.0, 5, "");
  EXPECT_EQ(refusal(csv("bare.csv")),
            "bare.csv: error: channel 'x ist' has no unit: name it 'x ist [mm]' in the file");
  const std::string only_x = fmt::format(
      "[[case.strategy.recording]]\nfile = \"{}\"\nmeasured = {{ X = \"x ist\" }}\nreference = {{ "
      "X "
      "= \"x soll\" }}\n",
      path("run.csv"));
  EXPECT_EQ(refusal(only_x), "run.csv: error: axis Y moves in small.ngc and is not recorded");
  std::string none = csv("run.csv");
  none.replace(none.find("y ist"), 5, "y isd");
  EXPECT_NE(refusal(none).find("y isd"), std::string::npos) << refusal(none);
}

TEST_F(RecordedLearning, RefusesKeysThatRecordingsStandFor) {
  export_csv(run(kPlain, "plain"), "run.csv", 0.0, 5);
  EXPECT_EQ(refusal("updates = 3\n" + csv("run.csv")),
            "small.toml:13:11: error: case[0].strategy[0].updates = 3; is not used with "
            "[[case.strategy.recording]]: the recordings are the runs");
  EXPECT_EQ(refusal("limits = \"slow\"\n" + csv("run.csv")),
            "small.toml:13:10: error: case one: strategy learning: limits = \"slow\" plans a path "
            "different from the recorded one");
  EXPECT_EQ(refusal("[[case.strategy.recording]]\nfile = \"a.csv\"\nmeasured = { X = \"a\" }\n"
                    "reference = { Y = \"b\" }\n"),
            "small.toml:16:13: error: case[0].strategy[0].recording[0].reference = {...}; "
            "must name a channel for the axes of 'measured', at least one");
}

}  // namespace
}  // namespace servomill::sim::run::recorded_learning_test
