/// Sweeps whose samples are drawn about identified values.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "sim/config/written_number.h"
#include "sim/input/read_design.h"
#include "sim/input/read_scenario.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/sweep/sweep.h"
#include "tests/text.h"

namespace servomill::sim::input::identified_samples_test {
namespace {

namespace fs = std::filesystem;

model::SweepDesign design_of(const std::string& toml) {
  const config::Document document = config::Document::from_text("[sweep]\n" + toml, "s.toml");
  config::Reader root(document);
  config::Reader table = root.table("sweep");
  InputFiles files;
  model::SweepDesign design = read_sweep(table, files).design;
  root.finish();
  return design;
}

// Three numbers of different units, correlated.
constexpr const char* kThree =
    "samples = {{ {}, identified = [{{ keys = [\"axis.X.moving_mass\", "
    "\"axis.X.friction.coulomb\", \"nc.velocity_feed_forward\"], units = [\"kg\", \"N\", \"1\"], "
    "values = [95.0, 20.0, 0.9], covariance = [[4.0, -0.5, 0.006], [-0.5, 0.25, 0.001], "
    "[0.006, 0.001, 1e-4]] }}] }}\n";

struct Moments {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

Moments moments_of(const model::SweepDesign& design, std::size_t keys) {
  const auto n = static_cast<Eigen::Index>(design.size());
  Eigen::MatrixXd values(static_cast<Eigen::Index>(keys), n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto point = design.point(static_cast<std::uint64_t>(i));
    for (std::size_t k = 0; k < keys; ++k) {
      values(static_cast<Eigen::Index>(k), i) = config::number_of(point.at(k));
    }
  }
  Moments out{values.rowwise().mean(), {}};
  values.colwise() -= out.mean;
  out.covariance = values * values.transpose() / static_cast<double>(n - 1);
  return out;
}

Eigen::Matrix3d covariance_of_three() {
  Eigen::Matrix3d out;
  out << 4.0, -0.5, 0.006, -0.5, 0.25, 0.001, 0.006, 0.001, 1e-4;
  return out;
}

// Five standard deviations of the estimates of 10^4 independent draws.
TEST(IdentifiedSamples, HaveMeanAndCovarianceOfTheTable) {
  constexpr double kDraws = 1e4, kBound = 5.0;
  const Eigen::Vector3d mean(95.0, 20.0, 0.9);
  const Eigen::Matrix3d wanted = covariance_of_three();
  for (const int seed : {1, 2, 3}) {
    const Moments found = moments_of(
        design_of(fmt::format(kThree, fmt::format("count = 10000, seed = {}", seed))), 3);
    for (Eigen::Index i = 0; i < 3; ++i) {
      EXPECT_LE(std::abs(found.mean[i] - mean[i]), kBound * std::sqrt(wanted(i, i) / kDraws));
      for (Eigen::Index j = 0; j < 3; ++j) {
        // variance of a sample covariance of normal numbers
        const double variance =
            (wanted(i, i) * wanted(j, j) + wanted(i, j) * wanted(i, j)) / (kDraws - 1.0);
        EXPECT_LE(std::abs(found.covariance(i, j) - wanted(i, j)), kBound * std::sqrt(variance));
      }
    }
  }
}

// The means of stratified designs: within a tenth of the standard error of independent draws.
TEST(IdentifiedSamples, AreStratifiedByTheDesigns) {
  const Eigen::Vector3d mean(95.0, 20.0, 0.9);
  const Eigen::Matrix3d wanted = covariance_of_three();
  for (const std::string design : {"sobol", "latin_hypercube"}) {
    const Moments found =
        moments_of(design_of(fmt::format(kThree, "design = \"" + design + "\", count = 8192")), 3);
    for (Eigen::Index i = 0; i < 3; ++i) {
      EXPECT_LE(std::abs(found.mean[i] - mean[i]), 0.1 * std::sqrt(wanted(i, i) / 8192.0))
          << design;
      // of independent draws, five standard deviations
      EXPECT_NEAR(found.covariance(i, i) / wanted(i, i), 1.0, 5.0 * std::sqrt(2.0 / 8192.0));
    }
  }
}

TEST(IdentifiedSamples, AreTextsInTheUnitsOfTheTable) {
  const model::SweepDesign design = design_of(fmt::format(kThree, "count = 3"));
  ASSERT_EQ(design.keys.size(), 3U);
  EXPECT_EQ(design.keys[0].key, "machine.axis.X.moving_mass");
  EXPECT_EQ(design.keys[1].key, "machine.axis.X.friction.coulomb");
  EXPECT_EQ(design.keys[2].key, "machine.nc.velocity_feed_forward");
  const auto point = design.point(0);
  EXPECT_TRUE(point[0].ends_with(" kg\"")) << point[0];
  EXPECT_TRUE(point[1].ends_with(" N\"")) << point[1];
  EXPECT_EQ(point[2].find('"'), std::string::npos) << "a plain number";
  EXPECT_EQ(design.column(0).unit, "kg");
  EXPECT_EQ(design.column(2).unit, "");
  EXPECT_EQ(design.sampled_dimensions, 3U);
}

// b = 20 - (a - 95) / 4: one dimension, and no draw leaves the line by more than its rounding.
TEST(IdentifiedSamples, OfASingularCovarianceLieOnTheirLine) {
  for (const std::string design : {"random", "sobol", "latin_hypercube"}) {
    const model::SweepDesign one = design_of(
        "samples = { design = \"" + design +
        "\", count = 1000, identified = [{ keys = [\"a\", \"b\"], units = [\"N\", \"N\"], values = "
        "[95.0, 20.0], covariance = [[4.0, -1.0], [-1.0, 0.25]] }] }\n");
    EXPECT_EQ(one.sampled_dimensions, 1U);
    for (std::uint64_t i = 0; i < one.size(); ++i) {
      const auto point = one.point(i);
      const double a = config::number_of(point[0]), b = config::number_of(point[1]);
      EXPECT_LE(std::abs(b - (20.0 - (a - 95.0) / 4.0)), 1e-14 * 95.0);
    }
  }
}

// Values of one file depend on each other, those of two files and own keys do not.
TEST(IdentifiedSamples, OfSeveralFilesAndOwnKeysHaveTheirOwnDimensions) {
  const std::string group =
      "{{ keys = [\"{0}1\", \"{0}2\"], units = [\"N\", \"N\"], values = [1.0, 2.0], "
      "covariance = [[1.0, 0.5], [0.5, 1.0]] }}";
  const model::SweepDesign design = design_of("samples = { count = 4000, seed = 5, identified = [" +
                                              fmt::format(fmt::runtime(group), "a") + ", " +
                                              fmt::format(fmt::runtime(group), "b") +
                                              "] }\nc = { normal = [3.0, 1.0] }\nd = [1, 2]\n");
  EXPECT_EQ(design.sampled_dimensions, 5U);
  EXPECT_EQ(design.size(), 8000U);
  EXPECT_EQ(design.point(0)[0], design.point(4000)[0]) << "the samples of every point of the grid";
  const Moments found = moments_of(design, 5);
  for (Eigen::Index i = 0; i < 5; ++i) {
    for (Eigen::Index j = 0; j < 5; ++j) {
      const double wanted = i == j ? 1.0 : i / 2 == j / 2 && i < 4 && j < 4 ? 0.5 : 0.0;
      EXPECT_NEAR(found.covariance(i, j), wanted, 5.0 * std::sqrt(2.0 / 4000.0));
    }
  }
}

class IdentifiedSamplesOfFiles : public testing::Test {
 protected:
  IdentifiedSamplesOfFiles() : folder_(fs::path(testing::TempDir()) / "servomill_samples") {
    fs::create_directories(folder_);
    const fs::path gallery = SERVOMILL_SOURCE_DIR "/tests/cli/gallery";
    for (const char* name : {"machine.toml", "part.ngc"}) {
      fs::copy_file(gallery / name, folder_ / name, fs::copy_options::overwrite_existing);
    }
    write("identified.toml",
          "based_on = \"machine.toml\"\n[axis.X]\nmoving_mass = 700\n[identified]\n"
          "keys = [\"axis.X.moving_mass\"]\nunits = [\"kg\"]\nvalues = [700]\n"
          "covariance = [[100.0]]\n");
  }
  ~IdentifiedSamplesOfFiles() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  model::Scenario scenario(const std::string& machine, const std::string& sweep) const {
    write("scenario.toml", fmt::format("machine = \"{}\"\nprogram.file = \"part.ngc\"\n"
                                       "program.parameters = {{ \"#101\" = 1394.0 }}\n"
                                       "[[case]]\nname = \"one\"\n[sweep]\n{}",
                                       machine, sweep));
    return read_scenario((folder_ / "scenario.toml").string());
  }
  std::string refusal(const std::string& machine, const std::string& sweep) const {
    try {
      scenario(machine, sweep);
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

  fs::path folder_;
};

TEST_F(IdentifiedSamplesOfFiles, NeedNoFileOnceTheScenarioIsRead) {
  const model::Scenario read = scenario(
      "identified.toml", "samples = { from = \"identified.toml\", count = 5, seed = 3 }\n");
  ASSERT_EQ(read.sweep.joint.size(), 1U);
  EXPECT_EQ(read.sweep.joint[0].mean[0], 700.0);
  EXPECT_EQ(read.sweep.sample_files.at(0).name, "identified.toml");
  fs::remove(folder_ / "identified.toml");
  const model::Scenario again = read_resolved_scenario(read.resolved, "again");
  for (std::uint64_t i = 0; i < 5; ++i) EXPECT_EQ(again.sweep.point(i), read.sweep.point(i));
  EXPECT_EQ(again.resolved, read.resolved);
}

TEST_F(IdentifiedSamplesOfFiles, RefuseFilesWithoutThem) {
  EXPECT_EQ(refusal("identified.toml", "samples = { from = \"machine.toml\", count = 5 }\n"),
            "scenario.toml:7:20: error: sweep.samples.from = \"machine.toml\"; has no table "
            "[identified]: there are no identified values to sample");
  EXPECT_EQ(
      refusal("identified.toml",
              "samples = { from = [\"identified.toml\", \"machine.toml\"], count = 5 }\n"),
      "scenario.toml:7:20: error: sweep.samples.from = [\"identified.toml\", "
      "\"machine.toml\"]; has no table [identified]: there are no identified values to sample "
      "in machine.toml");
  EXPECT_EQ(refusal("identified.toml", "samples = { from = \"gone.toml\", count = 5 }\n"),
            "scenario.toml:7:20: error: machine 'gone.toml' cannot be read: No such file or "
            "directory");
  EXPECT_EQ(refusal("identified.toml", "samples = { from = 3, count = 5 }\n"),
            "scenario.toml:7:20: error: sweep.samples.from = 3; must be a file name, or a list of "
            "file names");
}

TEST_F(IdentifiedSamplesOfFiles, RefuseKeysThatVaryTwice) {
  EXPECT_EQ(refusal("identified.toml",
                    "samples = { from = [\"identified.toml\", \"identified.toml\"], count = 5 }\n"),
            "scenario.toml:7:20: error: sweep.samples.from = [\"identified.toml\", "
            "\"identified.toml\"]; varies machine.axis.X.moving_mass a second time");
  EXPECT_EQ(refusal("identified.toml",
                    "samples = { from = \"identified.toml\", count = 5 }\n"
                    "machine.axis.X.moving_mass = [1.0, 2.0]\n"),
            "scenario.toml:8:30: error: sweep.machine.axis.X.moving_mass = [1.0, 2.0]; is varied "
            "twice");
}

// The samples of a machine that is not the one that is run would say nothing about it; a run alone
// may take any machine.
TEST_F(IdentifiedSamplesOfFiles, RefuseAnotherMachine) {
  const std::string sweep = "samples = { from = \"identified.toml\", count = 5 }\n";
  EXPECT_EQ(refusal("machine.toml", sweep), "accepted");
  const std::string path = (folder_ / "scenario.toml").string();
  EXPECT_EQ(fault_messages([&] { sweep::Sweep(path, {}); }),
            "sweep.samples: the mean of machine.axis.X.moving_mass is 700 kg, but the machine has "
            "\"750 kg\"; run the identified machine: machine = \"FILE\"\n");
  const std::string identified = (folder_ / "identified.toml").string();
  EXPECT_EQ(fault_messages([&] { sweep::Sweep(path, {"machine=" + identified}); }), "");
}

TEST_F(IdentifiedSamplesOfFiles, RefuseACovarianceOfZeros) {
  write(
      "identified.toml",
      "based_on = \"machine.toml\"\n[axis.X]\nmoving_mass = 700\n[identified]\n"
      "keys = [\"axis.X.moving_mass\"]\nunits = [\"kg\"]\nvalues = [700]\ncovariance = [[0.0]]\n");
  EXPECT_EQ(
      refusal("identified.toml", "samples = { from = \"identified.toml\", count = 5 }\n"),
      "scenario.toml:7:11: error: sweep.samples = {...}; has no key with a distribution to sample");
}

}  // namespace
}  // namespace servomill::sim::input::identified_samples_test
