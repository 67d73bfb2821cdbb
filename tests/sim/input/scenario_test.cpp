/// Laws for every scenario, machine and strategy that there is.
#include "sim/model/scenario.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "sim/config/document.h"
#include "sim/evaluation/comparison.h"
#include "sim/input/machine_document.h"
#include "sim/input/read_scenario.h"
#include "sim/run/run.h"
#include "sim/run/run_case.h"
#include "sim/run/run_output.h"
#include "sim/run/store.h"
#include "sim/run/stored_run.h"
#include "sim/system/read_file.h"
#include "strategies/registry.h"

namespace servomill::sim::input::scenario_test {
namespace {

namespace fs = std::filesystem;

const std::string kFolder = SERVOMILL_SOURCE_DIR "/scenarios";
const std::string kSmall = SERVOMILL_SOURCE_DIR "/tests/cli/gallery/scenario.toml";

// Beside scenarios and machines there are experiments to identify drives from, readings and
// instruments: these have neither cases nor a file that they are based on.
bool is_scenario_or_machine(const fs::path& path) {
  if (path.extension() != ".toml" || path.parent_path().filename() == "experiments") return false;
  if (is_machine_file(path.string())) return true;
  const std::string text = system::read_file(path.string(), {}, "scenario");
  return text.find("[[case]]") != std::string::npos || text.find("based_on") != std::string::npos;
}

std::vector<std::string> files(bool machines) {
  std::vector<std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(kFolder)) {
    if (is_scenario_or_machine(entry.path()) &&
        is_machine_file(entry.path().string()) == machines) {
      out.push_back(entry.path().string());
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::string test_name(const testing::TestParamInfo<std::string>& file) {
  // The whole path from the folder of scenarios: several studies have a machines/actual.toml.
  std::string name = fs::relative(file.param, kFolder).replace_extension().string();
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

class EveryMachine : public testing::TestWithParam<std::string> {};

TEST_P(EveryMachine, ReadsWithoutFaultAndIsStable) {
  EXPECT_NO_THROW(run::check_machine(read_machine_file(GetParam())));
}

INSTANTIATE_TEST_SUITE_P(Scenarios, EveryMachine, testing::ValuesIn(files(true)), test_name);

class EveryScenario : public testing::TestWithParam<std::string> {};

TEST_P(EveryScenario, SurvivesWriteAndReadUnchanged) {
  const model::Scenario scenario = read_scenario(GetParam());
  const model::Scenario again = read_resolved_scenario(scenario.resolved, "again");
  EXPECT_EQ(again.resolved, scenario.resolved);
  EXPECT_EQ(again.program.text(), scenario.program.text());
  EXPECT_EQ(again.cases.size(), scenario.cases.size());
}

TEST_P(EveryScenario, CanBePrepared) {
  const model::Scenario scenario = read_scenario(GetParam());
  EXPECT_NO_THROW(run::check_scenario(scenario));
}

INSTANTIATE_TEST_SUITE_P(Scenarios, EveryScenario, testing::ValuesIn(files(false)), test_name);

TEST(Resolved, HoldsTheChangesOfTheCommandLine) {
  // the scenario overrides this key of its machine, and the command line has the last word
  const model::Scenario scenario =
      read_scenario(kSmall, {"machine.nc.Kv=42", "program.feed_override=0.5"});
  const model::Scenario again = read_resolved_scenario(scenario.resolved, "again");
  EXPECT_EQ(again.machine.nc.cascade[0].Kv, 42.0);
  EXPECT_EQ(again.program.feed_override, 0.5);
}

TEST(Changes, OfAFileNameAreReadFromWhereTheUserIs) {
  const std::string machine = fs::path(kSmall).parent_path().string() + "/machine.toml";
  const std::string here = fs::relative(machine).string();
  const model::Scenario scenario = read_scenario(kSmall, {"machine=" + here});
  EXPECT_EQ(scenario.resolved, read_scenario(kSmall).resolved);
}

TEST(Changes, OfAProgramReplaceTheOneThatAResolvedScenarioHolds) {
  const fs::path folder = fs::path(testing::TempDir()) / "changed_program";
  fs::create_directories(folder);
  const std::string resolved = folder / "resolved.toml", other = folder / "other.ngc";
  std::ofstream(resolved) << read_scenario(kSmall).resolved;
  std::ofstream(other) << "G1 X7 F1000\nM2\n";
  const model::Scenario changed = read_scenario(resolved, {"program.file=\"" + other + "\""});
  EXPECT_EQ(changed.program.text(), "G1 X7 F1000\nM2\n");
  EXPECT_EQ(read_resolved_scenario(changed.resolved, "again").program.text(), "G1 X7 F1000\nM2\n");
  const model::Scenario both =
      read_scenario(resolved, {"program.file=\"" + other + "\"", "program.text=\"M2\\n\""});
  EXPECT_EQ(both.program.text(), "M2\n") << "as --set says";
  EXPECT_EQ(read_scenario(resolved).program.text(), read_scenario(kSmall).program.text());
  try {
    read_scenario(resolved, {"program.file=\"nowhere.ngc\""});
    ADD_FAILURE() << "ran the stored program";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("nowhere.ngc"), std::string::npos) << error.what();
  }
}

TEST(Changes, OfTheScenarioBelowAreRefused) {
  try {
    read_scenario(kSmall, {"based_on=\"other.toml\""});
    ADD_FAILURE() << "ignored";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              "--set based_on=\"other.toml\": error: based_on = \"other.toml\"; cannot be changed "
              "by --set: name the other scenario");
  }
}

TEST(Faults, StandInTheFileThatSaysThem) {
  const auto place_of = [](const std::vector<std::string>& changes) {
    try {
      read_scenario(kSmall, changes);
    } catch (const InputError& error) {
      return fs::path(to_string(error.faults().at(0).place)).filename().string();
    }
    return std::string("no fault");
  };
  EXPECT_EQ(place_of({}), "no fault");
  EXPECT_EQ(place_of({"machine.axis.X.lead_mm=-1"}), "--set machine.axis.X.lead_mm=-1");
  EXPECT_EQ(place_of({"machine_override.nc.Kv=-1"}), "--set machine_override.nc.Kv=-1");
  // the base period of the machine file no longer divides what the scenario says
  EXPECT_EQ(place_of({"machine.nc.base_period_us=20"}), "scenario.toml:21:19");
}

// Dotted paths of everything in a document, as --set takes them.
void collect_paths(const config::Value& value, const std::string& path,
                   std::vector<std::string>& out) {
  if (!path.empty()) out.push_back(path);
  std::size_t item = 0;
  for (const config::Value& child : value.children) {
    const bool is_list = value.type == config::Value::Type::list;
    collect_paths(
        child, is_list ? fmt::format("{}[{}]", path, item++) : config::joined_key(path, child.key),
        out);
  }
}

TEST(Nonsense, InAnyKeyIsAnInputErrorOrAMeaningButNeverACrash) {
  const config::Document document =
      config::Document::from_text(read_scenario(kSmall).resolved, "resolved");
  std::vector<std::string> paths;
  collect_paths(document.root(), "", paths);
  std::size_t refused = 0;
  for (const std::string& path : paths) {
    if (path == "program.text") continue;  // any text is one
    for (const char* value :
         {"true", "-1", "x", "[]", "{}", "nan", "1e300", "0", "1e-300", "\"\""}) {
      try {
        run::check_scenario(read_scenario(kSmall, {fmt::format("{}={}", path, value)}));
      } catch (const InputError& error) {
        ++refused;
        ASSERT_FALSE(error.faults().empty());
        for (const Fault& fault : error.faults()) {
          EXPECT_FALSE(fault.place.file.empty()) << path << "=" << value << ": " << error.what();
          EXPECT_FALSE(fault.message.empty());
        }
      }
    }
  }
  EXPECT_GT(refused, 6 * paths.size());
}

// Strategy with nothing said but what has no default.
std::string required_keys(const strategies::Entry& entry) {
  std::string out = entry.reads_errors ? ",model=\"imposed\"" : "";
  for (const ParameterSpec& parameter : entry.parameters) {
    if (!parameter.default_text.empty()) continue;
    out += fmt::format(",{}={}", parameter.name, std::max(parameter.min, 1.0));
  }
  return out;
}

// Keys and values as the registry prints them for users.
std::string all_defaults(const strategies::Entry& entry) {
  std::string out;
  for (const ParameterSpec& parameter : entry.parameters) {
    if (parameter.default_text.empty()) continue;
    const bool is_word = std::find(parameter.words.begin(), parameter.words.end(),
                                   parameter.default_text) != parameter.words.end();
    const std::string quote = is_word ? "\"" : "";
    out += fmt::format(",{0}={1}{2}{1}", parameter.name, quote, parameter.default_text);
  }
  return out;
}

TEST(EveryStrategy, CanBeNamedWithItsDefaultsSaidOrNot) {
  for (const strategies::Entry& entry : strategies::entries()) {
    const std::string silent = required_keys(entry);
    const auto read = [&](const std::string& keys) {
      std::vector<std::string> changes = {
          fmt::format("case[1].strategy=[{{type=\"{}\"{}}}]", entry.name, keys)};
      if (entry.corrects_heat) {
        changes.emplace_back(
            "case[1].machine_override={ heat = { surroundings = { room = {} }, body = { head = { "
            "capacity_J_per_K = 1e4, conductance_W_per_K = { room = 10.0 } } } } }");
      }
      return read_scenario(kSmall, changes);
    };
    const auto quiet = read(silent).cases.at(1).strategies.at(0).parameters;
    const model::Scenario scenario = read(silent + all_defaults(entry));
    const auto& said = scenario.cases.at(1).strategies.at(0).parameters;
    for (const ParameterSpec& parameter : entry.parameters) {
      if (parameter.default_text.empty()) continue;
      ASSERT_EQ(quiet.is_word(parameter.name), said.is_word(parameter.name)) << parameter.name;
      if (said.is_word(parameter.name)) {
        EXPECT_EQ(quiet.word(parameter.name), said.word(parameter.name)) << parameter.name;
      } else {
        EXPECT_EQ(quiet.number(parameter.name), said.number(parameter.name)) << parameter.name;
      }
    }
  }
}

TEST(Store, ComparesAgainAsTheRunDid) {
  const model::Scenario scenario = read_scenario(kSmall);
  const std::string path = testing::TempDir() + "scenario_test.h5";
  std::string printed;
  {
    run::RunStore store(path, true, scenario);
    run::RunControl control;
    control.case_done = [&](const run::CaseOutput& one) { store.add(one); };
    const run::RunOutput output = run::run_scenario(scenario, control);
    store.commit(output.comparison);
    printed = evaluation::format_table(output.comparison);
  }
  const run::StoredRun stored = run::read_run(path);
  EXPECT_EQ(evaluation::format_table(evaluation::compare(stored.quantities, stored.cases)),
            printed);
  EXPECT_NE(printed.find("20 um"), std::string::npos);
  fs::remove(path);
}

TEST(Store, KeepsSinglePrecisionAndComparesAgainAsTheRunDid) {
  const model::Scenario scenario =
      read_scenario(kSmall, {"record.storage=\"float32\"", "record.compression=0"});
  const std::string path = testing::TempDir() + "scenario_test_float32.h5";
  run::RunStore store(path, true, scenario);
  run::RunControl control;
  control.case_done = [&](const run::CaseOutput& one) { store.add(one); };
  const run::RunOutput output = run::run_scenario(scenario, control);
  store.commit(output.comparison);
  const run::StoredRun stored = run::read_run(path);
  EXPECT_EQ(evaluation::format_table(evaluation::compare(stored.quantities, stored.cases)),
            evaluation::format_table(output.comparison));
  for (std::size_t i = 0; i < stored.cases.size(); ++i) {
    EXPECT_EQ(stored.cases[i].servo->by_rows(), output.cases[i].result.servo.by_rows());
  }
  fs::remove(path);
}

TEST(Scenario, SaysHowExactlyToRecord) {
  const model::Scenario plain = read_scenario(kSmall);
  EXPECT_EQ(plain.record.format.storage, records::Storage::float64);
  EXPECT_EQ(plain.record.format.resolution, 0.001e-9);
  EXPECT_EQ(plain.record.compression, 1);
  const model::Scenario said = read_scenario(
      kSmall, {"record.storage=\"float32\"", "record.compression=9", "record.resolution_nm=0"});
  EXPECT_EQ(said.record.format.storage, records::Storage::float32);
  EXPECT_EQ(said.record.format.resolution, 0.0);
  EXPECT_EQ(said.record.compression, 9);
  for (const auto& [change, complaint] : std::map<std::string, std::string>{
           {"record.storage=\"float16\"",
            "record.storage = \"float16\"; must be one of float64, float32"},
           {"record.compression=10", "record.compression = 10; must be >= 0 and <= 9"},
           {"record.resolution_nm=-1", "record.resolution_nm = -1; must be >= 0 and <= 1000"}}) {
    try {
      read_scenario(kSmall, {change});
      FAIL() << change;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(complaint), std::string::npos) << error.what();
    }
  }
}

// A folder of its own, removed at the end.
class BasedOn : public testing::Test {
 protected:
  BasedOn() : folder_(fs::path(testing::TempDir()) / "servomill_based_on") {
    fs::create_directories(folder_);
  }
  ~BasedOn() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  const fs::path folder_;
};

TEST_F(BasedOn, WinsOverTheScenarioBelowAndKeepsTheRest) {
  const std::string path = write("above.toml", fmt::format("based_on = \"{}\"\ntitle = \"above\"\n"
                                                           "[program]\nfeed_override = 0.5\n",
                                                           kSmall));
  const model::Scenario above = read_scenario(path), below = read_scenario(kSmall);
  EXPECT_EQ(above.title, "above");
  EXPECT_EQ(above.program.feed_override, 0.5);
  EXPECT_EQ(above.program.text(), below.program.text());  // found beside the scenario that names it
  EXPECT_EQ(above.cases.size(), below.cases.size());
}

// The scenario in a result file runs anywhere.
TEST_F(BasedOn, IsNotInTheResolvedScenario) {
  const std::string path = write("above.toml", fmt::format("based_on = \"{}\"\n", kSmall));
  const model::Scenario above = read_scenario(path);
  EXPECT_EQ(above.resolved.find("based_on"), std::string::npos);
  const model::Scenario again = read_scenario(write("resolved.toml", above.resolved));
  EXPECT_EQ(again.resolved, above.resolved);
  // as earlier versions stored it
  const model::Scenario earlier =
      read_resolved_scenario("based_on = \"gone.toml\"\n" + above.resolved, "earlier");
  EXPECT_EQ(earlier.cases.size(), above.cases.size());
}

TEST_F(BasedOn, ReplacesCasesOfTheSameNameAndAddsOthers) {
  const model::Scenario below = read_scenario(kSmall);
  const std::string first = below.cases.front().name;
  const std::string path = write(
      "above.toml", fmt::format("based_on = \"{}\"\n[[case]]\nname = \"{}\"\nwork_offset = {{ "
                                "X_mm = 1.0 }}\n[[case]]\nname = \"new\"\n",
                                kSmall, first));
  const model::Scenario above = read_scenario(path);
  ASSERT_EQ(above.cases.size(), below.cases.size() + 1);
  EXPECT_EQ(above.cases.front().name, first);
  EXPECT_EQ(above.cases.front().work_offset[0], 1e-3);
  EXPECT_EQ(above.cases.back().name, "new");
}

TEST_F(BasedOn, RefusesACircleAndAFileThatIsNotThere) {
  const auto message = [](const std::string& path) -> std::string {
    try {
      read_scenario(path);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  const std::string circle = write("circle.toml", "based_on = \"circle.toml\"\n");
  EXPECT_EQ(message(circle), circle +
                                 ":1:12: error: based_on nested deeper than 8; one of the "
                                 "scenarios may be based on itself");
  const std::string lost = write("lost.toml", "based_on = \"nowhere.toml\"\n");
  EXPECT_EQ(message(lost), lost + ":1:12: error: based_on = \"nowhere.toml\"; no such file");
}

}  // namespace
}  // namespace servomill::sim::input::scenario_test
