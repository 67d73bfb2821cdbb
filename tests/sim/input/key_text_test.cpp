#include "sim/input/key_text.h"

#include <gtest/gtest.h>

#include <vector>

namespace servomill::sim::input::key_text_test {
namespace {

const std::vector<KeyEntry>& hardware() {
  static const std::vector<KeyEntry> kKeys = keys_of("feedback_hardware");
  return kKeys;
}

TEST(KeyText, HasOneLineAKey) {
  EXPECT_EQ(as_text(hardware()),
            "[feedback_hardware]\n  connected                true: the hardware is in the signal "
            "path of all cases, also of those that do not use it [true | false; default false]\n  "
            "signal_delay_us          delay from the scale to the position feedback of the NC "
            "[number in us, >= 0 and <= 6e+07; default 10]\n  model_period_us          evaluation "
            "period of the error model; its value acts one period later [number in us, > 0 and <= "
            "6e+07; default 60]\n");
  EXPECT_TRUE(as_text(keys_of("top")).starts_with("[top]\n  based_on "));
  EXPECT_NE(as_text(keys_of("machine.axis.X")).find("\n\n[machine.axis.X.friction]\n"),
            std::string::npos);
}

// A bar would end the cell of a table, an underscore begin emphasis.
TEST(KeyText, EscapesWhatMarkdownReads) {
  const std::vector<KeyEntry> keys = {
      {"machine.nc", "filter", "\"a\" | \"b_1\"", "", "default \"a\"", "chain [w C' t]"}};
  const std::string page = as_markdown(keys);
  EXPECT_TRUE(
      page.ends_with("\n## machine.nc\n\n"
                     "| key | meaning | type | range | presence |\n"
                     "|---|---|---|---|---|\n"
                     "| `filter` | chain \\[w C' t] | \"a\" \\| \"b\\_1\" |  | default \"a\" |\n"))
      << page;
}

TEST(KeyText, HasOneJsonObjectAKey) {
  EXPECT_EQ(keys_json(hardware()).back(),
            (R"({"section": "feedback_hardware", "key": "model_period_us", )"
             R"("help": "evaluation period of the error model; its value acts one period later", )"
             R"("type": "number in us", "unit": "us", "range": "> 0 and <= 6e+07", )"
             R"("presence": "default 60", "default": "60"})"));
  const std::vector<KeyEntry> follows = {
      {"", "title", "string", "", "default depends on other keys", "title of the experiment"}};
  EXPECT_EQ(
      keys_json(follows).front(),
      R"({"section": null, "key": "title", "help": "title of the experiment", "type": "string", )"
      R"("unit": null, "range": null, "presence": "default depends on other keys", )"
      R"("default": null})");
}

}  // namespace
}  // namespace servomill::sim::input::key_text_test
