#include "sim/records/series_writer.h"

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <new>

#include "plant/vocabulary/input_error.h"
#include "sim/records/input_file.h"
#include "sim/records/output_file.h"
#include "sim/system/system_error.h"
#include "tests/sim/records/file_snapshots.h"

namespace {
thread_local std::size_t allocations = 0;  // the writer's thread may allocate
}
// not inlined, or the compiler takes malloc and delete for a pair that does not match
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

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

TEST_F(SeriesFile, HasEveryRowWhateverTheBlock) {
  constexpr std::size_t kBlock = 4;
  for (const std::size_t count : {0u, 1u, 3u, 4u, 5u, 8u, 11u}) {
    {
      OutputFile out(path("out.h5"), true);
      SeriesWriter writer(out.root().group("servo"), layout(kBlock));
      ASSERT_EQ(writer.row_width(), 6u);
      EXPECT_EQ(writer.offset_of("time"), 0u);
      EXPECT_EQ(writer.offset_of("contour_error"), 5u);
      for (std::size_t n = 0; n < count; ++n) writer.append(row(n));
      writer.finish();
      out.commit();
    }
    expect_rows(InputFile(path("out.h5")), "/servo", count);
  }
}

// To the byte, as if they had come one by one.
TEST_F(SeriesFile, IsTheSameFromAllRowsAtOnce) {
  constexpr std::size_t kBlock = 16;
  for (const std::size_t count : {0u, 1u, 15u, 16u, 17u, 43u}) {
    std::vector<double> rows;
    for (std::size_t n = 0; n < count; ++n) {
      for (const double value : row(n)) rows.push_back(value);
    }
    const auto written = [&](const std::string& name, bool at_once) {
      {
        OutputFile out(path(name), true);
        SeriesLayout wanted = layout(kBlock);
        wanted.is_complete = at_once;
        SeriesWriter writer(out.root().group("servo"), wanted);
        if (at_once) writer.append_all(rows);
        for (std::size_t n = 0; !at_once && n < count; ++n) writer.append(row(n));
        writer.finish();
        out.commit();
      }
      std::ifstream file(path(name), std::ios::binary);
      return std::string(std::istreambuf_iterator<char>(file), {});
    };
    EXPECT_EQ(written("rows.h5", false), written("all.h5", true)) << count << " rows";
    expect_rows(InputFile(path("all.h5")), "/servo", count);
  }
}

TEST_F(SeriesFile, WritesTheRestWhenLeftEarly) {
  {
    OutputFile out(path("out.h5"), false);
    SeriesWriter writer(out.root().group("servo"), layout(4));
    for (std::size_t n = 0; n < 6; ++n) writer.append(row(n));
  }
  expect_rows(InputFile(path("out.h5.partial")), "/servo", 6);
}

TEST_F(SeriesFile, AllocatesNothingWhileABlockFills) {
  constexpr std::size_t kBlock = 512;
  OutputFile out(path("out.h5"), false);
  const std::size_t first = allocations;
  SeriesWriter writer(out.root().group("servo"), layout(kBlock));
  EXPECT_GT(allocations, first);  // the count works
  for (std::size_t n = 0; n < kBlock; ++n) writer.append(row(n));
  const std::size_t before = allocations;
  for (std::size_t n = kBlock; n < 2 * kBlock - 1; ++n) writer.append(row(n));
  EXPECT_EQ(allocations, before);
}

TEST_F(SeriesFile, OpensInH5pyAndXarray) {
  {
    OutputFile out(path("out.h5"), false);
    Hdf5Group root = out.root();
    root.attribute("Conventions", "CF-1.8");
    root.group("inputs").attribute("scenario", "title = \"Épreuve\"\n");
    SeriesWriter servo(root.group("cases/table/servo"), layout(4));
    for (std::size_t n = 0; n < 10; ++n) servo.append(row(n));
    servo.finish();
    SeriesLayout probes;
    probes.index = "point";
    probes.index_meaning = {"1", "number of the point"};
    probes.channels = {{"deviation", {"um", "measured minus nominal"}, ""}};
    SeriesWriter writer(root.group("cases/gcode/probes"), probes);
    writer.append(std::array{1.0, 0.3});
    writer.finish();
    root.group("comparison/residual").scalar("value", 20.0, {"um", "largest residual"});
    out.commit();
  }
  const std::string script = SERVOMILL_SOURCE_DIR "/tests/sim/records/open_with_python.py";
  const std::string command = "/usr/bin/python3 '" + script + "' '" + path("out.h5") + "'";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
}

