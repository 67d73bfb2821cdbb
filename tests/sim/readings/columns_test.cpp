#include "sim/readings/columns.h"

#include <gtest/gtest.h>

#include "tests/sim/readings/reading_files.h"
#include "tests/text.h"

namespace servomill::sim::readings::columns_test {
namespace {

class Columns : public testing::Test {
 protected:
  Table read(const std::string& text) { return read_table(files_.write("a.csv", text)); }
  std::string faults(const std::string& text) {
    return fault_messages([&] { read(text); });
  }
  ReadingFiles files_;
};

TEST_F(Columns, TakesTheUnitFromTheEndOfTheName) {
  EXPECT_EQ(parse_column("deviation_um", 1).name, "deviation");
  EXPECT_EQ(parse_column("deviation_um", 1).unit.factor, 1e-6);
  EXPECT_EQ(parse_column("C_deg", 1).name, "C");
  EXPECT_EQ(parse_column("temperature_degC", 1).name, "temperature_degC");
  EXPECT_EQ(parse_column("p1", 1).name, "p1");
}

TEST_F(Columns, ReadsAnySeparatorAndADecimalComma) {
  for (const char* text : {"X_mm,deviation_um\n1.5,-2\n", "X_mm;deviation_um\n1,5;-2\n",
                           "X_mm\tdeviation_um\n1.5\t-2\n", "X_mm deviation_um\n1.5 -2\n",
                           "# made\nX_mm; deviation_um\n\n1.5; -2\n"}) {
    const Table table = read(text);
    std::vector<Fault> faults;
    ASSERT_EQ(table.rows.size(), 1u) << text;
    EXPECT_EQ(table.number(table.rows[0], *table.find("X"), faults), 1.5e-3) << text;
    EXPECT_EQ(table.number(table.rows[0], *table.find("deviation"), faults), -2e-6) << text;
    EXPECT_TRUE(faults.empty());
  }
}

// Names as loggers write them: in any case, with the unit in brackets, other words for the same.
TEST_F(Columns, ReadsHeadingsAsLogsHaveThem) {
  const Table table = read(
      "\xEF\xBB\xBF% axis Y\n// second run\nDirection,Target [mm],Cycle,Actual "
      "(mm),P1\n+,1,1,1.5,2\n");
  std::vector<std::string> names;
  for (const Column& column : table.columns) names.push_back(column.name);
  EXPECT_EQ(names, (std::vector<std::string>{"direction", "target", "run", "position", "p1"}));
  EXPECT_EQ(table.columns[1].unit.factor, 1e-3);
  EXPECT_EQ(parse_column("X_mm", 1).name, "X");
  EXPECT_EQ(parse_column("x_mm", 1).name, "x");
}

TEST_F(Columns, SaysWhereATitleStandsInFrontOfTheNames) {
  EXPECT_EQ(faults("ISO 230-2, axis Y\nX_mm;deviation_um\n1;2\n3;4\n"),
            "no row has the 2 fields of the header \"ISO 230-2 axis Y\"; lines before "
            "the header must start with #\n");
}

TEST_F(Columns, NamesLineAndColumnOfTextAmongNumbers) {
  const Table table = read("X_mm,deviation_um\n1.5,two\n");
  std::vector<Fault> faults;
  table.number(table.rows[0], *table.find("deviation"), faults);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(to_string(faults[0]),
            files_.path("a.csv") + ":2:5: error: deviation_um = two; must be a number");
}

TEST_F(Columns, RefusesRowsOfAnotherLengthAndNamesThatAppearTwice) {
  EXPECT_EQ(faults("X_mm,X_um,deviation_um\n1,2\n1,2,3,4\n"),
            "column X_um appears twice\n"
            "has 2 fields; the header has 3\n"
            "has 4 fields; the header has 3\n");
  EXPECT_EQ(faults("# nothing\n"), "is empty; expected a header line\n");
  EXPECT_EQ(faults("X_mm,deviation_um\n"), "has no readings after its header\n");
}

}  // namespace
}  // namespace servomill::sim::readings::columns_test
