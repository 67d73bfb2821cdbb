#include <gtest/gtest.h>

#include <algorithm>

#include "controllers/conversational/conversational.h"
#include "controllers/gcode/reader.h"
#include "controllers/gcode/readers/differences.h"
#include "controllers/siemens/siemens.h"
#include "sim/evaluation/quantity.h"
#include "sim/input/listings.h"
#include "strategies/registry.h"

namespace servomill::sim::input::listings_json_test {
namespace {

TEST(ListingsJson, HaveAnObjectForEveryEntry) {
  EXPECT_EQ(strategies_json().size(), strategies::names().size());
  EXPECT_EQ(quantities_json().size(), evaluation::quantities().size());
  EXPECT_EQ(reader_rules_json().size(), controllers::reader_rules().size() +
                                            controllers::conversational::readings().size() +
                                            controllers::siemens::readings().size() +
                                            2 * controllers::word_differences().size());
}

TEST(ListingsJson, HaveTheKeysOfAStrategy) {
  const std::vector<std::string> all = strategies_json();
  EXPECT_TRUE(std::any_of(all.begin(), all.end(), [](const std::string& one) {
    return one.find(R"({"key": "cutoff_Hz", )") != std::string::npos &&
           one.find(R"("is_number": true, "unit": "Hz", "min": 0.1, "max": 1000, "words": [], )"
                    R"("default": "100"})") != std::string::npos;
  }));
}

// A bound of 1e300 is none.
TEST(ListingsJson, HaveNullForBoundsThatThereAreNot) {
  for (const std::string& one : strategies_json()) {
    EXPECT_EQ(one.find("e+300"), std::string::npos) << one;
  }
}

}  // namespace
}  // namespace servomill::sim::input::listings_json_test
