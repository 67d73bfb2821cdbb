// Runs a fuzz target over files, without libFuzzer:
//   fuzz_gcode FILE|FOLDER...
// Exit status 1 if an input takes too long. A crash or a broken law ends it; the last name printed
// is that of the input.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "tests/fuzz/fuzz.h"

namespace {

namespace fs = std::filesystem;

constexpr double kMostSeconds = 1.0;  // of the processor, for 64 KiB and less

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

double seconds_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(fmt::format("{} cannot be read", file.string()));
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const std::clock_t begin = std::clock();
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()),
                         std::min(bytes.size(), servomill::fuzz::kMostBytes));
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<fs::path> files = files_of(argc, argv);
  int slow = 0;
  for (const fs::path& file : files) {
    fmt::print("{}\n", file.string());
    std::fflush(stdout);
    const double seconds = seconds_of(file);
    if (seconds <= kMostSeconds) continue;
    fmt::print("  took {:.2f} s; at most {:g} s is allowed\n", seconds, kMostSeconds);
    ++slow;
  }
  fmt::print("{} inputs, {} too slow\n", files.size(), slow);
  return files.empty() || slow > 0 ? 1 : 0;
}
