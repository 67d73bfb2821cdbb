// Files of every kind with bytes changed, cut out and put in: each is read or refused, none hangs
// or crashes the program. SERVOMILL_DAMAGED_FILES sets how many of each kind.
#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/recordings/read_recording.h"
#include "sim/recordings/survey.h"
#include "sim/recordings/write_recording.h"
#include "tests/number_of.h"

namespace servomill::sim::recordings::damaged_files_test {
namespace {

class Damaged : public testing::Test {
 protected:
  Damaged() {
    std::string name = (std::filesystem::temp_directory_path() / "damaged_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = name;
  }
  ~Damaged() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::uint64_t below(std::uint64_t count) {
    return boost::random::uniform_int_distribution<std::uint64_t>(0, count - 1)(generator_);
  }

  // One to four changes at places that are drawn.
  std::string damaged(std::string bytes) {
    for (std::uint64_t change = below(4) + 1; change > 0 && !bytes.empty(); --change) {
      const std::size_t at = below(bytes.size());
      switch (below(5)) {
        case 0:
          bytes[at] = static_cast<char>(below(256));
          break;
        case 1:
          bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
          break;
        case 2:
          bytes.erase(at, below(16) + 1);
          break;
        case 3:
          bytes.insert(at, bytes.substr(below(bytes.size()), below(16) + 1));
          break;
        default:
          if (below(4) == 0) bytes.resize(at);
      }
    }
    return bytes;
  }

  // The number that was read in spite of the damage.
  int read_damaged(const std::string& whole, int count) {
    const std::string path = folder_ + "/record";
    int accepted = 0;
    for (int n = 0; n < count; ++n) {
      std::ofstream(path, std::ios::binary) << damaged(whole);
      try {
        const Recording recording = read_recording(path, "");
        survey(recording);
        ++accepted;
      } catch (const InputError&) {
        // refused: that is what it is for
      }
    }
    return accepted;
  }

  static std::string bytes_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }

  static Recording small() {
    Recording out;
    out.bases = {{"time", "s", {0.0, 0.1, 0.2, 0.3}}, {"frequency", "Hz", {1.0, 2.0, 3.0}}};
    out.channels = {{"q", "mm", {0.0, 1.0, 2.0, 3.0}, 0}, {"S", "", {1.0, 2.0, 4.0}, 1}};
    return out;
  }

  // A MAT file of level 5 with two vectors, as its makers describe it.
  static std::string mat_file() {
    std::string bytes = "MATLAB 5.0 MAT-file";
    bytes.resize(124, ' ');
    bytes += std::string("\x00\x01IM", 4);
    const auto word = [](std::string& to, std::uint32_t value) {
      for (int k = 0; k < 4; ++k) to += static_cast<char>(value >> (8 * k));
    };
    for (const char name : {'t', 'q'}) {
      std::string array;
      for (const std::uint32_t one : {6u, 8u, 6u, 0u, 5u, 8u, 1u, 5u, 1u, 1u}) word(array, one);
      array += name;
      array.resize(48);
      word(array, 9);
      word(array, 40);
      for (int k = 0; k < 5; ++k) {
        const double value = 0.25 * k;
        array.append(reinterpret_cast<const char*>(&value), sizeof value);
      }
      word(bytes, 14);
      word(bytes, static_cast<std::uint32_t>(array.size()));
      bytes += array;
    }
    return bytes;
  }

  int count_ = number_of("SERVOMILL_DAMAGED_FILES", 20);
  std::string folder_;
  boost::random::mt19937 generator_{7};
};

TEST_F(Damaged, Hdf5) {
  const std::string path = folder_ + "/whole.h5";
  write_recording(small(), path, false);
  EXPECT_EQ(read_recording(path, "").channels.size(), 2u);
  EXPECT_LT(read_damaged(bytes_of(path), count_), count_);
}

TEST_F(Damaged, Mat) {
  const std::string path = folder_ + "/whole.mat";
  std::ofstream(path, std::ios::binary) << mat_file();
  ASSERT_EQ(read_recording(path, "").channels.size(), 1u);
  EXPECT_LT(read_damaged(mat_file(), count_), count_);
}

TEST_F(Damaged, TextsOfControls) {
  const std::string texts[] = {
      "time [s],q [mm],I [A]\n0,0,1\n0.1,1,2\n0.2,2,1\n0.3,3,0\n",
      "%[GLOBAL]\n%VERSION=1\n%[CURVE1]\n%CHANNELTYPE=s actual\n%AXISTYPE=X\n%DIMENSION=mm\n"
      "%COUNT=3\n%CYCLETIME=3000\n%[DATA]\n0;1\n3000;2\n6000;3\n",
      "Sampling period is 1000000 nSec\nx 1.0 y 2.0\nx 1.5 y 2.5\nx 1.7 y 2.0\n",
      "X:pos 2024-05-01 10:00:00.000000 1.5\nX:pos 2024-05-01 10:00:00.100000 1.6\n",
      "0 1.0 2.0\n1 1.5 2.5\n2 1.6 2.6\n3 1.7 2.7\n",
      "<?xml version=\"1.0\"?><traceData><dataFrame><dataSignal id=\"f1\" interval=\"0.001\" "
      "name=\"a\" description=\"b\" unitsType=\"mm\"/><rec time=\"0\" f1=\"1\"/><rec "
      "time=\"0.001\" f1=\"2\"/></dataFrame></traceData>\n",
  };
  for (const std::string& text : texts) read_damaged(text, 20 * count_);
}

}  // namespace
}  // namespace servomill::sim::recordings::damaged_files_test
