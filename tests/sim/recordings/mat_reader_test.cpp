#include "sim/recordings/mat_reader.h"

#include <gtest/gtest.h>
#include <matio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>

#include "sim/recordings/read_recording.h"
#include "sim/recordings/survey.h"
#include "tests/text.h"

namespace servomill::sim::recordings::mat_reader_test {
namespace {

namespace fs = std::filesystem;

class MatReader : public testing::Test {
 protected:
  MatReader() : folder_(fs::path(testing::TempDir()) / ("mat_reader_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    open("a.mat");
  }
  ~MatReader() override {
    close();
    fs::remove_all(folder_);
  }
  std::string path(const std::string& name) const { return folder_ / name; }
  void open(const std::string& name) {
    mat_ = Mat_CreateVer(path(name).c_str(), nullptr, MAT_FT_MAT5);
  }
  void close() {
    if (mat_ != nullptr) Mat_Close(mat_);
    mat_ = nullptr;
  }
  template <class Number, std::size_t Size>
  void write(const char* name, matio_classes kind, matio_types type,
             std::array<Number, Size> values, std::size_t columns = 1,
             matio_compression compression = MAT_COMPRESSION_ZLIB) {
    std::array<std::size_t, 2> size = {Size / columns, columns};
    matvar_t* variable = Mat_VarCreate(name, kind, type, 2, size.data(), values.data(), 0);
    Mat_VarWrite(mat_, variable, compression);
    Mat_VarFree(variable);
  }
  fs::path folder_;
  mat_t* mat_ = nullptr;
};

TEST_F(MatReader, ArraysOfAnyNumbersAreChannels) {
  write("t", MAT_C_DOUBLE, MAT_T_DOUBLE, std::array{0.0, 0.5, 1.0});
  write("x", MAT_C_SINGLE, MAT_T_SINGLE, std::array{1.0F, 2.5F, 3.0F}, 1, MAT_COMPRESSION_NONE);
  write("n", MAT_C_INT16, MAT_T_INT16, std::array<std::int16_t, 3>{-1, 2, 3});
  write("u", MAT_C_UINT8, MAT_T_UINT8, std::array<std::uint8_t, 3>{255, 2, 3});
  write("table", MAT_C_DOUBLE, MAT_T_DOUBLE, std::array{1.0, 2.0, 3.0, 4.0, 5.0, 6.0}, 2);
  write("row", MAT_C_DOUBLE, MAT_T_DOUBLE, std::array{7.0, 8.0, 9.0}, 3);
  write("kp", MAT_C_DOUBLE, MAT_T_DOUBLE, std::array{160.25});
  write("word", MAT_C_CHAR, MAT_T_UINT8, std::array<std::uint8_t, 2>{'a', 'b'}, 2);
  write("other", MAT_C_DOUBLE, MAT_T_DOUBLE, std::array{1.0, 2.0});
  close();
  const Recording recording = read_recording(path("a.mat"));
  EXPECT_EQ(recording.format, "MAT v5");
  EXPECT_EQ(recording.bases.at(0).values, (std::vector<double>{0.0, 0.5, 1.0}));
  const std::vector<std::pair<std::string, std::vector<double>>> expected = {
      {"x", {1.0, 2.5, 3.0}}, {"n", {-1, 2, 3}},      {"u", {255, 2, 3}},
      {"table_1", {1, 2, 3}}, {"table_2", {4, 5, 6}}, {"row", {7, 8, 9}}};
  ASSERT_EQ(recording.channels.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(recording.channels[i].name, expected[i].first);
    EXPECT_EQ(recording.channels[i].samples, expected[i].second);
  }
  EXPECT_EQ(recording.notes,
            (std::vector<std::string>{
                "'kp' = 160.25", "'word' is a text: skipped",
                "'other' has 2 values, the time 't' has 3: skipped",
                "the file has no unit of its time: s is assumed; --time-unit specifies another"}));
  EXPECT_EQ(read_recording(path("a.mat"), "ms").bases.at(0).values[1], 0.5e-3);
}

TEST_F(MatReader, WithoutATimeEachLengthHasItsSampleNumbers) {
  write("x", MAT_C_DOUBLE, MAT_T_DOUBLE, std::array{1.0, 2.0, 3.0});
  write("y", MAT_C_DOUBLE, MAT_T_DOUBLE, std::array{1.0, 2.0});
  close();
  const Recording recording = read_recording(path("a.mat"));
  ASSERT_EQ(recording.bases.size(), 2u);
  EXPECT_EQ(recording.bases[0].unit, "1");
  EXPECT_EQ(recording.channels[1].base, 1u);
}

TEST_F(MatReader, TimeThatRunsBackwardsIsRefused) {
  write("t", MAT_C_DOUBLE, MAT_T_DOUBLE, std::array{0.0, 1.0, 0.5});
  write("x", MAT_C_DOUBLE, MAT_T_DOUBLE, std::array{1.0, 2.0, 3.0});
  close();
  EXPECT_EQ(fault_messages([&] { read_recording(path("a.mat")); }),
            "time: value 3 is 0.5 s after 1 s; must increase\n");
}

TEST_F(MatReader, CutFilesAreRefused) {
  std::array<double, 1000> values{};
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = 1.0 / (1.0 + static_cast<double>(i));
  std::sort(values.begin(), values.end());
  for (const matio_compression compression : {MAT_COMPRESSION_ZLIB, MAT_COMPRESSION_NONE}) {
    close();
    open("b.mat");
    write("x", MAT_C_DOUBLE, MAT_T_DOUBLE, values, 1, compression);
    close();
    const auto size = fs::file_size(path("b.mat"));
    for (const double share : {0.9, 0.5, 0.2}) {
      fs::resize_file(path("b.mat"),
                      static_cast<std::uintmax_t>(static_cast<double>(size) * share));
      EXPECT_EQ(fault_messages([&] { read_recording(path("b.mat")); }),
                "is truncated: the array at byte 128 is longer than the file\n");
    }
  }
}

const std::string kMeasured = std::string(SERVOMILL_SOURCE_DIR) + "/../shared/data/measured/";

TEST_F(MatReader, EmpsBenchmark) {
  const std::string file = kMeasured + "emps_train.mat";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not there";
  const Recording recording = read_recording(file);
  ASSERT_EQ(recording.channels.size(), 3u);
  EXPECT_EQ(recording.channels[0].name, "qg");
  EXPECT_EQ(recording.channels[1].name, "qm");
  EXPECT_EQ(recording.channels[2].name, "vir");
  EXPECT_EQ(recording.bases.at(0).values.size(), 24841u);
  EXPECT_NEAR(interval(recording.bases[0]), 1e-3, 1e-7);  // its times vary by that
  EXPECT_NEAR(recording.bases[0].values.back(), 24.84, 0.01);
  EXPECT_TRUE(gaps(recording.bases[0]).empty());
  EXPECT_TRUE(clipping(recording.channels[1]).empty());
  EXPECT_TRUE(std::find(recording.notes.begin(), recording.notes.end(), "'kp' = 160.18") !=
              recording.notes.end());
}

TEST_F(MatReader, TwoInertiaBench) {
  const std::string file = kMeasured + "two_inertia_multisine_A.mat";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not there";
  const Recording recording = read_recording(file, "us");
  EXPECT_NEAR(interval(recording.bases.at(0)), 0.4e-3, 1e-9);
  for (const char* name : {"iq_refx", "iq_adx", "theta_mx", "theta_my"}) {
    EXPECT_TRUE(std::any_of(recording.channels.begin(), recording.channels.end(),
                            [&](const Channel& one) { return one.name == name; }))
        << name;
  }
}

}  // namespace
}  // namespace servomill::sim::recordings::mat_reader_test
