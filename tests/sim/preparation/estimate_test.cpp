/// The cost of a run is known before it begins; a run that would not fit is refused.
#include "sim/preparation/estimate.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"
#include "sim/preparation/prepare_cases.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::preparation::estimate_test {
namespace {

constexpr const char* kProgram = "G21 G90 G94\nG1 X100 F1200\nM2\n";

model::Scenario scenario(const std::string& more = "") {
  return small_scenario(kProgram, "[record]\nperiod_ms = 1.0\n" + more +
                                      "[[case]]\nname = \"one\"\n[[case]]\nname = \"two\"\n");
}

// An hour of motion in each of two cases.
RunEstimate two_hours(const model::Scenario& of) {
  const std::vector<double> motions = {3599.9, 3599.9};  // s, and 0.1 s of settling
  return estimate(of, motions, 1);
}

template <class Refuse>
std::string refusal(const Refuse& refuse) {
  try {
    refuse();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(RunEstimate, CountsRowsAndTheirBytes) {
  const RunEstimate found = two_hours(scenario());
  EXPECT_NEAR(found.motion, 7200.0, 1e-9);
  EXPECT_NEAR(found.rows, 7.2e6, 1e-3);
  // 27 numbers of a row and 10 of each of the five axes of the machine, 8 bytes each
  EXPECT_NEAR(found.size, 7.2e6 * 77.0 * 8.0, 1.0);
}

// The rest is the program's and the system's.
TEST(RunEstimate, TakesFourFifthsOfTheMemoryAndNoMore) {
  const model::Scenario of = scenario();
  RunEstimate takes = two_hours(of);
  takes.memory = 8e9;
  EXPECT_EQ(refusal([&] { refuse_too_large(of, takes, 10.001e9); }), "");
  EXPECT_EQ(refusal([&] { refuse_too_large(of, takes, 9.999e9); }),
            "small.ngc: error: takes 2 h in 2 cases and 7.2e+06 rows: 8 GB of memory; must be <= "
            "the 8 GB available; run fewer cases, or record fewer rows: record.period_ms = 1");
}

TEST(RunEstimate, KeepsToTheSizeThatTheScenarioAllows) {
  const model::Scenario of = scenario();
  RunEstimate takes = two_hours(of);
  takes.size = of.record.max_size;
  EXPECT_EQ(refusal([&] { refuse_too_large(of, takes); }), "");
  takes.size *= 1.01;
  EXPECT_EQ(
      refusal([&] { refuse_too_large(of, takes); }),
      "small.ngc: error: takes 2 h in 2 cases and 7.2e+06 rows: 8.1 GB of signals; must be <= "
      "record.max_size_GB = 8; raise it, or record fewer rows: record.period_ms = 1");
}

// A recording is on the disk once more until the cases are compared.
TEST(RunEstimate, TakesTwiceTheFileOfTheDisk) {
  const model::Scenario of = scenario();
  RunEstimate takes = two_hours(of);
  takes.file = 1e9;
  EXPECT_EQ(refusal([&] { refuse_full_disk(of, takes, "out", kCopiesOfRun, 2.0e9); }), "");
  EXPECT_EQ(refusal([&] { refuse_full_disk(of, takes, "out", kCopiesOfRun, 1.99e9); }),
            "small.ngc: error: takes 2 GB of disk space while running; out has 2 GB free: lower "
            "record.max_size_GB = 8 or choose another file (--output)");
  EXPECT_EQ(refusal([&] { refuse_full_disk(of, takes, "out", 5.0, 4.9e9); }),
            "small.ngc: error: takes 5 GB of disk space while running; out has 4.9 GB free: lower "
            "record.max_size_GB = 8 or choose another file (--output)");
}

// 10^6 lines of 95 bytes, of which 32 MB stay in memory.
TEST(RunEstimate, PlansOfLongProgramsFindRoomForTemporaryFiles) {
  const model::Scenario of = scenario();
  EXPECT_EQ(refusal([&] { refuse_full_temporary_folder(of, 1'000'000, 63.1e6); }), "");
  EXPECT_EQ(refusal([&] { refuse_full_temporary_folder(of, 300'000, 0.0); }), "");
  const std::string folder = std::filesystem::temp_directory_path().string();
  EXPECT_EQ(refusal([&] { refuse_full_temporary_folder(of, 1'000'000, 62.9e6); }),
            "small.ngc: error: its planned motion takes about 0.063 GB of temporary files; " +
                folder + " has 0.063 GB free: choose another folder (TMPDIR)");
}

// 10^6 lines: 55 MB of text, and twice 72 MB of moves but 32 MB each. A text of 4 MB stays in
// memory.
TEST(RunEstimate, RewrittenProgramsFindRoomForTemporaryFiles) {
  const model::Scenario of = scenario();
  const auto refused = [&](std::size_t moves, double available) {
    return refusal([&] { refuse_full_temporary_folder_of_rewritten(of, moves, available); });
  };
  EXPECT_EQ(refused(1'000'000, 135.1e6), "");
  EXPECT_EQ(refused(50'000, 0.0), "");
  EXPECT_EQ(refused(100'000, 5.6e6), "");
  const std::string folder = std::filesystem::temp_directory_path().string();
  EXPECT_EQ(refused(1'000'000, 134.9e6),
            "small.ngc: error: its rewritten program takes at least about 0.14 GB of temporary "
            "files; " +
                folder + " has 0.13 GB free: choose another folder (TMPDIR)");
}

TEST(RunEstimate, TellsOfTemporaryFiles) {
  RunEstimate takes = two_hours(scenario());
  EXPECT_EQ(to_string(takes).find("temporary"), std::string::npos);
  takes = {.memory = 1e8, .temporary = 2e9, .computing = 36.0};
  EXPECT_TRUE(is_worth_telling(takes));
  EXPECT_EQ(to_string(takes),
            "0 s of motion, 0 rows, 0 GB of signals in a file of 0 GB, 0.1 GB of memory, 2 GB of "
            "temporary files (TMPDIR), about 36 s of computing");
}

// Eight runs in lockstep take the time of one: 24 points of two cases are six times as many runs.
TEST(RunEstimate, OfPointsCountsRunsInLockstepOnce) {
  const model::Scenario of = scenario();
  const RunEstimate one = estimate(of, prepare_cases(of), 1);
  EXPECT_EQ(one.lanes, 2);
  EXPECT_NEAR(one.computing, one.lockstep, 1e-12);  // no teeth, no trial runs
  EXPECT_NEAR(estimate_of_points(one, 1, 1).computing, one.lockstep / 2.0, 1e-12);
  EXPECT_NEAR(estimate_of_points(one, 4, 1).computing, one.lockstep / 2.0, 1e-12);
  EXPECT_NEAR(estimate_of_points(one, 24, 1).computing, 6.0 * one.lockstep / 2.0, 1e-12);
  EXPECT_NEAR(estimate_of_points(one, 24, 1).motion, 24.0 * one.motion, 1e-9);
  EXPECT_EQ(estimate_of_points(one, 0, 1).computing, 0.0);
}

// Teeth and trial runs are of each run alone.
TEST(RunEstimate, OfPointsCountsAllElseAtEachPoint) {
  const RunEstimate one = {.computing = 10.0, .lockstep = 8.0, .lanes = 2};
  EXPECT_NEAR(estimate_of_points(one, 8, 1).computing, 8.0 * (2.0 + 8.0 / 8.0), 1e-12);
}

// The path of the cutters is held as far as it comes near probes.
TEST(RunEstimate, MemoryOfAProbedPartDoesNotGrowWithTheDuration) {
  const model::Scenario of = small_scenario(
      "T1 M6\nG43 H1\nG1 X100 F1200\nM2\n",
      "[record]\nperiod_ms = 1.0\n[[program.tool]]\nnumber = 1\nlength_mm = 110.0\ndiameter_mm = "
      "8.0\n[[probe]]\nname = \"top\"\nline = { from_mm = [0.0, 0.0, 0.0], to_mm = [100.0, 0.0, "
      "0.0], normal = [0, 0, 1], points = 3 }\n[[case]]\nname = \"one\"\n");
  const std::vector<double> half = {1800.0}, nine_times = {16200.0};
  const double least = estimate(of, half, 1).memory, most = estimate(of, nine_times, 1).memory;
  EXPECT_NEAR(most, least, 0.01 * least);
}

// Steps of teeth that regenerate take ten times as long, and twice the motion twice the steps.
TEST(RunEstimate, CountsTheStepsOfTeethAndOfTheirRegeneration) {
  const auto of = [](const std::vector<std::string>& changes) {
    const model::Scenario scenario =
        input::read_scenario(SERVOMILL_SOURCE_DIR "/scenarios/parts/chatter.toml", changes);
    return estimate(scenario, prepare_untaught(scenario), 1);
  };
  const RunEstimate average =
      of({"cutting.force=average", "cutting.regeneration=false", "cmm.tooth_marks=false"});
  const RunEstimate teeth = of({"cutting.regeneration=false", "cutting.steps_per_tooth=50"});
  const RunEstimate regenerated = of({"cutting.steps_per_tooth=50"});
  const double of_teeth = teeth.computing - average.computing;
  const double of_both = regenerated.computing - average.computing;
  EXPECT_GT(of_teeth, 0.1 * average.computing);
  EXPECT_NEAR(of_both, 10.0 * of_teeth, 1e-6 * of_both);
  const RunEstimate slow = of({"cutting.steps_per_tooth=50", "program.feed_override=0.5"});
  EXPECT_NEAR(slow.computing / slow.motion, regenerated.computing / regenerated.motion,
              0.02 * slow.computing / slow.motion);
}

}  // namespace
}  // namespace servomill::sim::preparation::estimate_test
