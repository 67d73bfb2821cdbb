#include "sim/config/document.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <functional>
#include <limits>

namespace servomill::sim::config::document_test {
namespace {

constexpr std::string_view kScenario = R"(# a scenario
title = "Épreuve" # with a comment
date = 2025-05-27
big = 9_007_199_254_740_993
tiny = 4.9e-324
text = """
two
lines \u00e9 "quoted" """
[program]
parameters = { "#101" = 1394.0, named = 0x10 }
[errors.imposed]
EYX = { harmonic = { amplitude_um = 150.0, period_mm = 62.0 } }
EXX = { polynomial_um = [0.0, 0.3, -0.0024], of = "mm" }
odd = [1, { a = true, b = [] }, [nan, -inf, -0.0]]
none = {}
[[case]]
name = "table"
[[case.strategy]]
type = 'table'
[case.strategy.where]
entry = "position"
[[case.strategy]]
type = "none"
[[case]]
name = "feedback"
)";

Document scenario() { return Document::from_text(kScenario, "s.toml"); }

std::string message(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::string set_message(std::string_view assignment) {
  Document document = scenario();
  const std::string text = message([&] { document.set(assignment); });
  EXPECT_TRUE(same_value(document.root(), scenario().root()))
      << "a refused --set changed something";
  return text;
}

// Item of a list or entry of a table, by a chain of names.
const Value& at(const Value& value, std::initializer_list<std::string_view> path) {
  const Value* here = &value;
  for (const std::string_view step : path) {
    here = here->type == Value::Type::list ? &here->children.at(std::stoul(std::string(step)))
                                           : here->find(step);
    if (here == nullptr) throw std::out_of_range(std::string(step));
  }
  return *here;
}

TEST(Document, KnowsThePlaceAndSpellingOfEveryValue) {
  const Document document = scenario();
  const Value& hash = at(document.root(), {"program", "parameters", "#101"});
  EXPECT_EQ(hash.place, (Place{"s.toml", 10, 25}));
  EXPECT_EQ(hash.key_place, (Place{"s.toml", 10, 16}));
  EXPECT_EQ(hash.written, "1394.0");
  EXPECT_EQ(at(document.root(), {"title"}).written, "\"Épreuve\"");
  EXPECT_EQ(at(document.root(), {"big"}).integer, 9007199254740993);
  EXPECT_EQ(at(document.root(), {"big"}).written, "9_007_199_254_740_993");
}

TEST(Document, KeepsTheOrderOfTheText) {
  const Document document = Document::from_text("z = 1\na = 2\nm = 3\n", "s.toml");
  std::string order;
  for (const Value& entry : document.root().children) order += entry.key;
  EXPECT_EQ(order, "zam");
}

TEST(Document, WrittenAndReadAgainIsTheSame) {
  Document document = scenario();
  for (const char* assignment :
       {"case[0].strategy.1.type=feedback", "program.parameters.\"#7\"=-1e-9",
        "new.'quoted.key'.x=[1, 2]", "title=a \"quoted\"\ttext\nof two lines \\ é",
        "errors.imposed.EYX=EXX", "odd2={a = [{b = 1}, {}]}"}) {
    document.set(assignment);
  }
  const Document again = Document::from_text(document.to_toml(), "again.toml");
  EXPECT_TRUE(same_value(document.root(), again.root())) << document.to_toml();
  EXPECT_EQ(document.to_toml(), again.to_toml());
  EXPECT_FALSE(same_value(document.root(), scenario().root()));
}

TEST(Document, ReadsAFile) {
  const std::string path = testing::TempDir() + "document_test.toml";
  std::ofstream(path) << kScenario;
  EXPECT_TRUE(same_value(Document::from_file(path).root(), scenario().root()));
  std::remove(path.c_str());
}

TEST(Document, SaysWhyAFileCannotBeRead) {
  EXPECT_EQ(message([] { Document::from_file("/no/such.toml"); }),
            "/no/such.toml: error: cannot be read: No such file or directory");
  EXPECT_EQ(message([] { Document::from_file("/tmp"); }),
            "/tmp: error: cannot be read: is a folder");
}

TEST(Document, PointsAtFaultsOfSyntax) {
  const auto syntax = [](std::string_view text) {
    return message([text] { Document::from_text(text, "s.toml"); });
  };
  EXPECT_EQ(
      syntax("a = 1\nb = 20 mm\n"),
      "s.toml:2:8: error: not TOML: key-value pair: expected a comment or whitespace, saw 'm'");
  EXPECT_EQ(syntax("a = 1\na = 2\n"),
            "s.toml:2:5: error: not TOML: key-value pair: cannot redefine existing integer 'a'");
  EXPECT_EQ(syntax("a = 'x"), "s.toml:1:7: error: not TOML: string: encountered end-of-file");
  // the library's own column lies two behind the end
  EXPECT_EQ(syntax("a = { b = ['c'"),
            "s.toml:1:15: error: not TOML: array: encountered end-of-file");
  EXPECT_EQ(syntax("[a\n"), "s.toml:1:3: error: not TOML: table header: expected ']', saw '\\n'");
}

TEST(Set, TakesTomlValuesAndElseTheTextAsItStands) {
  const auto value = [](const std::string& text) {
    Document document = Document::from_text("", "s.toml");
    document.set("key=" + text);
    return inline_toml(*document.root().find("key"));
  };
  EXPECT_EQ(value("-1_0.5e3"), "-1_0.5e3");
  EXPECT_EQ(value("true"), "true");
  EXPECT_EQ(value("[1, 'x', {a = 2}]"), "[1, 'x', { a = 2 }]");
  EXPECT_EQ(value("\"#101\""), "\"#101\"");
  EXPECT_EQ(value("table"), "\"table\"");
  EXPECT_EQ(value("3.6 m/min/mm"), "\"3.6 m/min/mm\"");
  EXPECT_EQ(value("a=b"), "\"a=b\"");
  EXPECT_EQ(value("1,"), "\"1,\"");
  EXPECT_EQ(value("1 # one"), "\"1 # one\"");
  EXPECT_EQ(value("1\nb = 2"), "\"1\\u000Ab = 2\"");
}

TEST(Set, FollowsDottedPathsListsAndQuotedNames) {
  Document document = scenario();
  document.set("case.1.name=A");
  document.set("case[0].strategy[1].type=B");
  document.set("program.parameters.\"#101\"=5");
  document.set("errors.imposed.EXX.polynomial_um[2]=0.5");
  EXPECT_EQ(at(document.root(), {"case", "1", "name"}).text, "A");
  EXPECT_EQ(at(document.root(), {"case", "0", "strategy", "1", "type"}).text, "B");
  EXPECT_EQ(at(document.root(), {"program", "parameters", "#101"}).integer, 5);
  EXPECT_EQ(at(document.root(), {"errors", "imposed", "EXX", "polynomial_um", "2"}).real, 0.5);
  EXPECT_EQ(at(document.root(), {"case", "1", "name"}).place, (Place{"--set case.1.name=A"}));
}

TEST(Set, SaysWhatIsWrongWithTheKey) {
  EXPECT_EQ(set_message("title"), "--set title: error: no '='; write KEY=VALUE");
  EXPECT_EQ(set_message("title="),
            "--set title=: error: no value after '='; an empty string is \"\"");
  EXPECT_EQ(set_message("=1"), "--set =1: error: a name is missing in the key");
  EXPECT_EQ(set_message("a..b=1"), "--set a..b=1: error: a name is missing in the key");
  EXPECT_EQ(set_message("a.\"b=1"), "--set a.\"b=1: error: a quote in the key is not closed");
  EXPECT_EQ(set_message("case[0=1"), "--set case[0=1: error: ']' is missing in the key");
  EXPECT_EQ(set_message("case[x]=1"),
            "--set case[x]=1: error: '[x]' is not a list index; use a number");
  EXPECT_EQ(set_message("case[0]name=1"), "--set case[0]name=1: error: unexpected 'n' after '0'");
  EXPECT_EQ(set_message("case.first.name=1"),
            "--set case.first.name=1: error: case is a list without an item 'first'");
  EXPECT_EQ(
      set_message("case[2].name=x"),
      "--set case[2].name=x: error: case[2] is out of range; the list has 2 items, counted from 0");
  EXPECT_EQ(set_message("title.x=1"), "--set title.x=1: error: title is a string; it has no 'x'");
  EXPECT_EQ(set_message("program[0]=1"),
            "--set program[0]=1: error: program is a table; it has no '[0]'");
}

TEST(Merge, OverridesLeafByLeafAndKeepsThePlaceOfTheWinner) {
  Document machine = Document::from_text(
      "name = 'HSM'\n[nc]\nKv = 60\npreset = 'CC422'\n[drives.X]\nlead_mm = 20\n", "m.toml");
  const Document scenario_in = Document::from_text(
      "[machine_override.nc]\nKv = '30 1/s'\n[machine_override.drives.Y]\nlead_mm = 10\n",
      "s.toml");
  machine.merge(*scenario_in.root().find("machine_override"));

  const Document wanted = Document::from_text(
      "name = 'HSM'\n[nc]\nKv = '30 1/s'\npreset = 'CC422'\n[drives]\nX.lead_mm = 20\n"
      "Y.lead_mm = 10\n",
      "w.toml");
  EXPECT_TRUE(same_value(machine.root(), wanted.root())) << machine.to_toml();
  EXPECT_EQ(at(machine.root(), {"nc", "Kv"}).place, (Place{"s.toml", 2, 6}));
  EXPECT_EQ(at(machine.root(), {"nc", "preset"}).place, (Place{"m.toml", 4, 10}));
}

TEST(Merge, OfNothingChangesNothing) {
  Document document = scenario();
  document.merge(Value{});
  EXPECT_EQ(document.to_toml(), scenario().to_toml());
}

}  // namespace
}  // namespace servomill::sim::config::document_test
