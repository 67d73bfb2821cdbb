#include "sim/system/json.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace servomill::sim::system::json_test {
namespace {

TEST(Json, EscapesWhatRfc8259Section7Forbids) {
  EXPECT_EQ(json_text("a\"b\\c\td\x01"), R"("a\"b\\c\u0009d\u0001")");
  EXPECT_EQ(json_text("\xC2\xB5m"), "\"\xC2\xB5m\"");  // UTF-8 stands as it is
}

TEST(Json, HasNoWordForInfinityAndNaN) {
  EXPECT_EQ(json_number(std::numeric_limits<double>::infinity()), "null");
  EXPECT_EQ(json_number(std::numeric_limits<double>::quiet_NaN()), "null");
  EXPECT_EQ(json_number(-0.1), "-0.1");
  EXPECT_EQ(json_number(1.0 / 3.0), "0.333333333");
}

TEST(Json, KeepsTheOrderOfItsMembers) {
  const std::string line = JsonObject()
                               .text("z", "last \"letter\"")
                               .number("a", 2.5)
                               .integer("n", 7u)
                               .boolean("stable", false)
                               .text_or_null("axis", "")
                               .raw("list", json_list(std::vector<std::string>{"1", "null"}))
                               .line();
  EXPECT_EQ(line, R"({"z": "last \"letter\"", "a": 2.5, "n": 7, "stable": false, "axis": null, )"
                  R"("list": [1, null]})");
  EXPECT_EQ(JsonObject().line(), "{}");
  EXPECT_EQ(json_list({}), "[]");
}

TEST(Json, ListsTexts) {
  const std::vector<std::string> texts = {"X", "say \"X\""};
  EXPECT_EQ(json_texts(texts), R"(["X", "say \"X\""])");
  EXPECT_EQ(json_texts(texts, JsonSpacing::none), R"(["X","say \"X\""])");
}

TEST(Json, CanDoWithoutBlanks) {
  const std::vector<std::string> items = {"1", "2"};
  EXPECT_EQ(JsonObject(JsonSpacing::none)
                .integer("a", 1)
                .fixed("b", -0.00004, 4)
                .fixed("c", std::numeric_limits<double>::quiet_NaN(), 4)
                .raw("d", json_list(items, JsonSpacing::none))
                .line(),
            R"({"a":1,"b":-0.0000,"c":null,"d":[1,2]})");
}

}  // namespace
}  // namespace servomill::sim::system::json_test
