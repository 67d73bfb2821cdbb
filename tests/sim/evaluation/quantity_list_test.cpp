#include "sim/evaluation/quantity.h"

#include <gtest/gtest.h>

#include <set>

#include "sim/evaluation/path_signal.h"

namespace servomill::sim::evaluation::quantity_list_test {
namespace {

TEST(Quantities, AreNamedOnceAndExplained) {
  const auto names = quantity_names();
  EXPECT_EQ(std::set<std::string_view>(names.begin(), names.end()).size(), names.size());
  for (const QuantityEntry& entry : quantities()) {
    EXPECT_EQ(&quantity_entry(entry.name), &entry);
    EXPECT_FALSE(entry.help.empty() || entry.unit.empty()) << entry.name;
    EXPECT_NE(entry.evaluate, nullptr) << entry.name;
  }
  EXPECT_EQ(find_quantity("no_such_quantity"), nullptr);
}

// Features of the part have kinds; a fit, and bars, belong to one family each.
TEST(Quantities, HaveTheKeysOfOneFamily) {
  for (const QuantityEntry& entry : quantities()) {
    const int families = (entry.circles > 0) + entry.is_r_test + (entry.probes > 0);
    EXPECT_LE(families, 1) << entry.name;
    EXPECT_EQ(entry.kinds.empty(), entry.probes == 0) << entry.name;
    EXPECT_TRUE(entry.probes > 0 || !entry.has_fit) << entry.name;
    EXPECT_TRUE(entry.is_r_test || entry.bars == BallBars::none) << entry.name;
    EXPECT_TRUE(entry.is_r_test || !entry.identifies) << entry.name;
    EXPECT_FALSE(entry.is_of_program && entry.needs_baseline) << entry.name;
  }
}

TEST(Quantities, AreDerivedFromSignals) {
  for (const QuantityEntry& entry : quantities()) {
    EXPECT_EQ(has_path_signal(entry.name), entry.signal != nullptr) << entry.name;
    if (entry.derived_from.empty()) continue;
    EXPECT_TRUE(has_path_signal(entry.derived_from)) << entry.name;
    EXPECT_EQ(quantity_entry(entry.derived_from).needs_baseline, entry.needs_baseline)
        << entry.name;
  }
  EXPECT_FALSE(has_path_signal("no_such_quantity"));
}

}  // namespace
}  // namespace servomill::sim::evaluation::quantity_list_test
