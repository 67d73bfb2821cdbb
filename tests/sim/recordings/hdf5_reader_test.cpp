#include "sim/recordings/hdf5_reader.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "sim/records/hdf5_group.h"
#include "sim/records/output_file.h"
#include "tests/text.h"

namespace servomill::sim::recordings::hdf5_reader_test {
namespace {

namespace fs = std::filesystem;

class Hdf5Reader : public testing::Test {
 protected:
  Hdf5Reader()
      : folder_(fs::path(testing::TempDir()) / ("hdf5_reader_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~Hdf5Reader() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return folder_ / name; }
  fs::path folder_;
};

TEST_F(Hdf5Reader, SignalsOfAResultFileAreChannels) {
  {
    records::OutputFile file(path("a.h5"), false);
    records::Hdf5Group group = file.root().group("cases/table/servo");
    const std::vector<double> time = {0.0, 0.5}, places = {1.0, 2.0, 3.0, 4.0};
    group.list("time", time, {"s", "time"});
    group.labels("axis", "XY", "axes");
    group.table("position", 2, places, {"mm", "position"}, "time", "axis");
    group.list("current", time, {"A", "current"}, "time");
    file.commit();
  }
  const Recording recording = read_hdf5(path("a.h5"));
  ASSERT_EQ(recording.channels.size(), 3u);
  EXPECT_EQ(recording.channels[0].name, "cases/table/servo/position_1");
  EXPECT_EQ(recording.channels[1].samples, (std::vector<double>{2.0, 4.0}));
  EXPECT_EQ(recording.channels[2].unit, "A");
  EXPECT_EQ(recording.bases[0].values, (std::vector<double>{0.0, 0.5}));
}

TEST_F(Hdf5Reader, CutHdf5IsRefused) {
  {
    records::OutputFile file(path("a.h5"), false);
    const std::vector<double> time(1000, 1.0);
    file.root().list("time", time, {"s", "time"});
    file.commit();
  }
  fs::resize_file(path("a.h5"), fs::file_size(path("a.h5")) / 2);
  EXPECT_TRUE(fault_messages([&] { read_hdf5(path("a.h5")); }).starts_with("cannot be read: "));
}

TEST_F(Hdf5Reader, FileWithoutSignalsIsRefused) {
  {
    records::OutputFile file(path("a.h5"), false);
    file.root().scalar("x", 1.0, {"1", "x"});
    file.commit();
  }
  EXPECT_EQ(fault_messages([&] { read_hdf5(path("a.h5")); }),
            "contains no group with a dataset 'time' or 'frequency': no signals\n");
}

TEST_F(Hdf5Reader, RecordingWithAChannelOfAnotherLengthIsRefused) {
  {
    records::OutputFile file(path("a.h5"), false);
    records::Hdf5Group root = file.root();
    root.attribute(kSourceAttribute, "a.csv");
    const std::vector<double> time = {0.0, 0.5}, longer = {1.0, 2.0, 3.0};
    records::Hdf5Group group = root.group("base_001");
    group.list("time", time, {"s", "time"});
    group.list("x", longer, {"mm", "x"});
    file.commit();
  }
  EXPECT_EQ(fault_messages([&] { read_hdf5(path("a.h5")); }),
            "channel 'base_001/x' has 3 samples, its time has 2 values\n");
}

}  // namespace
}  // namespace servomill::sim::recordings::hdf5_reader_test
