#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/records/hdf5_group.h"
#include "sim/records/input_file.h"
#include "sim/records/output_file.h"
#include "sim/system/system_error.h"
#include "sim/system/write_lock.h"

namespace servomill::sim::records::hdf5_file_test {
namespace {

namespace fs = std::filesystem;

// A folder of its own, gone with the test.
class Hdf5File : public testing::Test {
 protected:
  Hdf5File() : folder_(fs::path(testing::TempDir()) / ("hdf5_file_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~Hdf5File() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return folder_ / name; }

  // Message of the error, without the folder.
  std::string message(const std::function<void()>& action) const {
    std::string text = "no error";
    try {
      action();
    } catch (const std::exception& error) {
      text = error.what();
    }
    const std::string prefix = folder_.string() + "/";
    for (auto at = text.find(prefix); at != std::string::npos; at = text.find(prefix)) {
      text.erase(at, prefix.size());
    }
    return text;
  }

  fs::path folder_;
};

TEST_F(Hdf5File, GivesBackWhatWasWritten) {
  const std::string big(1 << 20, 'g');
  const std::array values = {1.0, -0.1, 3e-300};
  {
    OutputFile out(path("out.h5"), false);
    Hdf5Group root = out.root();
    root.attribute("Conventions", "CF-1.8");
    Hdf5Group table = root.group("cases/table");
    table.attribute("program", big);
    table.attribute("empty", "");
    table.attribute("ratio", 0.1);
    table.attribute("seed", std::int64_t{1} << 40);
    table.attribute("gains", values);
    table.attribute("ratio", 0.2);  // the later value counts
    root.group("cases").group("again");
    table.scalar("residual", 19.9, {"um", "largest residual"});
    table.list("frequency", values, {"Hz", "frequency"});
    table.list("gain", values, {"1", "amplitude ratio"}, "frequency");
    out.commit();
  }
  const InputFile in(path("out.h5"));
  EXPECT_EQ(in.text("/", "Conventions"), "CF-1.8");
  EXPECT_EQ(in.text("/cases/table", "program"), big);
  EXPECT_EQ(in.text("/cases/table", "empty"), "");
  EXPECT_EQ(in.number("/cases/table", "ratio"), 0.2);
  EXPECT_EQ(in.number("/cases/table", "seed"), 1099511627776.0);
  EXPECT_EQ(in.numbers("/cases/table", "gains"), std::vector<double>(values.begin(), values.end()));
  EXPECT_EQ(in.groups("/cases"), (std::vector<std::string>{"table", "again"}));
  EXPECT_EQ(in.datasets("/cases/table"),
            (std::vector<std::string>{"residual", "frequency", "gain"}));
  EXPECT_TRUE(in.shape("/cases/table/residual").empty());
  EXPECT_EQ(in.values("/cases/table/residual"), std::vector<double>{19.9});
  EXPECT_EQ(in.values("/cases/table/gain"), std::vector<double>(values.begin(), values.end()));
  EXPECT_EQ(in.text("/cases/table/gain", "units"), "1");
  EXPECT_TRUE(in.has("/cases/table"));
  EXPECT_FALSE(in.has("/cases/none/servo"));
  EXPECT_FALSE(in.has_attribute("/cases", "program"));
}

TEST_F(Hdf5File, GivesBackTextsOfAnyLength) {
  std::string big;
  while (big.size() < 2 * StoredText::kPiece) big += std::to_string(big.size()) + "\n";
  big += "the end";
  for (const std::size_t most_in_memory : {std::size_t{0}, StoredText::kMaxInMemory}) {
    {
      OutputFile out(path("out.h5"), true);
      Hdf5Group inputs = out.root().group("inputs");
      inputs.write_text("long", StoredText(big, most_in_memory));
      inputs.write_text("short", StoredText("G1 X1\n", most_in_memory));
      inputs.write_text("none", StoredText());
      out.commit();
    }
    const InputFile in(path("out.h5"));
    EXPECT_TRUE(in.stored_text("/inputs", "long").all() == big);
    EXPECT_EQ(in.shape("/inputs/long"), std::vector<std::size_t>{big.size()});
    EXPECT_EQ(in.stored_text("/inputs", "short").all(), "G1 X1\n");
    EXPECT_EQ(in.text("/inputs", "short"), "G1 X1\n");
    EXPECT_TRUE(in.stored_text("/inputs", "none").empty());
    EXPECT_EQ(message([&] { in.stored_text("/inputs", "other"); }),
              "out.h5: error: '/inputs' has no attribute 'other'");
  }
}

TEST_F(Hdf5File, HasItsNameOnlyAfterCommit) {
  {
    OutputFile out(path("out.h5"), false);
    out.root().attribute("n", 1.0);
    EXPECT_FALSE(fs::exists(path("out.h5")));
    EXPECT_TRUE(fs::exists(path("out.h5.partial")));
    out.commit();
    EXPECT_TRUE(fs::exists(path("out.h5")));
    EXPECT_FALSE(fs::exists(path("out.h5.partial")));
  }
  EXPECT_EQ(InputFile(path("out.h5")).number("/", "n"), 1.0);
}

TEST_F(Hdf5File, WithoutCommitThePartialFileStaysReadable) {
  {
    OutputFile out(path("out.h5"), false);
    out.root().attribute("n", 1.0);
  }
  EXPECT_FALSE(fs::exists(path("out.h5")));
  EXPECT_EQ(InputFile(path("out.h5.partial")).number("/", "n"), 1.0);
}

TEST_F(Hdf5File, IsNotOverwrittenWithoutForce) {
  std::ofstream(path("out.h5")) << "precious";
  EXPECT_EQ(message([&] { OutputFile(path("out.h5"), false); }),
            "out.h5: error: exists; use --force to overwrite");
  EXPECT_FALSE(fs::exists(path("out.h5.partial")));
  {
    OutputFile out(path("out.h5"), true);
    EXPECT_EQ(fs::file_size(path("out.h5")), 8u);  // untouched until the commit
    out.commit();
  }
  EXPECT_TRUE(InputFile(path("out.h5")).has("/"));
}

TEST_F(Hdf5File, KeepsWhatAnEndedRunLeft) {
  { const OutputFile out(path("out.h5"), false); }
  EXPECT_EQ(message([&] { OutputFile(path("out.h5"), false); }),
            "out.h5.partial: error: exists, left by an unfinished run; use --force to overwrite");
  EXPECT_EQ(message([&] { OutputFile(path("out.h5"), true); }), "no error");
}

TEST_F(Hdf5File, IsNotOverwrittenIfItAppearsDuringTheRun) {
  OutputFile out(path("out.h5"), false);
  std::ofstream(path("out.h5")) << "precious";
  EXPECT_EQ(message([&] { out.commit(); }), "out.h5: error: exists; use --force to overwrite");
  EXPECT_EQ(fs::file_size(path("out.h5")), 8u);
  EXPECT_TRUE(InputFile(path("out.h5.partial")).has("/"));
}

TEST_F(Hdf5File, IsLockedByTheLibraryOrByItsWriter) {
  for (const char* const use : {"TRUE", "BEST_EFFORT", "FALSE", "on", ""}) {
    setenv("HDF5_USE_FILE_LOCKING", use, 1);
    const OutputFile out(path("out.h5"), true);
    EXPECT_EQ(system::writer_of(path("out.h5.partial")), system::Writer::alive) << use;
    EXPECT_EQ(message([&] { OutputFile(path("out.h5"), true); }),
              "out.h5.partial: error: cannot be created: another process writes it");
  }
  unsetenv("HDF5_USE_FILE_LOCKING");
}

// Another process that may overwrite it would cut it while it is closed and waits for the disk.
TEST_F(Hdf5File, IsLockedUntilItHasItsName) {
  OutputFile out(path("out.h5"), false);
  out.root().list("numbers", std::vector<double>(1 << 20, 0.1), {"1", "numbers"});
  std::atomic<bool> is_free = false;
  {
    const std::jthread other([&](const std::stop_token& stop) {
      while (!stop.stop_requested() && !is_free) {
        const bool is_unlocked = system::writer_of(path("out.h5.partial")) == system::Writer::none;
        is_free = is_unlocked && fs::exists(path("out.h5.partial"));
      }
    });
    out.commit();
  }
  EXPECT_FALSE(is_free);
  EXPECT_EQ(system::writer_of(path("out.h5")), system::Writer::none);
}

TEST_F(Hdf5File, SaysWhyItCannotBeMade) {
  EXPECT_EQ(message([&] { OutputFile(path("no/out.h5"), false); }),
            "no/out.h5: error: folder 'no' does not exist");
  fs::create_directory(path("out.h5.partial"));
  EXPECT_EQ(message([&] { OutputFile(path("out.h5"), true); }),
            "out.h5.partial: error: cannot be created: Is a directory");
  EXPECT_THROW(OutputFile(path("out.h5"), true), system::SystemError);
}

TEST_F(Hdf5File, SaysWhatItLacks) {
  {
    OutputFile out(path("out.h5"), false);
    Hdf5Group group = out.root().group("g");
    group.labels("xyz", "XYZ", "direction");
    group.scalar("x", 1.0, {"m", "x"});
    group.attribute("many", std::array{1.0, 2.0});
    out.commit();
  }
  const InputFile in(path("out.h5"));
  EXPECT_EQ(message([&] { in.values("/g/y"); }), "out.h5: error: has no '/g/y'");
  EXPECT_EQ(message([&] { in.groups("/cases/a"); }), "out.h5: error: has no '/cases/a'");
  EXPECT_EQ(message([&] { in.values("/g"); }), "out.h5: error: '/g' is not a dataset");
  EXPECT_EQ(message([&] { in.groups("/g/x"); }), "out.h5: error: '/g/x' is not a group");
  EXPECT_EQ(message([&] { in.values("/g/xyz"); }), "out.h5: error: '/g/xyz' does not hold numbers");
  EXPECT_EQ(message([&] { in.text("/g", "program"); }),
            "out.h5: error: '/g' has no attribute 'program'");
  EXPECT_EQ(message([&] { in.text("/g", "many"); }),
            "out.h5: error: attribute 'many' of '/g' is not a string");
  EXPECT_EQ(message([&] { in.number("/g/x", "units"); }),
            "out.h5: error: attribute 'units' of '/g/x' is not a number");
  EXPECT_EQ(message([&] { in.number("/g", "many"); }),
            "out.h5: error: attribute 'many' of '/g' has 2 numbers instead of one");
}

TEST_F(Hdf5File, RefusesWhatIsNoHdf5File) {
  std::ofstream(path("text.h5")) << "title = 'no'\n";
  EXPECT_EQ(message([&] { InputFile(path("text.h5")); }), "text.h5: error: is not an HDF5 file");
  EXPECT_EQ(message([&] { InputFile(path("none.h5")); }),
            "none.h5: error: cannot be read: No such file or directory");
  {
    OutputFile out(path("out.h5"), false);
    out.root().attribute("n", 1.0);
    out.commit();
  }
  fs::resize_file(path("out.h5"), fs::file_size(path("out.h5")) / 2);
  EXPECT_EQ(message([&] { InputFile(path("out.h5")); }).substr(0, 30),
            "out.h5: error: cannot be read:");
}

}  // namespace
}  // namespace servomill::sim::records::hdf5_file_test
