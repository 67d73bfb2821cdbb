#include "strategies/plugin_file.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "strategies/registry.h"

namespace servomill::strategies::plugin_file_test {
namespace {

Entry entry(std::string_view name) {
  Entry out;
  out.name = name;
  return out;
}

const Entry kFirst = entry("plugin_file_test"), kSecond = entry("plugin_file_test"),
            kOther = entry("plugin_file_test_other"), kTaken = entry("gcode");

LoadedPlugin plugin(const char* file, std::vector<const Entry*> entries) {
  return {
      .file = file, .name = "test", .version = "1", .checksum = 0, .entries = std::move(entries)};
}

TEST(PluginFile, AddsStrategiesOfThisProcess) {
  add_plugin(plugin("test.py", {&kFirst}));
  EXPECT_EQ(find("plugin_file_test"), &kFirst);
  EXPECT_TRUE(is_loaded_by_name("elsewhere/test.py"));
  const auto all = names();
  EXPECT_EQ(std::count(all.begin(), all.end(), "plugin_file_test"), 1);
}

TEST(PluginFile, ReplacesThoseOfTheSameFile) {
  add_plugin(plugin("test.py", {&kFirst}));
  add_plugin(plugin("test.py", {&kSecond}));
  EXPECT_EQ(find("plugin_file_test"), &kSecond);
  add_plugin(plugin("test.py", {&kOther}));
  EXPECT_EQ(find("plugin_file_test"), nullptr);
}

TEST(PluginFile, RefusesNamesOfOthers) {
  add_plugin(plugin("test.py", {&kFirst}));
  EXPECT_THROW(add_plugin(plugin("other.py", {&kSecond})), InputError);
  EXPECT_THROW(add_plugin(plugin("test.py", {&kTaken})), InputError);
  EXPECT_EQ(find("plugin_file_test"), &kFirst);
}

}  // namespace
}  // namespace servomill::strategies::plugin_file_test
