#include "sim/recordings/write_recording.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "sim/recordings/csv_reader.h"
#include "sim/recordings/read_recording.h"
#include "tests/text.h"

namespace servomill::sim::recordings::write_recording_test {
namespace {

namespace fs = std::filesystem;

class WriteRecording : public testing::Test {
 protected:
  WriteRecording()
      : folder_(fs::path(testing::TempDir()) / ("write_recording_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~WriteRecording() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return folder_ / name; }
  fs::path folder_;
};

Recording example() {
  Recording out{"a", "b", {{"time", "s", {0.0, 0.1, 0.30000000000000004}}}, {}, {}};
  out.channels.push_back(
      {"s actual, X", "mm", {1.0 / 3.0, std::numeric_limits<double>::quiet_NaN(), -1e-300}, 0});
  out.channels.push_back({"a/b", "", {1, 2, 3}, 0});
  return out;
}

void expect_equal(const Recording& a, const Recording& b) {
  ASSERT_EQ(a.bases.size(), b.bases.size());
  ASSERT_EQ(a.channels.size(), b.channels.size());
  for (std::size_t i = 0; i < a.bases.size(); ++i) {
    EXPECT_EQ(a.bases[i].values, b.bases[i].values);
    EXPECT_EQ(a.bases[i].unit, b.bases[i].unit);
  }
  for (std::size_t i = 0; i < a.channels.size(); ++i) {
    EXPECT_EQ(a.channels[i].name, b.channels[i].name);
    EXPECT_EQ(a.channels[i].unit, b.channels[i].unit);
    EXPECT_EQ(a.channels[i].base, b.channels[i].base);
    ASSERT_EQ(a.channels[i].samples.size(), b.channels[i].samples.size());
    for (std::size_t k = 0; k < a.channels[i].samples.size(); ++k) {
      const double x = a.channels[i].samples[k], y = b.channels[i].samples[k];
      EXPECT_TRUE(x == y || (std::isnan(x) && std::isnan(y))) << x << " " << y;
    }
  }
}

TEST_F(WriteRecording, CsvRestoresEveryBit) {
  expect_equal(parse_csv(to_csv(example()), "a"), example());
  write_recording(example(), path("a.csv"), false);
  expect_equal(read_recording(path("a.csv")), example());
}

TEST_F(WriteRecording, Hdf5RestoresEveryBitAndSeveralBases) {
  Recording two = example();
  two.bases.push_back({"response frequency", "Hz", {1.0, 2.0}});
  two.channels.push_back({"gain", "dB", {0.0, -3.0}, 1});
  write_recording(two, path("a.h5"), false);
  expect_equal(read_recording(path("a.h5")), two);
  EXPECT_EQ(fault_messages([&] { to_csv(two); }),
            "has 2 time or frequency bases, a table has one; write .h5\n");
}

TEST_F(WriteRecording, ReplacesNothingUnforced) {
  for (const std::string name : {"a.csv", "a.h5"}) {
    write_recording(example(), path(name), false);
    EXPECT_EQ(fault_messages([&] { write_recording(example(), path(name), false); }),
              "exists; use --force to overwrite\n");
    write_recording(example(), path(name), true);
  }
  EXPECT_EQ(fault_messages([] { refuse_unknown_kind("a.mat"); }),
            "recordings are written as .csv or .h5\n");
}

}  // namespace
}  // namespace servomill::sim::recordings::write_recording_test
