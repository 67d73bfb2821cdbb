// Result files of a run: what a kill leaves, and what comes back.

#include "sim/run/store.h"

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <unistd.h>

#include <fstream>

#include "sim/model/scenario.h"
#include "sim/records/input_file.h"
#include "sim/records/series_spool.h"
#include "sim/run/stored_run.h"
#include "sim/system/system_error.h"
#include "tests/sim/records/file_snapshots.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::store_test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "G1 X1 F1000\nM2\n";
constexpr std::size_t kHeld = 8;  // what the head of a group holds unless it has room for more
constexpr std::size_t kCases = kHeld + 2;

class RunFile : public testing::Test {
 protected:
  RunFile() : folder_(fs::path(testing::TempDir()) / ("run_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~RunFile() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return folder_ / name; }

  fs::path folder_;
};

model::Scenario scenario() {
  std::string cases;
  for (std::size_t i = 0; i < kCases; ++i) {
    cases += "[[case]]\nname = \"case" + std::to_string(i) + "\"\n";
  }
  return small_scenario(kProgram, cases);
}

// Signals that tell their case and their row.
CaseOutput output(std::size_t number) {
  constexpr std::size_t kRows = 40;
  CaseOutput out;
  out.name = "case" + std::to_string(number);
  out.sections = {""};
  out.duration = static_cast<double>(number);
  out.result.servo = records::Series({{"time", "s", "time", "", ""},
                                      {"s", "mm", "arc length", "", ""},
                                      {"rapid", "1", "rapid", "", ""},
                                      {"section", "1", "section", "", ""},
                                      {"true_linear", "mm", "position", "XYZ", "axis_linear"}});
  for (std::size_t n = 0; n < kRows; ++n) {
    std::vector<double> row(out.result.servo.width());
    for (std::size_t c = 0; c < row.size(); ++c) {
      row[c] = static_cast<double>(1000 * number + 10 * n + c);
    }
    out.result.servo.append(row);
  }
  return out;
}

// The same, of which all cases have the rows of the first but for one signal: the others are stored
// once.
CaseOutput output_of_shared(std::size_t number) {
  CaseOutput out = output(0);
  out.name = "case" + std::to_string(number);
  out.duration = static_cast<double>(number);
  std::vector<double> rows = out.result.servo.by_rows();
  for (std::size_t i = 0; i < rows.size(); i += out.result.servo.width()) {
    rows[i + *out.result.servo.column("true_linear", 'Y')] = static_cast<double>(number);
  }
  out.result.servo = records::Series(out.result.servo.signals());
  out.result.servo.append(rows);
  return out;
}

class KilledRunFile : public RunFile {
 protected:
  // Kills the run at each write: a complete case is there.
  void expect_complete_cases(CaseOutput (*output)(std::size_t)) {
    const model::Scenario described = scenario();
    std::atomic<std::size_t> complete = 0;
    RunStore store(path("out.h5"), false, described);
    records::FileSnapshots snapshots(store.partial_path(), folder_ / "snapshots", complete);
    for (std::size_t i = 0; i < kCases; ++i) {
      store.add(output(i));
      ++complete;
    }
    store.commit({});
    EXPECT_GT(snapshots.all().size(), 10 * kCases);
    for (const records::FileSnapshots::Snapshot& left : snapshots.all()) {
      // the first cases, and those around the number that a group holds at its head by itself
      if (left.promised >= 2 && left.promised < kHeld) continue;
      SCOPED_TRACE(left.path);
      const StoredRun run = read_run(left.path);
      ASSERT_GE(run.cases.size(), left.promised);
      ASSERT_LE(run.cases.size(), left.promised + 1);
      for (std::size_t i = 0; i < run.cases.size(); ++i) {
        const CaseOutput wanted = output(i);
        EXPECT_EQ(run.cases[i].name, wanted.name);
        EXPECT_EQ(run.cases[i].duration, wanted.duration);
        EXPECT_EQ(run.cases[i].servo->by_rows(), wanted.result.servo.by_rows());
      }
    }
  }
};

TEST_F(KilledRunFile, HasEveryCompleteCase) { expect_complete_cases(output); }

TEST_F(KilledRunFile, HasEveryCompleteCaseOfWhichSignalsAreShared) {
  expect_complete_cases(output_of_shared);
}

std::string bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST_F(RunFile, IsSmallerWhereCasesShareSignals) {
  const model::Scenario described = scenario();
  const auto size_of = [&](CaseOutput (*output_of)(std::size_t), const std::string& name) {
    RunStore store(path(name), false, described);
    for (std::size_t i = 0; i < 3; ++i) store.add(output_of(i));
    store.commit({});
    return bytes(path(name)).size();
  };
  EXPECT_LT(size_of(output_of_shared, "shared.h5"), size_of(output, "own.h5"));
}

TEST_F(RunFile, IsTheSameForTheSameCases) {
  const model::Scenario described = scenario();
  for (const std::string name : {"a.h5", "b.h5"}) {
    RunStore store(path(name), false, described);
    for (std::size_t i = 0; i < 3; ++i) store.add(output(i));
    store.commit({});
    if (name == "a.h5") sleep(1);  // the second is no part of it
  }
  EXPECT_EQ(bytes(path("a.h5")), bytes(path("b.h5")));
  EXPECT_GT(bytes(path("a.h5")).size(), 1000U);
}

TEST_F(RunFile, HasEveryCompleteCaseWhereTheDiskIsFull) {
  const std::string disk = path("disk");
  fs::create_directory(disk);
  if (mount("none", disk.c_str(), "tmpfs", 0, "size=128k") != 0) {
    GTEST_SKIP() << "only root can mount a small disk";
  }
  std::size_t complete = 0;
  {
    const model::Scenario described = scenario();
    RunStore store(disk + "/out.h5", false, described);
    try {
      for (; complete < kCases; ++complete) store.add(output(complete));
    } catch (const system::SystemError& error) {
      EXPECT_NE(std::string(error.what()).find("No space left on device"), std::string::npos);
    }
  }
  EXPECT_GT(complete, 0U);
  EXPECT_LT(complete, kCases);
  {
    const StoredRun run = read_run(disk + "/out.h5.partial");
    ASSERT_GE(run.cases.size(), complete);
    for (std::size_t i = 0; i < complete; ++i) {
      EXPECT_EQ(run.cases[i].servo->by_rows(), output(i).result.servo.by_rows()) << i;
    }
  }
  EXPECT_EQ(umount(disk.c_str()), 0);
}

TEST_F(RunFile, TakesRowsFromTheDiskAsTheyAre) {
  const model::Scenario described = scenario();
  const CaseOutput in_memory = output(0);
  const records::Series& servo = in_memory.result.servo;
  auto spool = std::make_shared<records::SeriesSpool>(
      servo.signals(), records::SpoolFormat{folder_, {16, described.record.compression}});
  spool->append(servo.by_rows());
  spool->finish();
  CaseOutput on_disk = in_memory;
  on_disk.result.servo = records::Series(servo.signals(), std::move(spool));
  RunStore store(path("out.h5"), false, described);
  store.add(on_disk);
  store.commit({});
  EXPECT_EQ(read_run(path("out.h5")).cases.at(0).servo->by_rows(), servo.by_rows());
}

TEST_F(RunFile, SpeaksNotOfUnfinishedCasesWhenItIsComplete) {
  const model::Scenario described = scenario();
  RunStore store(path("out.h5"), false, described);
  store.add(output(0));
  fs::copy_file(store.partial_path(), path("before.h5"));
  EXPECT_TRUE(records::InputFile(path("before.h5")).has("/unfinished"));
  store.commit({});
  EXPECT_FALSE(records::InputFile(path("out.h5")).has("/unfinished"));
}

// Errors of a machine whose X lies far from its zero, and whose Y has no travel.
TEST_F(RunFile, HasErrorsOverAllOfTheTravelAndLocationErrors) {
  const model::Scenario far =
      small_scenario("G1 Z1 F1000\nM2\n",
                     "machine_errors = \"true\"\n"
                     "[machine_override.axis.X]\ntravel_mm = [600.0, 3400.0]\n"
                     "[machine_override.axis.C]\ntravel_deg = [-3600.0, 3600.0]\n"
                     "[errors.true]\nEXX = { um_per_m = 10.0 }\nECC = { constant_urad = 5.0 }\n"
                     "EC0Y = { um_per_m = 50.0 }\nEX0C = \"-3 um\"\n"
                     "[errors.square]\nEB0Z = { um_per_m = 20.0 }\n"
                     "[program.start]\nX_mm = 700.0\n[[case]]\nname = \"one\"\n");
  RunStore store(path("out.h5"), false, far);
  store.commit({});
  const records::InputFile file(path("out.h5"));
  const auto x = file.values("/errors/true/X/position"), exx = file.values("/errors/true/X/EXX");
  ASSERT_EQ(x.size(), exx.size());
  EXPECT_EQ(x.size(), 5601U) << "a place each 0.5 mm";
  EXPECT_DOUBLE_EQ(x.front(), 600.0);
  EXPECT_DOUBLE_EQ(x.back(), 3400.0);
  EXPECT_NEAR(exx.front(), 6.0, 1e-9);
  EXPECT_NEAR(exx.back(), 34.0, 1e-9);
  const auto c = file.values("/errors/true/C/position");
  EXPECT_NEAR(c.front(), -180.0, 1e-9);
  EXPECT_NEAR(c.back(), 180.0, 1e-9);
  EXPECT_NEAR(file.values("/errors/true/locations/EC0Y").at(0), 50.0, 1e-9);
  EXPECT_EQ(file.text("/errors/true/locations/EC0Y", "units"), "urad");
  EXPECT_NEAR(file.values("/errors/true/locations/EX0C").at(0), -3.0, 1e-9);
  EXPECT_EQ(file.text("/errors/true/locations/EX0C", "units"), "um");
  EXPECT_NEAR(file.values("/errors/square/locations/EB0Z").at(0), 20.0, 1e-9);
}

}  // namespace
}  // namespace servomill::sim::run::store_test
