#include "sim/recordings/xml_document.h"

#include <gtest/gtest.h>

#include "plant/vocabulary/input_error.h"

namespace servomill::sim::recordings::xml_document_test {
namespace {

TEST(XmlDocument, FaultsHaveTheirLine) {
  const XmlDocument document("<a>\n <b>12.5</b>\n <c>x</c>\n</a>\n", "a.xml");
  const auto root = document.child("a");
  EXPECT_EQ(document.number(root.child("b"), "b"), 12.5);
  try {
    document.number(root.child("c"), "c");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "a.xml:3: error: <c>: 'c' is 'x', which is not a number");
  }
  EXPECT_THROW(document.number(root.child("d"), "d"), InputError);
}

TEST(XmlDocument, CutOneIsRefused) {
  try {
    const XmlDocument document("<a>\n <b>12", "a.xml");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find("a.xml:2: error: is not complete XML: "), 0u)
        << error.what();
  }
}

TEST(XmlDocument, IsRecognisedByItsFirstSign) {
  EXPECT_TRUE(is_xml("\n <a/>"));
  EXPECT_FALSE(is_xml("a<b"));
  EXPECT_FALSE(is_xml(""));
}

}  // namespace
}  // namespace servomill::sim::recordings::xml_document_test
