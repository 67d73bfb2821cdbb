#include "plant/vocabulary/scratch_file.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <numeric>

#include "plant/vocabulary/system_error.h"

namespace servomill::scratch_file_test {
namespace {

TEST(ScratchFile, ReturnsWhatWasAppended) {
  ScratchFile file("", "numbers");
  std::vector<int> one(1000), other(300), read(300);
  std::iota(one.begin(), one.end(), 0);
  std::iota(other.begin(), other.end(), 5000);
  EXPECT_EQ(file.append(bytes_of(std::as_const(one))), 0U);
  const std::uint64_t place = file.append(bytes_of(std::as_const(other)));
  EXPECT_EQ(place, 4000U);
  EXPECT_EQ(file.size(), 5200U);
  file.read(place, bytes_of(read));
  EXPECT_EQ(read, other);
  file.read(400, bytes_of(read));
  EXPECT_EQ(read.front(), 100);
}

TEST(ScratchFile, CountsTheBytesOfTemporaryFiles) {
  const std::uint64_t before = ScratchFile::temporary_bytes();
  const std::vector<std::uint8_t> hundred(100);
  ScratchFile elsewhere(".", "numbers");
  elsewhere.append(hundred);
  EXPECT_EQ(ScratchFile::temporary_bytes(), before);
  {
    ScratchFile one("", "numbers"), other("", "numbers");
    one.append(hundred);
    other.append(hundred);
    other.append(hundred);
    EXPECT_EQ(ScratchFile::temporary_bytes(), before + 300);
  }
  EXPECT_EQ(ScratchFile::temporary_bytes(), before);
}

TEST(ScratchFile, SaysWhatCannotBeStoredOrRead) {
  const auto message = [](const auto& action) -> std::string {
    try {
      action();
    } catch (const SystemError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message([] { ScratchFile("/nowhere/at/all", "numbers"); }),
            "/nowhere/at/all: error: numbers cannot be stored there: No such file or directory");
  const char* named = std::getenv("TMPDIR");
  const std::string before = named != nullptr ? named : "";
  ::setenv("TMPDIR", "/nowhere", 1);
  EXPECT_EQ(message([] { ScratchFile("", "numbers"); }),
            "/nowhere: error: numbers cannot be stored there: No such file or directory");
  before.empty() ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", before.c_str(), 1);
  ScratchFile file("", "numbers");
  std::vector<int> read(3);
  EXPECT_NE(message([&] { file.read(0, bytes_of(read)); }).find("numbers cannot be read"),
            std::string::npos);
}

}  // namespace
}  // namespace servomill::scratch_file_test
