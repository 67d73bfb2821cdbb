/// Samples of identified errors that are drawn into an error model of their own.
#include "sim/input/drawn_errors.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "plant/geometry/error_model.h"
#include "sim/config/written_number.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"
#include "sim/sweep/sweep.h"
#include "tests/text.h"

namespace servomill::sim::input::drawn_errors_test {
namespace {

namespace fs = std::filesystem;

class DrawnErrors : public testing::Test {
 protected:
  DrawnErrors() : folder_(fs::path(testing::TempDir()) / "servomill_drawn_errors") {
    fs::create_directories(folder_);
    const fs::path gallery = SERVOMILL_SOURCE_DIR "/tests/cli/gallery";
    for (const char* name : {"machine.toml", "part.ngc"}) {
      fs::copy_file(gallery / name, folder_ / name, fs::copy_options::overwrite_existing);
    }
    write("identified.toml",
          "based_on = \"machine.toml\"\n[errors.identified]\n"
          "EC0Y = { constant_urad = 100.0 }\nEYX = { polynomial_um = [0.0, 0.01] }\n"
          "[identified]\nkeys = [\"errors.identified.EC0Y.constant_urad\", "
          "\"errors.identified.EYX.polynomial_um[1]\"]\nunits = [\"urad\", \"1\"]\n"
          "values = [100.0, 0.01]\ncovariance = [[4.0, 0.0], [0.0, 1e-6]]\n");
  }
  ~DrawnErrors() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  std::string scenario(const std::string& samples) const {
    write("scenario.toml",
          fmt::format("machine = \"identified.toml\"\nprogram.file = \"part.ngc\"\n"
                      "program.parameters = {{ \"#101\" = 1394.0 }}\nmachine_errors = \"drawn\"\n"
                      "[[case]]\nname = \"one\"\n[[case.strategy]]\ntype = \"gcode\"\n"
                      "model = \"identified\"\n[sweep]\nsamples = {{ count = 5, {} }}\n",
                      samples));
    return (folder_ / "scenario.toml").string();
  }
  std::string refusal(const std::string& samples) const {
    const std::string path = scenario(samples);
    return fault_messages([&] { read_scenario(path); });
  }

  fs::path folder_;
};

constexpr const char* kInto = "from = \"identified.toml\", into = \"drawn\"";

TEST_F(DrawnErrors, AreAnotherModelThanTheOneThatStrategiesKnow) {
  const sweep::Sweep sweep(scenario(kInto), {});
  const auto EC0Y = plant::ErrorName{Axis::C, Axis::Y, true};
  const auto EYX = plant::ErrorName{Axis::Y, Axis::X, false};
  EXPECT_EQ(sweep.base().errors.at("drawn"), sweep.base().errors.at("identified"));
  double last = 0.0;
  for (std::uint64_t i = 0; i < 5; ++i) {
    const auto values = sweep.design().point(i);
    const model::Scenario one = sweep.at(i);
    const plant::ErrorModel& drawn = one.errors.at("drawn");
    EXPECT_EQ(one.errors.at("identified"), sweep.base().errors.at("identified"));
    EXPECT_NEAR(drawn.location(EC0Y), 1e-6 * config::number_of(values[0]), 1e-18);
    EXPECT_NEAR(drawn.component(EYX).value(1e-3), 1e-6 * config::number_of(values[1]), 1e-18);
    EXPECT_NE(drawn.location(EC0Y), last);
    last = drawn.location(EC0Y);
  }
}

TEST_F(DrawnErrors, AreStillThereInACompleteDocument) {
  const sweep::Sweep sweep(scenario(kInto), {});
  const model::Scenario one = sweep.at(3);
  fs::remove(folder_ / "identified.toml");
  const model::Scenario again = read_resolved_scenario(one.resolved, "again");
  EXPECT_EQ(again.errors.at("drawn"), one.errors.at("drawn"));
  EXPECT_EQ(again.errors.at("identified"), one.errors.at("identified"));
  EXPECT_EQ(again.resolved, one.resolved);
}

TEST_F(DrawnErrors, AreRefusedWhereNoErrorIsIdentified) {
  EXPECT_EQ(refusal("from = \"identified.toml\", into = \"identified\""),
            "machine_errors = \"drawn\"; no such error model; known are: "
            "identified\nsweep.samples.into = \"identified\"; must be a new name of letters, "
            "digits and '_'; identified is the identified model\n");
  write("mass.toml",
        "based_on = \"machine.toml\"\n[axis.X]\nmoving_mass = 700\n[identified]\n"
        "keys = [\"axis.X.moving_mass\"]\nunits = [\"kg\"]\nvalues = [700]\n"
        "covariance = [[100.0]]\n");
  EXPECT_EQ(
      refusal("from = \"mass.toml\", into = \"drawn\""),
      "machine_errors = \"drawn\"; no such error model; known are: identified\nsweep.samples.into "
      "= \"drawn\"; has no effect: no identified key belongs to an error model\n");
}

TEST(KeyInModel, RenamesErrorsOnly) {
  EXPECT_EQ(key_in_model("errors.identified.EXX.polynomial_um[1]", "drawn"),
            "errors.drawn.EXX.polynomial_um[1]");
  EXPECT_EQ(key_in_model("axis.X.Kv", "drawn"), "axis.X.Kv");
  EXPECT_EQ(models_of_keys({"errors.a.EXX.x", "axis.X.Kv", "errors.a.EYY.x", "errors.b.EXX.x"}),
            (std::vector<std::string>{"a", "b"}));
}

}  // namespace
}  // namespace servomill::sim::input::drawn_errors_test
