#include "sim/engine/recorder.h"

#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>

#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/case_program.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::engine::recorder_test {
namespace {

// Several blocks of the recorder and a rest.
constexpr std::size_t kRows = 2500;

class Recording : public testing::Test {
 protected:
  Recording()
      : scenario_(small_scenario("G1 X10 Y5 F1000\nG1 X20\nM2\n", "[[case]]\nname = \"one\"\n")),
        moves_(preparation::read_program(scenario_, scenario_.cases.front()).all()),
        path_(moves_, AxisWords::Zero()),
        truth_(scenario_.machine.chain, {}) {
    boost::random::mt19937 random(1);
    const boost::random::uniform_real_distribution<double> any(-0.1, 0.1);
    std::size_t piece = 0;
    for (std::size_t n = 0; n < kRows; ++n) {
      Snapshot now;
      now.time = 1e-3 * static_cast<double>(n);
      now.s = path_.length() * static_cast<double>(n) / kRows;
      while (now.s > path_.piece(piece).s_end) ++piece;
      now.piece = piece;
      for (Joints* Q : {&now.Q_ref, &now.Q_cmd, &now.Q_fb, &now.Q_meas, &now.Q_true, &now.dQ_true,
                        &now.current, &now.torque}) {
        for (int j = 0; j < kJoints; ++j) (*Q)[j] = any(random);
      }
      snapshots_.push_back(now);
    }
  }
  records::Series record(const model::RecordFormat& format = {},
                         const records::RowKeeping& keeping = {},
                         const RunOutputs& outputs = {}) const {
    Recorder recorder(scenario_.machine, truth_, nullptr, path_, tips_, format, false, {}, false,
                      keeping, false, false, {}, outputs);
    recorder.expect(kRows);
    for (const Snapshot& now : snapshots_) recorder.record(now);
    return recorder.take();
  }

