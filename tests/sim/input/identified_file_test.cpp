/// Machine files with identified values: based on another machine, read, written.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include "sim/input/machine_description.h"
#include "sim/input/machine_document.h"
#include "sim/input/read_errors.h"
#include "sim/input/read_machine.h"
#include "sim/input/read_scenario.h"
#include "sim/input/write_identified.h"
#include "sim/model/scenario.h"

namespace servomill::sim::input::identified_file_test {
namespace {

namespace fs = std::filesystem;

const std::string kMachine = SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml";

// The example of identified_values.h.
const std::string kExample =
    "based_on = \"start_machine.toml\"        # the machine that was started from\n"
    "[axis.X]\n"
    "moving_mass = \"95.11 kg\"               # +- 1.2 kg (k = 2)\n"
    "[axis.X.friction]\n"
    "coulomb = \"19.98 N\"                    # +- 0.4 N (k = 2)\n"
    "[identified]\n"
    "keys = [\"axis.X.moving_mass\", \"axis.X.friction.coulomb\"]\n"
    "units = [\"kg\", \"N\"]\n"
    "values = [95.11, 19.98]\n"
    "covariance = [[0.36, 0.01], [0.01, 0.04]]\n"
    "unidentifiable = [\"axis.X.gravity_load\"]\n";

std::string replaced(std::string text, const std::string& old, const std::string& by) {
  const std::size_t at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return text.replace(at, old.size(), by);
}

class IdentifiedFileTest : public testing::Test {
 protected:
  IdentifiedFileTest() : folder_(fs::path(testing::TempDir()) / "servomill_identified_file") {
    fs::create_directories(folder_);
    fs::copy_file(kMachine, path("start_machine.toml"), fs::copy_options::overwrite_existing);
  }
  ~IdentifiedFileTest() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }
  MachineDocument read(const std::string& text) const {
    InputFiles files;
    return machine_document(write("identified.toml", text), files);
  }
  // Message about a file, without its folder.
  std::string refusal(const std::string& text) const {
    try {
      read_machine_description(write("identified.toml", text));
    } catch (const InputError& error) {
      std::string out = error.what();
      const std::string folder = folder_.string() + "/";
      for (std::size_t at; (at = out.find(folder)) != std::string::npos;) {
        out.erase(at, folder.size());
      }
      return out;
    }
    return "accepted";
  }
  std::string refusal_of(const std::string& old, const std::string& by) const {
    return refusal(replaced(kExample, old, by));
  }

