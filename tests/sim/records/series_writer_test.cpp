// Series in a file: every row, at every level of compression, and a disk that is full.

#include "sim/records/series_writer.h"

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/records/encoded_series.h"
#include "sim/records/input_file.h"
#include "sim/records/output_file.h"
#include "sim/system/system_error.h"

namespace servomill::sim::records::series_writer_test {
namespace {

namespace fs = std::filesystem;

class SeriesFile : public testing::Test {
 protected:
  SeriesFile() : folder_(fs::path(testing::TempDir()) / ("series_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~SeriesFile() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return folder_ / name; }

  fs::path folder_;
};

SeriesLayout layout(std::size_t chunk_rows) {
  SeriesLayout out;
  out.labels = {{"axis_linear", "XYZ", "linear axis"}};
  out.channels = {{"line", {"1", "line of the original program"}, "", Storage::int32},
                  {"ref_linear", {"mm", "reference position"}, "axis_linear"},
                  {"contour_error", {"um", "contour error"}, "", Storage::float32}};
  out.chunk_rows = chunk_rows;
  return out;
}

// time, line, X Y Z, contour error: every number tells its row.
std::array<double, 6> row(std::size_t n) {
  const auto i = static_cast<double>(n);
  return {0.1 * i, i, 100 * i, 100 * i + 1, 100 * i + 2, 0.5 * i};
}

Series rows(std::size_t count) {
  Series out({{"time", "s", "time", "", ""},
              {"line", "1", "line of the original program", "", "", 0, Storage::int32},
              {"ref_linear", "mm", "reference position", "XYZ", "axis_linear"},
              {"contour_error", "um", "contour error", "", "", 0, Storage::float32}});
  out.reserve(count);
  for (std::size_t n = 0; n < count; ++n) out.append(row(n));
  return out;
}

void write(OutputFile& out, const std::string& group, const SeriesLayout& layout,
           const Series& series) {
  write_pages(out.root().group(group), layout,
              EncodedSeries(series, {layout.chunk_rows, layout.compression}, 1));
}

void expect_rows(const InputFile& in, const std::string& group, std::size_t count) {
  const auto time = in.values(group + "/time");
  const auto line = in.values(group + "/line");
  const auto ref = in.values(group + "/ref_linear");
  const auto error = in.values(group + "/contour_error");
  ASSERT_EQ(time.size(), count);
  ASSERT_EQ(line.size(), count);
  ASSERT_EQ(ref.size(), 3 * count);
  ASSERT_EQ(error.size(), count);
  for (std::size_t n = 0; n < count; ++n) {
    const std::array<double, 6> read = {time[n],        line[n],        ref[3 * n],
                                        ref[3 * n + 1], ref[3 * n + 2], error[n]};
    ASSERT_EQ(read, row(n)) << "row " << n;
  }
}

TEST_F(SeriesFile, HasEveryRowWhateverTheChunk) {
  for (const std::size_t count : {0u, 1u, 3u, 4u, 5u, 8u, 11u}) {
    {
      OutputFile out(path("out.h5"), true);
      write(out, "servo", layout(4), rows(count));
      out.commit();
    }
    expect_rows(InputFile(path("out.h5")), "/servo", count);
  }
}

TEST_F(SeriesFile, HasEveryRowOfManyChunks) {
  constexpr std::size_t kMany = 1000;  // of one row: more than the index of a dataset holds at once
  {
    OutputFile out(path("out.h5"), true);
    write(out, "servo", layout(1), rows(kMany));
    out.commit();
  }
  expect_rows(InputFile(path("out.h5")), "/servo", kMany);
}

TEST_F(SeriesFile, HoldsTheSameAtEveryLevelOfCompression) {
  for (int level = kNoCompression; level <= kMaxCompression; ++level) {
    {
      OutputFile out(path("out.h5"), true);
      SeriesLayout leveled = layout(7);
      leveled.compression = level;
      write(out, "servo", leveled, rows(20));
      out.commit();
    }
    expect_rows(InputFile(path("out.h5")), "/servo", 20);
  }
}

TEST_F(SeriesFile, OpensInH5pyAndXarray) {
  {
    OutputFile out(path("out.h5"), false);
    Hdf5Group root = out.root();
    root.attribute("Conventions", "CF-1.8");
    root.group("inputs").attribute("scenario", "title = \"Épreuve\"\n");
    write(out, "cases/table/servo", layout(4), rows(10));
    SeriesLayout probes;
    probes.index = "point";
    probes.index_meaning = {"1", "number of the point"};
    probes.channels = {{"deviation", {"um", "measured minus nominal"}, ""}};
    Series points({{"point", "1", "number of the point", "", ""},
                   {"deviation", "um", "measured minus nominal", "", ""}});
    points.append(std::array{1.0, 0.3});
    write(out, "cases/gcode/probes", probes, points);
    root.group("comparison/residual").scalar("value", 20.0, {"um", "largest residual"});
    out.commit();
  }
  const std::string script = SERVOMILL_SOURCE_DIR "/tests/sim/records/open_with_python.py";
  const std::string command = "/usr/bin/python3 '" + script + "' '" + path("out.h5") + "'";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
}

// Writes a series of some megabytes. The message of what stops it; empty: nothing did.
std::string fill(const std::string& path) {
  OutputFile out(path, false);
  try {
    SeriesLayout plain = layout(1024);
    plain.compression = kNoCompression;
    write(out, "servo", plain, rows(100'000));
  } catch (const system::SystemError& error) {
    return error.what();
  }
  return "";
}

TEST_F(SeriesFile, OnAFullDiskSaysSo) {
  const std::string disk = path("disk");
  fs::create_directory(disk);
  if (mount("none", disk.c_str(), "tmpfs", 0, "size=2m") != 0) {
    GTEST_SKIP() << "only root can mount a small disk";
  }
  EXPECT_EQ(fill(disk + "/out.h5"),
            disk + "/out.h5.partial: error: cannot be written: No space left on device");
  EXPECT_FALSE(fs::exists(disk + "/out.h5"));
  EXPECT_EQ(umount(disk.c_str()), 0);
}

[[noreturn]] void fill_below_a_limit(const std::string& path) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{1 << 20, 1 << 20};
  setrlimit(RLIMIT_FSIZE, &limit);
  const std::string message = fill(path);
  std::fputs(message.c_str(), stderr);
  std::exit(message.empty() ? 1 : 0);
}

TEST_F(SeriesFile, BeyondTheLimitOfFileSizeSaysSo) {
  // in a process of its own, because the limit cannot be raised again
  EXPECT_EXIT(fill_below_a_limit(path("out.h5")), testing::ExitedWithCode(0),
              "out.h5.partial: error: cannot be written: File too large");
}

}  // namespace
}  // namespace servomill::sim::records::series_writer_test
