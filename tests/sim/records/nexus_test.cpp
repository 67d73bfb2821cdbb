#include "sim/records/nexus.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>

#include "sim/records/hdf5_group.h"
#include "sim/records/input_file.h"
#include "sim/records/output_file.h"

namespace servomill::sim::records::nexus_test {
namespace {

namespace fs = std::filesystem;

class NexusFile : public testing::Test {
 protected:
  NexusFile() : path_(fs::path(testing::TempDir()) / ("nexus_" + std::to_string(getpid()))) {}
  ~NexusFile() override { fs::remove(path_); }

  void write_circle() const {
    OutputFile out(path_, true);
    Hdf5Group root = out.root(), group = root.group("circle");
    make_nexus_group(root, "NXroot", "circle");
    group.list("angle", std::array{0.0, 90.0, 180.0}, {"deg", "angle"});
    group.counts("run", std::array{1.0, 2.0}, {"1", "number of the run"});
    group.table("error", 2, std::array{1.0, 2.0, 3.0, 4.0, 5.0, 6.0}, {"um", "radial error"},
                "angle", "run");
    make_nexus_data(group, {"error", {"angle", "run"}, {}});
    out.commit();
  }

  fs::path path_;
};

TEST_F(NexusFile, NamesSignalAndAxesWithTheirDimensions) {
  write_circle();
  const InputFile in(path_);
  EXPECT_EQ(in.text("/", "NX_class"), "NXroot");
  EXPECT_EQ(in.text("/", "default"), "circle");
  EXPECT_EQ(in.text("/circle", "NX_class"), "NXdata");
  EXPECT_EQ(in.text("/circle", "signal"), "error");
  EXPECT_EQ(in.number("/circle", "angle_indices"), 0.0);
  EXPECT_EQ(in.number("/circle", "run_indices"), 1.0);
  EXPECT_FALSE(in.has_attribute("/circle", "auxiliary_signals"));
  EXPECT_FALSE(in.has_attribute("/circle", "default"));
}

TEST_F(NexusFile, LabelsWithTheUnitThatReadersOfOursDoNotSee) {
  write_circle();
  const InputFile in(path_);
  EXPECT_EQ(in.text("/circle/error", "long_name"), "radial error [um]");
  EXPECT_EQ(in.meaning("/circle/error").long_name, "radial error");
  EXPECT_EQ(in.meaning("/circle/error").units, "um");
  EXPECT_EQ(in.text("/circle/run", "long_name"), "number of the run");
}

TEST(Label, OfATextInPlaceOfAUnitHasNone) {
  for (const char* units : {"", "1", "unknown", "as unit_NN"}) {
    EXPECT_EQ(labelled({units, "value"}), "value") << units;
    EXPECT_EQ(unlabelled("value [1]", units), "value [1]") << units;
  }
  EXPECT_EQ(labelled({"mm/s", "speed"}), "speed [mm/s]");
  EXPECT_EQ(unlabelled("speed [mm/s]", "mm/s"), "speed");
  EXPECT_EQ(unlabelled("speed [mm/s]", "m/s"), "speed [mm/s]");
}

}  // namespace
}  // namespace servomill::sim::records::nexus_test
