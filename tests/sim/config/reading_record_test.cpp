#include "sim/config/reading_record.h"

#include <gtest/gtest.h>

namespace servomill::sim::config::reading_record_test {
namespace {

std::string errors_of(ReadingRecord& record) {
  try {
    record.finish();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ReadingRecord, KeysThatNobodyReadAreErrors) {
  const Document document = Document::from_text("Kv = 1\nkp = 2\nnew = 3\n", "s.toml");
  ReadingRecord record(document);
  record.open(document.root(), "");
  for (const char* key : {"Kv", "Kp", "new"}) record.know(document.root(), key);
  record.read(document.root(), "Kv");
  EXPECT_EQ(errors_of(record),
            "s.toml:2:1: error: kp is not known; did you mean 'Kp'?\n"
            "s.toml:3:1: error: new is not used here");
}

TEST(ReadingRecord, UnreadKeysAreFoundInTheTablesOfLists) {
  const Document document = Document::from_text("case = [{ a = 1 }, { b = 2 }]", "s.toml");
  ReadingRecord record(document);
  record.open(document.root(), "");
  record.read(document.root(), "case");
  const Value& list = *document.root().find("case");
  record.open(list.children[0], "case[0]");
  record.read(list.children[0], "a");
  record.open(list.children[1], "case[1]");
  EXPECT_EQ(errors_of(record), "s.toml:1:22: error: case[1].b is not known");
}

TEST(ReadingRecord, TheRestOfAFaultyTableIsLeftAlone) {
  const Document document = Document::from_text("kind = 'x'\nother = 2\n", "s.toml");
  ReadingRecord record(document);
  record.open(document.root(), "");
  record.read(document.root(), "kind");
  record.fault(*document.root().find("kind"), "kind", "must be one of a, b");
  record.skip_rest(document.root());
  EXPECT_EQ(record.faults(), 1u);
  EXPECT_EQ(errors_of(record), "s.toml:1:8: error: kind = 'x'; must be one of a, b");
}

TEST(ReadingRecord, FilesStayInTheOrderOfTheirFirstError) {
  const Document document = Document::from_text("", "s.toml");
  ReadingRecord record(document);
  record.fault(Place{"m.toml", 2}, "first");
  record.fault(Place{"s.toml", 1}, "second");
  record.fault(Place{"m.toml", 1}, "third");
  EXPECT_EQ(errors_of(record),
            "m.toml:1: error: third\nm.toml:2: error: first\ns.toml:1: error: second");
}

TEST(ReadingRecord, ADocumentWithoutErrorsEndsQuietly) {
  const Document document = Document::from_text("", "s.toml");
  ReadingRecord record(document);
  EXPECT_EQ(errors_of(record), "");
}

}  // namespace
}  // namespace servomill::sim::config::reading_record_test