// Appends until it fails: at the block after the one that could not be written. Rows of the blocks
// before that.
std::size_t fill(const std::string& path, std::string& message) {
  constexpr std::size_t kBlock = 1024;
  constexpr std::size_t kMaxRows = 4'000'000;
  OutputFile out(path, false);
  SeriesWriter writer(out.root().group("servo"), layout(kBlock));
  for (std::size_t n = 0; n < kMaxRows; ++n) {
    try {
      writer.append(row(n));
    } catch (const system::SystemError& error) {
      message = error.what();
      return n + 1 - 2 * kBlock;
    }
  }
  return kMaxRows;
}

TEST_F(SeriesFile, OnAFullDiskSaysSoAndKeepsWhatWasWritten) {
  const std::string disk = path("disk");
  fs::create_directory(disk);
  if (mount("none", disk.c_str(), "tmpfs", 0, "size=2m") != 0) {
    GTEST_SKIP() << "only root can mount a small disk";
  }
  std::string message;
  const std::size_t rows = fill(disk + "/out.h5", message);
  EXPECT_EQ(message, disk + "/out.h5.partial: error: cannot be written: No space left on device");
  EXPECT_FALSE(fs::exists(disk + "/out.h5"));
  EXPECT_GT(rows, 10'000u);
  { expect_rows(InputFile(disk + "/out.h5.partial"), "/servo", rows); }
  EXPECT_EQ(umount(disk.c_str()), 0);
}

[[noreturn]] void fill_below_a_limit(const std::string& path) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{1 << 20, 1 << 20};
  setrlimit(RLIMIT_FSIZE, &limit);
  std::string message;
  fill(path, message);
  std::fputs(message.c_str(), stderr);
  std::exit(message.empty() ? 1 : 0);
}

TEST_F(SeriesFile, BeyondTheLimitOfFileSizeSaysSo) {
  // in a process of its own, because the limit cannot be raised again
  EXPECT_EXIT(fill_below_a_limit(path("out.h5")), testing::ExitedWithCode(0),
              "out.h5.partial: error: cannot be written: File too large");
}

// Rows of every block that was promised, in a file left by a kill.
void expect_promised(const InputFile& in, std::size_t promised) {
  const std::array<std::string, 4> names = {"time", "line", "ref_linear", "contour_error"};
  constexpr std::array<std::size_t, 4> kOffset = {0, 1, 2, 5};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string name = "/servo/" + names[i];
    const auto values = in.values(name);
    const std::size_t columns = in.shape(name).size() == 2 ? 3 : 1;
    ASSERT_GE(values.size(), promised * columns) << name;
    for (std::size_t n = 0; n < promised; ++n) {
      for (std::size_t c = 0; c < columns; ++c) {
        ASSERT_EQ(values[n * columns + c], row(n)[kOffset[i] + c]) << name << " row " << n;
      }
    }
  }
}

// As many as the index of a dataset of three columns holds before the library splits it.
constexpr std::size_t kBlocksInOneNode = 64 / 3;