  const model::Scenario scenario_;
  const std::vector<Move> moves_;
  const ProgramPath path_;
  const plant::VolumetricModel truth_;
  const std::map<int, Eigen::Vector3d> tips_;
  std::vector<Snapshot> snapshots_;
};

TEST_F(Recording, IsTheSameInMemoryAndOnTheDisk) {
  const records::Series in_memory = record();
  const records::Series on_disk = record({}, {.folder = testing::TempDir(), .most_in_memory = 0.0});
  EXPECT_EQ(in_memory.pages(), nullptr);
  ASSERT_NE(on_disk.pages(), nullptr);
  ASSERT_EQ(on_disk.rows(), kRows);
  for (std::size_t row = 0; row < kRows; ++row) {
    for (std::size_t c = 0; c < in_memory.width(); ++c) {
      ASSERT_EQ(on_disk.at(row, c), in_memory.at(row, c));
    }
  }
}

TEST_F(Recording, HasARowForEverySnapshotInOrder) {
  const records::Series series = record();
  ASSERT_EQ(series.rows(), kRows);
  const std::size_t x = *series.column("true_linear", 'X');
  const std::size_t error = *series.column("following_error_linear", 'Y');
  const std::size_t current = *series.column("current_linear", 'Z');
  for (std::size_t n = 0; n < kRows; ++n) {
    const Snapshot& now = snapshots_[n];
    EXPECT_EQ(series.at(n, *series.column("time")), now.time);
    EXPECT_EQ(series.at(n, *series.column("s")), now.s / mm);
    EXPECT_EQ(series.at(n, x), now.Q_true[0] / mm);
    EXPECT_EQ(series.at(n, error), (now.Q_cmd[1] - now.Q_fb[1]) / um);
    EXPECT_EQ(series.at(n, current), now.current[2]);
  }
}

TEST_F(Recording, OfSomeSignalsHasTheirBits) {
  const records::Series whole = record();
  const records::Series some = record(
      {}, {}, {.signals = {{"contour_error", "velocity_linear"}}, .makes_rows_beside = false});
  std::vector<std::string> names;
  for (const records::Signal& signal : some.signals()) {
    names.push_back(signal.name);
    const records::Signal& same = *whole.find(signal.name);
    ASSERT_EQ(signal.columns(), same.columns());
    for (std::size_t n = 0; n < kRows; ++n) {
      for (std::size_t c = 0; c < signal.columns(); ++c) {
        ASSERT_EQ(some.at(n, signal.offset + c), whole.at(n, same.offset + c)) << signal.name;
      }
    }
  }
  EXPECT_EQ(names, (std::vector<std::string>{"time", "s", "line", "section", "rapid",
                                             "velocity_linear", "contour_error"}));
}

// A value that is missing must not look like one that no machine has.
TEST_F(Recording, OfSomeSignalsRefusesToLookForTheOthers) {
  const records::Series some = record({}, {}, {.signals = {{"contour_error"}}});
  EXPECT_EQ(some.column("no_such_signal"), std::nullopt);
  try {
    some.column("true_linear", 'X');
    FAIL();
  } catch (const std::logic_error& error) {
    EXPECT_STREQ(error.what(), "true_linear was not recorded, as nobody asked for it");
  }
}

TEST_F(Recording, GivesUpItsRowsWhenDroppedEarly) {
  Recorder recorder(scenario_.machine, truth_, nullptr, path_, tips_);
  for (const Snapshot& now : snapshots_) recorder.record(now);
  // with the thread at work
}

TEST_F(Recording, RoundsToAPowerOfTwoNotAboveTheResolution) {
  constexpr double kResolution = 1 * nm;
  const records::Series exact = record(), rounded = record({.resolution = kResolution});
  // of what 1 nm is in each unit, the power of two below
  const std::map<std::string, double> quantum = {
      {"mm", 0x1p-20},    {"um", 0x1p-10}, {"deg", 0x1p-25}, {"mm/s", 0x1p-14},
      {"deg/s", 0x1p-18}, {"A", 0x1p-14},  {"N m", 0x1p-14}};
  for (const records::Signal& signal : rounded.signals()) {
    if (signal.scale == "ijk") {
      EXPECT_EQ(signal.quantum, 0x1p-30) << signal.name;
    } else if (signal.units == "1" || signal.units == "s") {
      EXPECT_EQ(signal.quantum, 0.0) << signal.name;
    } else {
      EXPECT_EQ(signal.quantum, quantum.at(signal.units)) << signal.name;
    }
    for (std::size_t n = 0; n < kRows; ++n) {
      for (std::size_t c = 0; c < signal.columns(); ++c) {
        const double before = exact.at(n, signal.offset + c);
        const double after = rounded.at(n, signal.offset + c);
        if (signal.quantum == 0.0) {
          ASSERT_EQ(after, before) << signal.name;
        } else {
          ASSERT_EQ(after, std::nearbyint(before / signal.quantum) * signal.quantum) << signal.name;
        }
      }
    }
  }
}

TEST_F(Recording, LeavesAloneWhatIsTooLargeToRoundOrNoNumber) {
  snapshots_.resize(2);
  snapshots_[0].Q_true[0] = 1e30;
  snapshots_[1].Q_true[0] = std::nan("");
  const records::Series series = record({.resolution = 1 * nm});
  const std::size_t x = *series.column("true_linear", 'X');
  EXPECT_EQ(series.at(0, x), 1e30 / mm);
  EXPECT_TRUE(std::isnan(series.at(1, x)));
}

TEST_F(Recording, KeepsInSinglePrecisionAllButPlaceAndCounts) {
  const records::Series exact = record(), single = record({.storage = records::Storage::float32});
  for (const records::Signal& signal : single.signals()) {
    const bool is_place = signal.name == "time" || signal.name == "s";
    const bool counts = signal.name == "line" || signal.name == "section" || signal.name == "rapid";
    const bool exempt = is_place || counts;
    EXPECT_EQ(signal.storage, is_place ? records::Storage::float64
                              : counts ? records::Storage::int32
                                       : records::Storage::float32)
        << signal.name;
    for (std::size_t n = 0; n < kRows; n += 100) {
      for (std::size_t c = signal.offset; c < signal.offset + signal.columns(); ++c) {
        const double before = exact.at(n, c);
        EXPECT_EQ(single.at(n, c),
                  exempt ? before : static_cast<double>(static_cast<float>(before)))
            << signal.name;
      }
    }
  }
}

}  // namespace
}  // namespace servomill::sim::engine::recorder_test
