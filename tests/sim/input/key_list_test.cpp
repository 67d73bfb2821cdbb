/// The list of keys is what the readers ask for.
#include "sim/input/key_list.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "plant/vocabulary/input_error.h"

namespace servomill::sim::input::key_list_test {
namespace {

// Read once: the readers go over all specimens each time.
const std::vector<KeyEntry>& all_keys() {
  static const std::vector<KeyEntry> kKeys = list_keys();
  return kKeys;
}

KeyEntry entry(const std::string& section, const std::string& key) {
  for (const KeyEntry& one : all_keys()) {
    if (one.section == section && one.key == key) return one;
  }
  ADD_FAILURE() << "no key " << key << " in " << section;
  return {};
}

std::string facts(const std::string& section, const std::string& key) {
  const KeyEntry one = entry(section, key);
  return one.type + "; " + one.range + "; " + one.presence;
}

TEST(KeyList, NamesEveryKeyOnce) {
  std::vector<std::string> names;
  for (const KeyEntry& one : all_keys()) names.push_back(one.section + "." + one.key);
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
  EXPECT_GT(names.size(), 300U);
}

// Units and bounds as the readers have them: in the unit of the key, or else in SI.
TEST(KeyList, HasTypeUnitRangeAndDefault) {
  EXPECT_EQ(facts("machine.nc", "Kv"), "number in 1/s; > 0; required");
  EXPECT_EQ(facts("program", "feed_override"), "number; > 0; default 1");
  EXPECT_EQ(facts("record", "resolution_nm"), "number in nm; >= 0 and <= 1000; default 0.001");
  EXPECT_EQ(facts("record", "compression"), "integer; >= 0 and <= 9; default 1");
  EXPECT_EQ(facts("record", "storage"), "\"float64\" | \"float32\"; ; default \"float64\"");
  EXPECT_EQ(facts("record", "uncorrectable"), "true | false; ; default false");
  EXPECT_EQ(facts("program", "tool"), "list of tables; ; optional");
  EXPECT_EQ(facts("machine.axis.X", "moving_mass"), "number in kg; > 0; required");
  EXPECT_EQ(facts("machine.axis.X", "moving_inertia"), "number in kg m^2; > 0; required");
  EXPECT_EQ(facts("case.strategy.table", "spacing_mm"), "number in mm; >= 0.0001; default 1.6384");
  EXPECT_EQ(entry("machine.axis.X", "moving_inertia").unit, "kg m^2");
  EXPECT_EQ(entry("record", "compression").unit, "");
}

TEST(KeyList, TellsKeysThatMayBeAbsentFromRequiredOnes) {
  EXPECT_EQ(entry("program", "file").presence, "required");
  EXPECT_EQ(entry("machine.axis.X", "travel_mm").presence, "optional");
  EXPECT_EQ(entry("machine.axis.X", "stiffness").presence, "required in some cases");
  EXPECT_EQ(entry("machine.axis.X", "current_slew").presence, "optional");
}

// Such a default must not be printed as the number that a specimen happens to have.
TEST(KeyList, PrintsNoNumberForADefaultThatFollowsFromOtherKeys) {
  for (const auto& [section, key] : {std::pair{"machine.axis.X", "Kv"},
                                     {"machine.axis.X", "crossover_Hz"},
                                     {"machine.axis.X.friction", "coulomb_negative"},
                                     {"machine.axis.X.friction", "viscous_negative"},
                                     {"machine.nc", "position_period_us"},
                                     {"program.tool", "flute_length_mm"},
                                     {"probe.circle", "to_deg"},
                                     {"case", "wear"},
                                     {"case", "cutting"}}) {
    EXPECT_EQ(entry(section, key).presence, "default depends on other keys") << key;
  }
  EXPECT_EQ(entry("program.tool", "corner_radius_mm").range, "bounds depend on other keys");
}

TEST(KeyList, GivesASectionWithThoseBelowIt) {
  for (const KeyEntry& one : keys_of("top")) EXPECT_EQ(one.section, "") << one.key;
  std::set<std::string> sections;
  for (const KeyEntry& one : keys_of("machine.axis.X")) sections.insert(one.section);
  EXPECT_TRUE(sections.contains("machine.axis.X"));
  EXPECT_TRUE(sections.contains("machine.axis.X.friction"));
  EXPECT_FALSE(sections.contains("machine.axis"));
}

TEST(KeyList, KeysOfEveryAxisAreThoseOfX) {
  const auto size_of = [](const char* section) { return keys_of(section).size(); };
  EXPECT_EQ(size_of("machine.axis.Y"), size_of("machine.axis.X"));
  EXPECT_EQ(size_of("machine.axis.C.friction"), size_of("machine.axis.X.friction"));
}

TEST(KeyList, RefusesASectionThatThereIsNot) {
  try {
    keys_of("machine.nx");
    FAIL() << "must throw";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "servomill list keys: error: no section 'machine.nx'; did you mean 'machine.nc'?");
  }
}

}  // namespace
}  // namespace servomill::sim::input::key_list_test
