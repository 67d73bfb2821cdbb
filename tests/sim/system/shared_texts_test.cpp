#include "sim/system/shared_texts.h"

#include <gtest/gtest.h>

namespace servomill::sim::system::shared_texts_test {
namespace {

SharedTexts::Text text(const char* of) { return std::make_shared<const StoredText>(of); }

TEST(SharedTexts, EqualTextsAreOne) {
  SharedTexts texts;
  const auto one = text("G1 X1"), other = text("G1 X2"), same = text("G1 X1");
  EXPECT_EQ(texts.shared(one), one);
  EXPECT_EQ(texts.shared(other), other);
  EXPECT_EQ(texts.shared(same), one);
  EXPECT_EQ(texts.shared(one), one);
}

TEST(SharedTexts, HoldsNone) {
  SharedTexts texts;
  auto one = text("G1 X1");
  const std::weak_ptr<const StoredText> held = texts.shared(one);
  one.reset();
  EXPECT_TRUE(held.expired());
  const auto same = text("G1 X1");
  EXPECT_EQ(texts.shared(same), same);
}

}  // namespace
}  // namespace servomill::sim::system::shared_texts_test
