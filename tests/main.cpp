// The test program of a folder. Called by the name of one of its files, through a link, it runs the
// tests of that file alone.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <map>
#include <string>

namespace {

std::string stem_of(const std::string& file) { return std::filesystem::path(file).stem().string(); }

// Names of all tests, each with the file that defines it.
std::multimap<std::string, std::string> files_of_tests() {
  std::multimap<std::string, std::string> files;
  const auto& all = *testing::UnitTest::GetInstance();
  for (int s = 0; s < all.total_test_suite_count(); ++s) {
    const auto& suite = *all.GetTestSuite(s);
    for (int t = 0; t < suite.total_test_count(); ++t) {
      const auto& test = *suite.GetTestInfo(t);
      files.emplace(std::string(suite.name()) + "." + test.name(), stem_of(test.file()));
    }
  }
  return files;
}

// A filter that selects the tests of one file; empty if it has none, or shares a name with another.
std::string filter_of(const std::string& stem) {
  const auto files = files_of_tests();
  std::string filter;
  for (const auto& [name, file] : files) {
    if (file != stem) continue;
    if (files.count(name) != 1) {
      std::fprintf(stderr, "%s: two files of the folder have a test %s\n", stem.c_str(),
                   name.c_str());
      return "";
    }
    filter += (filter.empty() ? "" : ":") + name;
  }
  if (filter.empty()) std::fprintf(stderr, "%s: no test in a file of this name\n", stem.c_str());
  return filter;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const std::string called = std::filesystem::path(argv[0]).filename().string();
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").filename().string();
  if (called != program && GTEST_FLAG_GET(filter) == "*") {
    const std::string filter = filter_of(called);
    if (filter.empty()) return 1;
    GTEST_FLAG_SET(filter, filter);
  }
  return RUN_ALL_TESTS();
}