  fs::path folder_;
};

TEST_F(IdentifiedFileTest, ReadsTheExampleOfItsHeader) {
  const MachineDocument document = read(kExample);
  ASSERT_TRUE(document.identified);
  const IdentifiedValues& v = *document.identified;
  EXPECT_EQ(v.keys, (std::vector<std::string>{"axis.X.moving_mass", "axis.X.friction.coulomb"}));
  EXPECT_EQ(v.units, (std::vector<std::string>{"kg", "N"}));
  EXPECT_EQ(v.values, (std::vector<double>{95.11, 19.98}));
  EXPECT_EQ(v.covariance(0, 0), 0.36);
  EXPECT_EQ(v.covariance(0, 1), 0.01);
  EXPECT_EQ(v.covariance(1, 1), 0.04);
  EXPECT_EQ(v.unidentifiable, (std::vector<std::string>{"axis.X.gravity_load"}));
  EXPECT_EQ(document.files,
            (std::vector<std::string>{path("identified.toml"), path("start_machine.toml")}));
}

TEST_F(IdentifiedFileTest, IsTheMachineItIsBasedOnButForItsValues) {
  const model::MachineSettings below = read_machine_file(kMachine);
  const model::MachineSettings above = read_machine_file(write("identified.toml", kExample));
  EXPECT_EQ(above.drives[0].M, 95.11);
  EXPECT_EQ(above.drives[0].friction.Fc_positive, 19.98);
  EXPECT_NE(below.drives[0].M, above.drives[0].M);
  EXPECT_EQ(above.drives[0].F_load, below.drives[0].F_load);
  EXPECT_EQ(above.drives[1].M, below.drives[1].M);
  EXPECT_EQ(above.nc.v_max, below.nc.v_max);
  EXPECT_EQ(above.name, below.name);
}

TEST_F(IdentifiedFileTest, IsTheMachineOfAScenarioAndOfErrorModels) {
  write("identified.toml", kExample + "[errors.known]\nEYX = { constant_um = 3.0 }\n");
  const std::string scenario = write("scenario.toml",
                                     "machine = \"identified.toml\"\n[program]\nfile = \"p.ngc\"\n"
                                     "[[case]]\nname = \"one\"\n");
  write("p.ngc", "G17 G21 G90 G94 F600\nG1 X1\nM2\n");
  const model::Scenario read = read_scenario(scenario, {"machine.axis.X.friction.coulomb=25.0"});
  EXPECT_EQ(read.machine.drives[0].M, 95.11);
  EXPECT_EQ(read.machine.drives[0].friction.Fc_positive, 25.0);
  EXPECT_EQ(read.errors.count("known"), 1U);
  EXPECT_EQ(read.resolved.find("based_on"), std::string::npos) << "it needs no other file";
  EXPECT_EQ(read.resolved.find("identified"), std::string::npos);
  EXPECT_EQ(read_resolved_scenario(read.resolved, "again").machine.drives[0].M, 95.11);
  EXPECT_EQ(read_error_file(path("identified.toml"), read.machine.chain.layout).count("known"), 1U);
}

// The upper one wins, and [identified] is a matter of the file that holds it.
TEST_F(IdentifiedFileTest, MayBeBasedOnAnotherOne) {
  write("identified.toml", kExample);
  const std::string above =
      write("above.toml", "based_on = \"identified.toml\"\n[axis.X]\nmoving_mass = 96.0\n");
  InputFiles files;
  const MachineDocument document = machine_document(above, files);
  EXPECT_FALSE(document.identified);
  EXPECT_EQ(document.files.size(), 3U);
  const model::MachineSettings machine = read_machine_file(above);
  EXPECT_EQ(machine.drives[0].M, 96.0);
  EXPECT_EQ(machine.drives[0].friction.Fc_positive, 19.98);
}

TEST_F(IdentifiedFileTest, IsAMachineFileAndNoScenario) {
  EXPECT_TRUE(is_machine_file(write("identified.toml", kExample)));
  EXPECT_TRUE(is_machine_file(write("above.toml", "based_on = \"start_machine.toml\"\n")));
  EXPECT_FALSE(is_machine_file(SERVOMILL_SOURCE_DIR "/scenarios/guevel2025/experiment1.toml"));
  EXPECT_FALSE(is_machine_file(write("none.toml", "based_on = \"gone.toml\"\n")));
}

TEST_F(IdentifiedFileTest, IsNamedWhereItIsTakenForAScenario) {
  try {
    read_scenario(write("identified.toml", kExample));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(
        error.what(),
        path("identified.toml") +
            ": error: is a machine, not a scenario; use it in a scenario as machine = \"FILE\"");
  }
}

TEST_F(IdentifiedFileTest, TakesValuesInAnyUnitOfTheirKind) {
  const std::string text =
      "based_on = \"start_machine.toml\"\n[axis.X]\nmoving_mass = \"95110 g\"\nlead_mm = 20.0\n"
      "velocity_bandwidth = 200.0\n[nc]\nvelocity_feed_forward = 1\n"
      "[identified]\nkeys = [\"axis.X.moving_mass\", \"axis.X.lead_mm\", "
      "\"axis.X.velocity_bandwidth\", \"nc.velocity_feed_forward\"]\n"
      "units = [\"kg\", \"um\", \"rad/s\", \"1\"]\nvalues = [95.11, 20e3, 200, 1.0]\n"
      "covariance = [[1.0, 0, 0, 0], [0, 1.0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 0.0]]\n";
  EXPECT_EQ(refusal(text), "accepted");
}

TEST_F(IdentifiedFileTest, RefusesWrongBasesAsScenariosDo) {
  EXPECT_EQ(refusal_of("\"start_machine.toml\"", "3"),
            "identified.toml:1:12: error: based_on must be the name of a machine file");
  EXPECT_EQ(refusal_of("start_machine", "gone"),
            "identified.toml:1:12: error: based_on = \"gone.toml\"; no such file");
  EXPECT_EQ(refusal_of("start_machine", "identified"),
            "identified.toml:1:12: error: based_on nested deeper than 8; one of the machine files "
            "may be based on itself");
  write("scenario.toml", "machine = \"start_machine.toml\"\n[[case]]\nname = \"one\"\n");
  EXPECT_EQ(refusal_of("start_machine", "scenario"),
            "identified.toml:1:12: error: based_on must be the name of a machine file; this is a "
            "scenario");
}

TEST_F(IdentifiedFileTest, RefusesListsThatDoNotFit) {
  EXPECT_EQ(refusal_of("units = [\"kg\", \"N\"]", "units = [\"kg\"]"),
            "identified.toml:8:9: error: identified.units = [\"kg\"]; has 1 items; must have 2, "
            "one per key");
  EXPECT_EQ(refusal_of("values = [95.11, 19.98]", "values = [95.11, 19.98, 1.0]"),
            "identified.toml:9:10: error: identified.values = [95.11, 19.98, 1.0]; has 3 items; "
            "must have 2, one per key");
  EXPECT_EQ(refusal_of("covariance = [[0.36, 0.01], [0.01, 0.04]]\n", ""),
            "identified.toml:6:1: error: identified.covariance is missing");
  EXPECT_EQ(refusal_of("[0.01, 0.04]]", "[0.01]]"),
            "identified.toml:10:14: error: identified.covariance = [[0.36, 0.01], [0.01]]; must be "
            "2 rows of 2 numbers, one per key");
  EXPECT_EQ(
      refusal_of("[0.01, 0.04]]", "0.04]"),
      "identified.toml:10:29: error: identified.covariance[1] = 0.04; must be a list of numbers");
  EXPECT_EQ(refusal_of("[0.01, 0.04]]", "[0.01, inf]]"),
            "identified.toml:10:36: error: identified.covariance[1][1] = inf; must be a finite "
            "number");
  EXPECT_EQ(refusal_of("\"axis.X.friction.coulomb\"]", "\"axis.X.moving_mass\"]"),
            "identified.toml:7:8: error: identified.keys = [\"axis.X.moving_mass\", "
            "\"axis.X.moving_mass\"]; lists axis.X.moving_mass twice");
  EXPECT_EQ(refusal_of("axis.X.gravity_load", "axis.X.moving_mass"),
            "identified.toml:11:18: error: identified.unidentifiable = [\"axis.X.moving_mass\"]; "
            "lists axis.X.moving_mass, which is also one of keys; a key is either identified or "
            "unidentifiable");
  EXPECT_EQ(refusal("based_on = \"start_machine.toml\"\n[identified]\nkeys = []\nunits = []\n"
                    "values = []\ncovariance = []\n"),
            "identified.toml:3:8: error: identified.keys = []; must list at least one key");
  EXPECT_EQ(refusal_of("[identified]\n", "[identified]\ncovarianse = 3\n"),
            "identified.toml:7:1: error: identified.covarianse is not known; did you mean "
            "'covariance', which is also given?");
}

TEST_F(IdentifiedFileTest, RefusesValuesThatAreNotThoseOfTheMachine) {
  EXPECT_EQ(refusal_of("values = [95.11", "values = [96.11"),
            "identified.toml:9:10: error: identified.values = [96.11, 19.98]; sets "
            "axis.X.moving_mass to 96.11 kg, but line 3 sets it to \"95.11 kg\"");
  EXPECT_EQ(
      refusal_of("coulomb = \"19.98 N\"", "breakaway = \"19.98 N\""),
      "identified.toml:7:8: error: identified.keys = [\"axis.X.moving_mass\", "
      "\"axis.X.friction.coulomb\"]; lists axis.X.friction.coulomb, which this file does not set");
  EXPECT_EQ(refusal_of("units = [\"kg\", \"N\"]", "units = [\"kg\", \"kN\"]"),
            "identified.toml:9:10: error: identified.values = [95.11, 19.98]; sets "
            "axis.X.friction.coulomb to 19.98 kN, but line 5 sets it to \"19.98 N\"");
  EXPECT_EQ(refusal_of("units = [\"kg\", \"N\"]", "units = [\"kgs\", \"N\"]"),
            "identified.toml:8:9: error: identified.units = [\"kgs\", \"N\"]; unknown unit 'kgs'; "
            "did you mean 'kg'?; use \"1\" for a dimensionless number");
  EXPECT_EQ(refusal_of("\"95.11 kg\"", "\"95.11 N\""),
            "identified.toml:9:10: error: identified.values = [95.11, 19.98]; sets "
            "axis.X.moving_mass to 95.11 kg, but line 3 sets it to \"95.11 N\"");
}

TEST_F(IdentifiedFileTest, RefusesMatricesThatAreNoCovariance) {
  EXPECT_EQ(refusal_of("[[0.36, 0.01], [0.01, 0.04]]", "[[0.36, 0.02], [0.01, 0.04]]"),
            "identified.toml:10:14: error: identified.covariance = [[0.36, 0.02], [0.01, 0.04]]; "
            "must be symmetric; [0][1] is 0.02, [1][0] is 0.01");
  EXPECT_EQ(refusal_of("[[0.36, 0.01], [0.01, 0.04]]", "[[0.36, 0.01], [0.01, -0.04]]"),
            "identified.toml:10:14: error: identified.covariance = [[0.36, 0.01], [0.01, -0.04]]; "
            "must have variances >= 0; [1][1] is -0.04");
  EXPECT_EQ(
      refusal_of("[[0.36, 0.01], [0.01, 0.04]]", "[[0.36, 0.13], [0.13, 0.04]]"),
      "identified.toml:10:14: error: identified.covariance = [[0.36, 0.13], [0.13, 0.04]]; must be "
      "positive semi-definite; [0][1] = 0.13 exceeds the product 0.12 of both standard deviations");
}

// Three numbers that are pairwise possible, but not together.
TEST_F(IdentifiedFileTest, RefusesAnIndefiniteMatrix) {
  const std::string text =
      "based_on = \"start_machine.toml\"\n[axis.X]\nmoving_mass = 700.0\n[axis.Y]\n"
      "moving_mass = 600.0\n[axis.Z]\nmoving_mass = 500.0\n[identified]\n"
      "keys = [\"axis.X.moving_mass\", \"axis.Y.moving_mass\", \"axis.Z.moving_mass\"]\n"
      "units = [\"kg\", \"kg\", \"kg\"]\nvalues = [700, 600, 500]\n"
      "covariance = [[1, 0.9, -0.9], [0.9, 1, 0.9], [-0.9, 0.9, 1]]\n";
  EXPECT_EQ(refusal(text),
            "identified.toml:12:14: error: identified.covariance = [[1, 0.9, -0.9], [0.9, 1, 0.9], "
            "[-0.9, 0.9, 1]]; must be positive semi-definite; the smallest eigenvalue of the "
            "correlation matrix is -0.8");
}

TEST_F(IdentifiedFileTest, RefusesWhatTheMachineRefuses) {
  EXPECT_EQ(refusal_of("[axis.X]\nmoving_mass = \"95.11 kg\"",
                       "[axis.X]\nmoving_mass = \"95.11 kg\"\nmoving_mas = 3"),
            "identified.toml:4:1: error: axis.X.moving_mas is not known; did you mean "
            "'moving_mass', which is also given?");
}

IdentifiedFile example_file() {
  IdentifiedFile file;
  file.comments = {"Identified from two recordings.", "", "Residual 0.9 um."};
  file.based_on = "start_machine.toml";
  file.identified.keys = {"axis.X.moving_mass", "axis.X.friction.coulomb", "nc.Kv",
                          "axis.X.damping", "nc.velocity_feed_forward"};
  file.identified.units = {"kg", "N", "1/s", "N s/m", "1"};
  file.identified.values = {95.11, 19.98, 50.0 / 3.0, 4.1e4, 1.0};
  file.identified.covariance = Eigen::MatrixXd::Identity(5, 5) * 1e-3;
  file.identified.covariance(4, 4) = 1e-8;
  file.identified.unidentifiable = {"axis.X.gravity_load"};
  file.half_widths = {1.2345, 0.0312, 1e-7, 123.4, 2e-4};
  return file;
}

TEST_F(IdentifiedFileTest, IsWrittenForReading) {
  EXPECT_EQ(identified_text(example_file()),
            "# Identified from two recordings.\n"
            "#\n"
            "# Residual 0.9 um.\n"
            "based_on = \"start_machine.toml\"  # machine that was started from\n"
            "\n[axis.X]\n"
            "moving_mass = \"95.11 kg\"  # +- 1.2 kg (k = 2)\n"
            "damping = \"41000 N s/m\"  # +- 120 N s/m (k = 2)\n"
            "\n[axis.X.friction]\n"
            "coulomb = \"19.98 N\"  # +- 0.031 N (k = 2)\n"
            "\n[nc]\n"
            "Kv = \"16.666666666666668 1/s\"  # +- 1e-07 1/s (k = 2)\n"
            "velocity_feed_forward = 1  # +- 0.0002 (k = 2)\n"
            "\n[identified]\n"
            "keys = [\"axis.X.moving_mass\", \"axis.X.friction.coulomb\", \"nc.Kv\", "
            "\"axis.X.damping\", \"nc.velocity_feed_forward\"]\n"
            "units = [\"kg\", \"N\", \"1/s\", \"N s/m\", \"1\"]\n"
            "values = [95.11, 19.98, 16.666666666666668, 41000, 1]\n"
            "covariance = [  # products of the units\n"
            "  [0.001, 0, 0, 0, 0],\n"
            "  [0, 0.001, 0, 0, 0],\n"
            "  [0, 0, 0.001, 0, 0],\n"
            "  [0, 0, 0, 0.001, 0],\n"
            "  [0, 0, 0, 0, 1e-08],\n"
            "]\n"
            "unidentifiable = [\"axis.X.gravity_load\"]\n");
}

// Values and covariances of any digits and magnitude.
TEST_F(IdentifiedFileTest, IsReadAgainToTheSameBits) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 50; ++trial) {
    IdentifiedFile file = example_file();
    Eigen::MatrixXd factor(5, 1 + trial % 5);  // of any rank
    for (double& x : factor.reshaped()) x = normal(random) * std::pow(10.0, normal(random));
    const Eigen::MatrixXd product = factor * factor.transpose();
    file.identified.covariance = 0.5 * (product + product.transpose());
    for (double& x : file.identified.values) x *= 1.0 + 0.1 * std::tanh(normal(random));
    file.half_widths.clear();
    write_identified_file(path("out.toml"), file, true);
    InputFiles files;
    const IdentifiedValues read = *machine_document(path("out.toml"), files).identified;
    EXPECT_EQ(read.keys, file.identified.keys);
    EXPECT_EQ(read.units, file.identified.units);
    EXPECT_EQ(read.values, file.identified.values);
    EXPECT_EQ(read.covariance, file.identified.covariance);
    EXPECT_EQ(read_machine_file(path("out.toml")).drives[0].M, file.identified.values[0]);
  }
}

TEST_F(IdentifiedFileTest, IsNotWrittenWhereTheMachineRefusesIt) {
  IdentifiedFile file = example_file();
  file.identified.values[1] = -3.0;
  try {
    write_identified_file(path("out.toml"), file, false);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              path("out.toml") + ":11:11: error: axis.X.friction.coulomb = \"-3 N\"; must be >= 0");
  }
  EXPECT_FALSE(fs::exists(path("out.toml")));
  file.identified.values[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(write_identified_file(path("out.toml"), file, false), InputError);
  file.identified.values.pop_back();
  EXPECT_THROW(write_identified_file(path("out.toml"), file, false), std::logic_error);
  EXPECT_FALSE(fs::exists(path("out.toml")));
}

TEST_F(IdentifiedFileTest, OverwritesOnlyWhereForced) {
  write_identified_file(path("out.toml"), example_file(), false);
  EXPECT_THROW(write_identified_file(path("out.toml"), example_file(), false), InputError);
  EXPECT_NO_THROW(write_identified_file(path("out.toml"), example_file(), true));
}

}  // namespace
}  // namespace servomill::sim::input::identified_file_test
