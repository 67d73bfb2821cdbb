// Runs a fuzz target over files, without libFuzzer:
//   fuzz_gcode FILE|FOLDER...
// A crash, a broken law or too long a time ends it; the last name printed is that of the input.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "tests/fuzz/fuzz.h"

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_of(int argc, char** argv) {
  std::vector<fs::path> files;
  for (int i = 1; i < argc; ++i) {
    if (!fs::is_directory(argv[i])) {
      files.emplace_back(argv[i]);
      continue;
    }
    for (const auto& entry : fs::recursive_directory_iterator(argv[i])) {
      if (entry.is_regular_file()) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<fs::path> files = files_of(argc, argv);
  for (const fs::path& file : files) {
    fmt::print("{}\n", file.string());
    std::fflush(stdout);
    std::ifstream in(file, std::ios::binary);
    servomill::fuzz::require(in.good(), "an input can be read");
    servomill::fuzz::run_in_time(std::string{std::istreambuf_iterator<char>(in), {}});
  }
  fmt::print("{} inputs\n", files.size());
  return files.empty() ? 1 : 0;
}