TEST_F(SeriesFile, KilledAtAnyWriteKeepsTheBlocksBefore) {
  constexpr std::size_t kBlock = 16;
  std::atomic<std::size_t> promised = 0;
  OutputFile out(path("out.h5"), false);
  SeriesWriter writer(out.root().group("servo"), layout(kBlock));
  FileSnapshots snapshots(out.partial_path(), folder_ / "snapshots", promised);
  for (std::size_t n = 0; n < kBlock * kBlocksInOneNode; ++n) {
    writer.append(row(n));
    // taking one block, it has written the one before
    if ((n + 1) % kBlock == 0) promised = n + 1 - kBlock;
  }
  writer.finish();
  EXPECT_GT(snapshots.all().size(), 10 * kBlocksInOneNode);
  for (const FileSnapshots::Snapshot& left : snapshots.all()) {
    if (left.promised == 0) continue;  // the first block makes the indexes
    SCOPED_TRACE(left.path);
    expect_promised(InputFile(left.path), left.promised);
    if (HasFatalFailure()) return;
  }
}

TEST_F(SeriesFile, KilledIndeedKeepsTheBlocksBefore) {
  constexpr std::size_t kBlock = 64;
  for (std::size_t block : {std::size_t{1}, kBlocksInOneNode / 2, kBlocksInOneNode - 1}) {
    std::array<int, 2> pipe_ends{};
    ASSERT_EQ(pipe(pipe_ends.data()), 0);
    const pid_t child = fork();
    if (child == 0) {
      OutputFile out(path("out.h5"), true);
      SeriesWriter writer(out.root().group("servo"), layout(kBlock));
      for (std::size_t n = 0; n < kBlock * kBlocksInOneNode; ++n) {
        writer.append(row(n));
        if ((n + 1) % kBlock != 0) continue;
        const std::size_t done = n + 1 - kBlock;
        if (write(pipe_ends[1], &done, sizeof done) < 0) _exit(1);
      }
      pause();
    }
    close(pipe_ends[1]);
    std::size_t promised = 0;
    while (promised < block * kBlock) {
      ASSERT_EQ(read(pipe_ends[0], &promised, sizeof promised), ssize_t{sizeof promised});
    }
    ASSERT_EQ(kill(child, SIGKILL), 0);
    ASSERT_EQ(waitpid(child, nullptr, 0), child);
    while (read(pipe_ends[0], &promised, sizeof promised) > 0) {
    }
    close(pipe_ends[0]);
    EXPECT_FALSE(fs::exists(path("out.h5")));
    expect_promised(InputFile(path("out.h5.partial")), promised);
  }
}

TEST_F(SeriesFile, IsTheSameForAnyNumberOfThreads) {
  constexpr std::size_t kChannels = 20;  // three groups of columns
  const auto written = [&](unsigned threads, int compression) {
    SeriesLayout wide;
    wide.threads = threads;
    wide.compression = compression;
    for (std::size_t c = 0; c < kChannels; ++c) {
      wide.channels.push_back({"c" + std::to_string(c), {"mm", "signal"}, ""});
    }
    OutputFile out(path("out.h5"), true);
    SeriesWriter writer(out.root().group("servo"), wide);
    std::array<double, kChannels + 1> values{};
    for (std::size_t n = 0; n < wide.chunk_rows + 100; ++n) {
      for (std::size_t c = 0; c < values.size(); ++c) {
        values[c] = std::sin(0.01 * static_cast<double>(n) + static_cast<double>(c));
      }
      writer.append(values);
    }
    writer.finish();
    out.commit();
    std::ifstream file(path("out.h5"), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const std::string one = written(1, 1);
  EXPECT_TRUE(written(4, 1) == one);
  const std::string plain = written(1, kNoCompression);
  EXPECT_TRUE(written(4, kNoCompression) == plain);
  EXPECT_GT(plain.size(), one.size());
}

TEST_F(SeriesFile, HoldsTheSameAtEveryLevelOfCompression) {
  for (int level = kNoCompression; level <= kMaxCompression; ++level) {
    {
      OutputFile out(path("out.h5"), true);
      SeriesLayout leveled = layout(7);
      leveled.compression = level;
      SeriesWriter writer(out.root().group("servo"), leveled);
      for (std::size_t n = 0; n < 20; ++n) writer.append(row(n));
      writer.finish();
      out.commit();
    }
    expect_rows(InputFile(path("out.h5")), "/servo", 20);
  }
}

}  // namespace
}  // namespace servomill::sim::records::series_writer_test
