#include "sim/config/reader.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <iostream>

namespace servomill::sim::config::reader_test {
namespace {

constexpr std::array<std::string_view, 3> kStrategies = {"feedback", "gcode", "table"};

// The text after `first` is read by `read`; gives all messages, one a line.
std::string faults(std::string_view text, const std::function<void(Reader&)>& read,
                   std::string_view set = "") {
  Document document = Document::from_text(text, "s.toml");
  if (!set.empty()) document.set(set);
  Reader root(document);
  try {
    read(root);
    root.finish();
  } catch (const InputError& error) {
    std::cout << error.what() << '\n';  // the gallery, for review
    return error.what();
  }
  return "no fault";
}

template <typename T>
T read_one(std::string_view text, const std::function<T(Reader&)>& read) {
  const Document document = Document::from_text(text, "s.toml");
  Reader root(document);
  T value = read(root);
  root.finish();
  return value;
}

double real(std::string_view text, std::string_view key, Quantity quantity) {
  return read_one<double>(text, [&](Reader& r) { return r.real(key, quantity); });
}

TEST(Reader, ReadsRowsOfAnyLength) {
  using Rows = std::vector<std::vector<double>>;
  EXPECT_EQ(read_one<Rows>("a = [[1, 2.5], [], [-3e-4]]", [](Reader& r) { return r.rows("a"); }),
            (Rows{{1.0, 2.5}, {}, {-3e-4}}));
}

// Lists in lists of a shape that another key should have given: that key has the fault.
TEST(Reader, AsksForNoShapeThatIsNotKnown) {
  const auto nested = [](std::vector<std::size_t> shape) {
    return faults("a = [[1, 2], [3, 4]]", [&](Reader& r) { r.nested("a", shape); });
  };
  EXPECT_EQ(nested({2, 2}), "no fault");
  EXPECT_EQ(nested({}), "no fault");
  EXPECT_EQ(nested({2, 0}), "no fault");
  EXPECT_EQ(nested({2, 3}),
            "s.toml:1:5: error: a = [[1, 2], [3, 4]]; must consist of 2 lists of 3 finite numbers");
}

TEST(Reader, ReadsTheExampleOfItsHeader) {
  const Document document = Document::from_text("[drives.Y]\nlead_mm = 20\n[nc]\n", "m.toml");
  Reader root(document);
  Reader drive = root.table("drives").table("Y");
  EXPECT_DOUBLE_EQ(drive.real("lead_mm", kLength, {above(0.0)}), 0.02);
  EXPECT_EQ(root.table("nc").real_or("Kv", 60.0, kRate, {above(0.0)}), 60.0);
  root.finish();
}

TEST(Quantities, AreInSiWhateverTheyAreWrittenIn) {
  EXPECT_DOUBLE_EQ(real("lead_mm = 20", "lead_mm", kLength), 0.02);
  EXPECT_DOUBLE_EQ(real("lead_mm = '0.02 m'", "lead_mm", kLength), 0.02);
  EXPECT_DOUBLE_EQ(real("time_constant_ms = '40 ms'", "time_constant_ms", kTime), 0.04);
  EXPECT_DOUBLE_EQ(real("Kv = 60", "Kv", kRate), 60.0);
  EXPECT_DOUBLE_EQ(real("Kv = '3.6 m/min/mm'", "Kv", kRate), 60.0);
  EXPECT_DOUBLE_EQ(real("Kv = '+3.6e0m/min/mm'", "Kv", kRate), 60.0);
  EXPECT_DOUBLE_EQ(real("max_rate_mm_per_s = 10.0", "max_rate_mm_per_s", kVelocity), 0.01);
  EXPECT_DOUBLE_EQ(real("C_deg = 180", "C_deg", kAngle), 3.141592653589793);
  EXPECT_EQ(real("feed_override = 1", "feed_override", kNumber), 1.0);
}

TEST(Reader, ReadsEveryType) {
  const Document document = Document::from_text(R"(
points = 256
on = true
type = "table"
sides = [1, "2 m", 3.5]
cases = ["a", "b"]
[[case]]
name = "x"
[[case]]
name = "y"
[map]
"#101" = 1.0
zeta = 2.0
)",
                                                "s.toml");
  Reader r(document);
  EXPECT_EQ(r.integer("points", {at_least(2), at_most(256)}), 256);
  EXPECT_EQ(r.integer_or("other", 7), 7);
  EXPECT_TRUE(r.boolean("on"));
  EXPECT_FALSE(r.boolean_or("off", false));
  EXPECT_EQ(r.text_or("title", "none"), "none");
  EXPECT_EQ(r.choice("type", kStrategies), 2u);
  EXPECT_EQ(r.choice_or("entry", 1, kStrategies), 1u);
  EXPECT_EQ(r.reals("sides", kLength), (std::vector<double>{1.0, 2.0, 3.5}));
  EXPECT_EQ(r.reals_or("more", {4.0}, kLength), std::vector<double>{4.0});
  EXPECT_EQ(r.texts("cases"), (std::vector<std::string>{"a", "b"}));
  EXPECT_TRUE(r.texts_or("tags", {}).empty());
  auto cases = r.tables("case");
  ASSERT_EQ(cases.size(), 2u);
  EXPECT_EQ(cases[0].text("name"), "x");
  EXPECT_EQ(cases[1].text("name"), "y");
  EXPECT_EQ(cases[1].path(), "case[1]");
  EXPECT_TRUE(r.tables_or_none("quantity").empty());
  EXPECT_EQ(r.table_or_empty("record").real_or("period_ms", 1e-3, kTime), 1e-3);
  Reader map = r.table("map");
  EXPECT_EQ(map.keys(), (std::vector<std::string>{"#101", "zeta"}));
  for (const std::string& key : map.keys()) map.real(key, kNumber);
  EXPECT_FALSE(r.has("sweep"));
  EXPECT_TRUE(r.is("map", Value::Type::table));
  r.finish();
}

TEST(Reader, HandsOutRawTablesAsRead) {
  const Document document = Document::from_text("[sweep]\n\"a.b\" = [1]\n", "s.toml");
  Reader r(document);
  ASSERT_NE(r.raw("sweep"), nullptr);
  EXPECT_EQ(r.raw("sweep")->children.at(0).key, "a.b");
  EXPECT_EQ(r.raw("absent"), nullptr);
  r.finish();
}

// The gallery: wrong inputs and all that is said about them.

TEST(Gallery, NumbersOutOfRange) {
  const auto read = [](Reader& r) {
    Reader y = r.table("drives").table("Y");
    y.real("lead_mm", kLength, {above(0.0), at_most(0.1)});
    y.real_or("J", 1.0, kInertia, {above(0.0), below(2.0)});
    y.integer_or("points", 2, {at_least(2), at_most(256)});
  };
  EXPECT_EQ(faults("[drives.Y]\nlead_mm   = -10", read),
            "s.toml:2:13: error: drives.Y.lead_mm = -10; must be > 0 and <= 100");
  EXPECT_EQ(faults("[drives.Y]\nlead_mm = '20 m'", read),
            "s.toml:2:11: error: drives.Y.lead_mm = '20 m'; must be > 0 and <= 0.1 m");
  EXPECT_EQ(faults("[drives.Y]\nlead_mm = 0.0", read),
            "s.toml:2:11: error: drives.Y.lead_mm = 0.0; must be > 0 and <= 100");
  EXPECT_EQ(faults("[drives.Y]\nlead_mm = 100\nJ = 2.0", read),
            "s.toml:3:5: error: drives.Y.J = 2.0; must be > 0 and < 2 kg m^2");
  EXPECT_EQ(faults("[drives.Y]\nlead_mm = inf", read),
            "s.toml:2:11: error: drives.Y.lead_mm = inf; must be finite");
  EXPECT_EQ(faults("[drives.Y]\nlead_mm = nan", read),
            "s.toml:2:11: error: drives.Y.lead_mm = nan; must be finite");
  EXPECT_EQ(faults("[drives.Y]\nlead_mm = 1\npoints = 0x101", read),
            "s.toml:3:10: error: drives.Y.points = 0x101; must be >= 2 and <= 256");
  EXPECT_EQ(faults("[drives.Y]\nlead_mm = 1", read, "drives.Y.lead_mm=-10"),
            "--set drives.Y.lead_mm=-10: error: drives.Y.lead_mm = -10; must be > 0 and <= 100");
}

TEST(Gallery, BothSidesOfEveryComparison) {
  const auto verdict = [](double value, Rule rule) {
    return faults(std::to_string(value).insert(0, "x = "),
                  [rule](Reader& r) { r.real("x", kNumber, {rule}); });
  };
  EXPECT_EQ(verdict(1.0, at_least(1.0)), "no fault");
  EXPECT_EQ(verdict(1.0, at_most(1.0)), "no fault");
  EXPECT_EQ(verdict(1.0, above(1.0)), "s.toml:1:5: error: x = 1.000000; must be > 1");
  EXPECT_EQ(verdict(1.0, below(1.0)), "s.toml:1:5: error: x = 1.000000; must be < 1");
  EXPECT_EQ(verdict(0.999999, at_least(1.0)), "s.toml:1:5: error: x = 0.999999; must be >= 1");
  EXPECT_EQ(verdict(1.000001, at_most(1.0)), "s.toml:1:5: error: x = 1.000001; must be <= 1");
  EXPECT_EQ(verdict(1.000001, above(1.0)), "no fault");
  EXPECT_EQ(verdict(0.999999, below(1.0)), "no fault");
}

TEST(Gallery, Units) {
  const auto lead = [](Reader& r) { r.real("lead_mm", kLength); };
  const auto gain = [](Reader& r) { r.real("Kv", kRate); };
  EXPECT_EQ(faults("lead_mm = '20 mmm'", lead),
            "s.toml:1:11: error: lead_mm = '20 mmm'; unknown unit 'mmm'; a length is in m, mm, um, "
            "nm, inch; did you mean 'mm'?");
  EXPECT_EQ(faults("lead_mm = '20 ms'", lead),
            "s.toml:1:11: error: lead_mm = '20 ms'; 'ms' is a unit of time; must be a length "
            "such as \"3 mm\"");
  EXPECT_EQ(faults("lead_mm = '20'", lead),
            "s.toml:1:11: error: lead_mm = '20'; has no unit; must be a length such as \"3 mm\"");
  EXPECT_EQ(faults("Kv = 'fast'", gain),
            "s.toml:1:6: error: Kv = 'fast'; must be a rate such as \"3 1/s\"");
  EXPECT_EQ(faults("Kv = '60 rad/s'", gain),
            "s.toml:1:6: error: Kv = '60 rad/s'; 'rad/s' is a unit of angular velocity; must "
            "be a rate such as \"3 1/s\"");
}

TEST(Gallery, WrongTypes) {
  EXPECT_EQ(faults("lead_mm = true", [](Reader& r) { r.real("lead_mm", kLength); }),
            "s.toml:1:11: error: lead_mm = true; must be a number or a string such as \"3 mm\"");
  EXPECT_EQ(faults("ratio = '2'", [](Reader& r) { r.real("ratio", kNumber); }),
            "s.toml:1:9: error: ratio = '2'; must be a number");
  EXPECT_EQ(faults("points = 2.0", [](Reader& r) { r.integer("points"); }),
            "s.toml:1:10: error: points = 2.0; must be an integer");
  EXPECT_EQ(faults("on = 1", [](Reader& r) { r.boolean("on"); }),
            "s.toml:1:6: error: on = 1; must be a boolean");
  EXPECT_EQ(faults("title = 2025-05-27", [](Reader& r) { r.text("title"); }),
            "s.toml:1:9: error: title = 2025-05-27; must be a string");
  EXPECT_EQ(faults("nc = 3", [](Reader& r) { r.table("nc").real("Kv", kRate); }),
            "s.toml:1:6: error: nc = 3; must be a table");
  EXPECT_EQ(faults("nc = 3", [](Reader& r) { r.table_or_empty("nc").real("Kv", kRate); }),
            "s.toml:1:6: error: nc = 3; must be a table");
  EXPECT_EQ(faults("[case]\nname = 'x'", [](Reader& r) { r.tables("case"); }),
            "s.toml:1:1: error: case = {...}; must be a list; write [[case]] for each table");
  EXPECT_EQ(faults("case = []", [](Reader& r) { r.tables("case"); }),
            "s.toml:1:8: error: case = []; must have at least one item");
  EXPECT_EQ(faults("case = [{ name = 'x' }, 2]",
                   [](Reader& r) {
                     for (Reader& c : r.tables("case")) c.text("name");
                   }),
            "s.toml:1:25: error: case[1] = 2; must be a table");
  EXPECT_EQ(
      faults("a_mm = [1, 'x', -3]", [](Reader& r) { r.reals("a_mm", kLength, {at_least(0.0)}); }),
      "s.toml:1:12: error: a_mm[1] = 'x'; must be a length such as \"3 mm\"\n"
      "s.toml:1:17: error: a_mm[2] = -3; must be >= 0");
  const auto read_rows = [](Reader& r) { r.rows("a"); };
  EXPECT_EQ(faults("a = [[1, 'x'], 3, [nan, {}], []]", read_rows),
            "s.toml:1:10: error: a[0][1] = 'x'; must be a finite number\n"
            "s.toml:1:16: error: a[1] = 3; must be a list of numbers\n"
            "s.toml:1:20: error: a[2][0] = nan; must be a finite number\n"
            "s.toml:1:25: error: a[2][1] = {...}; must be a finite number");
  EXPECT_EQ(faults("a = 3", read_rows), "s.toml:1:5: error: a = 3; must be a list");
  EXPECT_EQ(faults("", read_rows), "s.toml: error: a is missing");
  EXPECT_EQ(faults("cases = ['a', 3]", [](Reader& r) { r.texts("cases"); }),
            "s.toml:1:15: error: cases[1] = 3; must be a string");
}

TEST(Gallery, NamesOutOfAList) {
  const auto read = [](Reader& r) { r.choice("type", kStrategies); };
  EXPECT_EQ(faults("type = 'tabel'", read),
            "s.toml:1:8: error: type = 'tabel'; must be one of feedback, gcode, table; did you "
            "mean 'table'?");
  EXPECT_EQ(faults("type = 'zzz'", read),
            "s.toml:1:8: error: type = 'zzz'; must be one of feedback, gcode, table");
}

TEST(Gallery, AWrongTypeIsOneFaultAndNotOneForEachKeyOfTheRightType) {
  EXPECT_EQ(faults("type = 'tabel'\nspacing_mm = 1.6",
                   [](Reader& r) {
                     r.choice("type", kStrategies);
                     r.skip_rest();
                   }),
            "s.toml:1:8: error: type = 'tabel'; must be one of feedback, gcode, table; did you "
            "mean 'table'?");
}

TEST(Gallery, MissingKeys) {
  EXPECT_EQ(faults("", [](Reader& r) { r.text("machine"); }), "s.toml: error: machine is missing");
  EXPECT_EQ(faults("x = 1\n[nc]",
                   [](Reader& r) {
                     r.integer("x");
                     r.table("nc").real("Kv", kRate);
                   }),
            "s.toml:2:1: error: nc.Kv is missing");
  EXPECT_EQ(faults("", [](Reader& r) { r.table("nc").table("axes").real("Kv", kRate); }),
            "s.toml: error: nc is missing");
  EXPECT_EQ(faults("", [](Reader& r) { r.table_or_empty("nc").real("Kv", kRate); }),
            "s.toml: error: nc.Kv is missing");
  EXPECT_EQ(faults("", [](Reader& r) { r.tables("case"); }), "s.toml: error: case is missing");
}

TEST(Gallery, UnknownKeys) {
  EXPECT_EQ(faults("[nc]\nkv = 60\npreset = 'x'",
                   [](Reader& r) {
                     Reader nc = r.table("nc");
                     nc.real_or("Kv", 60.0, kRate);
                   }),
            "s.toml:2:1: error: nc.kv is not known; did you mean 'Kv'?\n"
            "s.toml:3:1: error: nc.preset is not known");
  EXPECT_EQ(
      faults("case = [{ name = 'x', nmae = 'y' }]",
             [](Reader& r) {
               for (Reader& c : r.tables("case")) c.text("name");
             }),
      "s.toml:1:23: error: case[0].nmae is not known; did you mean 'name', which is also given?");
  EXPECT_EQ(faults("lead_m = 1", [](Reader& r) { r.real("lead_mm", kLength); }),
            "s.toml: error: lead_mm is missing\n"
            "s.toml:1:1: error: lead_m is not known; did you mean 'lead_mm'?");
  EXPECT_EQ(faults("[p]\n\"#101\" = 1", [](Reader& r) { r.table("p"); }),
            "s.toml:2:1: error: p.\"#101\" is not known");
  EXPECT_EQ(faults(
                "", [](Reader&) {}, "nc.Kv=3"),
            "--set nc.Kv=3: error: nc is not known");
}

TEST(Gallery, KeysThatAreOnlyLookedAt) {
  EXPECT_EQ(faults("[sweep]\nx = 1", [](Reader& r) { r.has("sweep"); }),
            "s.toml:1:2: error: sweep is not used here");
}

TEST(Gallery, FaultsOfTheCaller) {
  EXPECT_EQ(faults("[t]\nspacing_mm = 1.7\nof = 'mm'",
                   [](Reader& r) {
                     Reader t = r.table("t");
                     t.real("spacing_mm", kLength);
                     t.text("of");
                     t.fault("spacing_mm", "must be 2^n x 0.1 um");
                     t.fault("needs a model");
                     r.fault("has no case");
                     EXPECT_EQ(r.faults(), 3u);
                     EXPECT_EQ(t.place("of"), (Place{"s.toml", 3, 6}));
                   }),
            "s.toml: error: has no case\n"
            "s.toml:1:1: error: t: needs a model\n"
            "s.toml:2:14: error: t.spacing_mm = 1.7; must be 2^n x 0.1 um");
}

TEST(Gallery, AllFaultsAtOnceInOrderOfPlaceAndFile) {
  Document machine = Document::from_text("[nc]\nKv = -1\nKp = 'x'\n", "m.toml");
  const Document scenario = Document::from_text("\n\n[o.nc]\nTn_ms = 0\nvmax = 1\n", "s.toml");
  machine.merge(*scenario.root().find("o"));
  machine.set("nc.Ki=-3");
  Reader root(machine);
  Reader nc = root.table("nc");
  nc.real("Ki", kNumber, {at_least(0.0)});
  nc.real("Tn_ms", kTime, {above(0.0)});
  nc.real("Kp", kNumber);
  nc.real("Kv", kRate, {above(0.0)});
  std::string text;
  try {
    root.finish();
  } catch (const InputError& error) {
    text = error.what();
  }
  EXPECT_EQ(text,
            "--set nc.Ki=-3: error: nc.Ki = -3; must be >= 0\n"
            "s.toml:4:9: error: nc.Tn_ms = 0; must be > 0\n"
            "s.toml:5:1: error: nc.vmax is not known\n"
            "m.toml:2:6: error: nc.Kv = -1; must be > 0\n"
            "m.toml:3:6: error: nc.Kp = 'x'; must be a number");
}

TEST(Gallery, LongValuesAreShortened) {
  EXPECT_EQ(faults("x = '" + std::string(80, 'y') + "'", [](Reader& r) { r.boolean("x"); }),
            "s.toml:1:5: error: x = \"...\"; must be a boolean");
}

}  // namespace
}  // namespace servomill::sim::config::reader_test
