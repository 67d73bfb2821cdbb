/// Every key has its sentence, and every sentence its key.
#include "sim/input/key_help.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "sim/input/key_list.h"

namespace servomill::sim::input::key_help_test {
namespace {

TEST(KeyHelp, HasASentenceForEveryKeyAndNoneForOthers) {
  std::set<std::string> keys;
  for (const KeyEntry& one : list_keys()) {
    keys.insert(one.section + "." + one.key);
    EXPECT_FALSE(one.help.empty()) << one.section << "." << one.key;
  }
  std::set<std::string> seen;
  for (const auto& rows : {scenario_key_help(), machine_key_help()}) {
    for (const KeyHelp& row : rows) {
      const std::string name = std::string(row.section) + "." + std::string(row.key);
      EXPECT_TRUE(keys.contains(name)) << name << " is a key that no reader knows";
      EXPECT_TRUE(seen.insert(name).second) << name << " has two sentences";
    }
  }
}

TEST(KeyHelp, KeysOfTheMachineLieInItsTable) {
  for (const KeyHelp& row : machine_key_help()) EXPECT_TRUE(row.section.starts_with("machine"));
  for (const KeyHelp& row : scenario_key_help()) EXPECT_FALSE(row.section.starts_with("machine"));
}

TEST(KeyHelp, EqualTablesShareTheirSentences) {
  EXPECT_EQ(help_of_key("machine.axis.X.motor", "period"),
            help_of_key("machine.axis.X.scale", "period"));
  EXPECT_EQ(help_of_key("case.work_offset", "X_mm"), help_of_key("program.work_offset", "X_mm"));
  EXPECT_EQ(help_of_key("machine.nc", "no_such_key"), "");
}

}  // namespace
}  // namespace servomill::sim::input::key_help_test
