#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include "plant/vocabulary/input_error.h"
#include "sim/records/chunk_encoder.h"
#include "sim/records/hdf5_dataset.h"
#include "sim/records/hdf5_group.h"
#include "sim/records/input_file.h"
#include "sim/records/output_file.h"

namespace servomill::sim::records::fixed_dataset_test {
namespace {

namespace fs = std::filesystem;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

class FixedDataset : public testing::Test {
 protected:
  FixedDataset() : folder_(fs::path(testing::TempDir()) / ("fixed_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~FixedDataset() override { fs::remove_all(folder_); }
  std::string path() const { return folder_ / "out.h5"; }

  fs::path folder_;
};

TEST_F(FixedDataset, IsFilledInAnyOrder) {
  {
    OutputFile out(path(), false);
    Hdf5Group root = out.root();
    Hdf5Dataset value = root.fixed("value", 6, Storage::float64, kNone, {"um", "value"});
    Hdf5Dataset code = root.fixed("code", 6, Storage::int32, -1.0, {"1", "code"});
    value.write(4, std::array{5.0, 6.0});
    value.write(1, std::array{2.0});
    code.write(2, std::array{7.0});
    out.commit();
  }
  const InputFile in(path());
  const auto values = in.values("/value", 0, 6);
  for (const std::size_t row : {0U, 2U, 3U}) EXPECT_TRUE(std::isnan(values[row])) << row;
  EXPECT_EQ(values[1], 2.0);
  EXPECT_EQ(in.values("/value", 4, 2), (std::vector<double>{5.0, 6.0}));
  EXPECT_EQ(in.values("/code"), (std::vector<double>{-1, -1, 7, -1, -1, -1}));
}

TEST_F(FixedDataset, CutsTextsBetweenCharacters) {
  {
    OutputFile out(path(), false);
    Hdf5Dataset text = out.root().fixed_texts("text", 4, 8, "text");
    text.write_text(0, "12345678");
    text.write_text(1, "123456789");
    text.write_text(3, "1234µ6789");  // µ has two bytes, the fifth and the sixth
    out.commit();
  }
  EXPECT_EQ(InputFile(path()).texts("/text", 0, 4),
            (std::vector<std::string>{"12345678", "12345...", "", "1234..."}));
}

TEST_F(FixedDataset, IsGoneOnWithWhereAFileWasLeft) {
  {
    OutputFile out(path(), false);
    out.root()
        .fixed("value", 3, Storage::float64, kNone, {"um", "value"})
        .write(0, std::array{1.0});
    out.root().flush_file();
  }  // no commit
  EXPECT_FALSE(fs::exists(path()));
  {
    OutputFile out = OutputFile::resumed(path(), false);
    Hdf5Dataset value = out.root().dataset("value");
    value.write(1, std::array{2.0, 3.0});
    out.commit();
  }
  EXPECT_EQ(InputFile(path()).values("/value"), (std::vector<double>{1.0, 2.0, 3.0}));
  EXPECT_THROW(OutputFile::resumed(path(), false),
               InputError);  // there is no partial file any more
}

TEST_F(FixedDataset, IsReadWithinItsLength) {
  {
    OutputFile out(path(), false);
    out.root().fixed("value", 3, Storage::float64, 0.0, {"um", "value"});
    out.commit();
  }
  const InputFile in(path());
  EXPECT_NO_THROW(in.values("/value", 1, 2));
  EXPECT_THROW(in.values("/value", 2, 2), InputError);
  EXPECT_THROW(in.texts("/value", 0, 1), InputError);
}

}  // namespace
}  // namespace servomill::sim::records::fixed_dataset_test
