#include "sim/model/design.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "sim/config/written_number.h"
#include "sim/input/read_design.h"

namespace servomill::sim::input::design_test {
namespace {

using Point = std::vector<std::string>;

model::SweepDesign design_of(const std::string& toml) {
  const config::Document document = config::Document::from_text("[sweep]\n" + toml, "s.toml");
  config::Reader root(document);
  config::Reader table = root.table("sweep");
  InputFiles files;
  model::SweepDesign design = read_sweep(table, files).design;
  root.finish();
  return design;
}

std::vector<Point> all_points(const model::SweepDesign& design) {
  std::vector<Point> points;
  for (std::uint64_t i = 0; i < design.size(); ++i) points.push_back(design.point(i));
  return points;
}

std::string refusal(const std::string& toml) {
  try {
    design_of(toml);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Design, OfOneListTakesItsValuesInTurn) {
  const model::SweepDesign design = design_of("\"program.feed_override\" = [0.5, 1.0]\n");
  EXPECT_EQ(design.keys.at(0).key, "program.feed_override");
  EXPECT_EQ(all_points(design), (std::vector<Point>{{"0.5"}, {"1.0"}}));
}

TEST(Design, OfAGridLetsTheLastKeyVaryFastest) {
  const model::SweepDesign design = design_of("a = [1, 2]\nb = ['x', \"y\", true]\n");
  EXPECT_EQ(all_points(design), (std::vector<Point>{{"1", "'x'"},
                                                    {"1", "\"y\""},
                                                    {"1", "true"},
                                                    {"2", "'x'"},
                                                    {"2", "\"y\""},
                                                    {"2", "true"}}));
}

TEST(Design, HasAnyNumberOfKeys) {
  const model::SweepDesign design = design_of("a=[1,2]\nb=[1,2]\nc=[1,2]\nd=[1,2]\ne=[1,2]\n");
  const auto points = all_points(design);
  EXPECT_EQ(points.size(), 32U);
  EXPECT_EQ(std::set<Point>(points.begin(), points.end()).size(), 32U);
}

TEST(Design, TakesKeysAsTomlNestsThem) {
  const model::SweepDesign design =
      design_of("machine.nc.Kv = [60, 80]\nprogram.parameters.\"#<a.b>\" = [1]\n");
  EXPECT_EQ(design.keys.at(0).key, "machine.nc.Kv");
  EXPECT_EQ(design.keys.at(1).key, "program.parameters.\"#<a.b>\"");
}

TEST(Design, ReadsTheExampleOfItsHeader) {
  const model::SweepDesign design = design_of(
      "\"program.feed_override\" = [0.5, 1.0]\n"
      "\"machine.nc.Kv\" = { log = [\"40 1/s\", \"160 1/s\"], count = 5 }\n"
      "samples = { design = \"sobol\", count = 256, seed = 1 }\n"
      "\"errors.identified.EYX.harmonic.amplitude_um\" = { normal = [150.0, 3.0] }\n"
      "\"case.table.strategy.time_constant_ms\" = { uniform = [30.0, 50.0] }\n"
      "\"case.table.strategy.injection_point\" = { choice = [\"position_command\", "
      "\"feed_forward\"] }\n"
      "[[sweep.zip]]\n"
      "\"machine.axis.X.v_max\" = [\"20 m/min\", \"40 m/min\"]\n"
      "\"machine.axis.Y.v_max\" = [\"10 m/min\", \"20 m/min\"]\n");
  EXPECT_EQ(design.size(), 2U * 5U * 2U * 256U);
  EXPECT_EQ(design.keys.size(), 7U);
  EXPECT_EQ(design.point(0)[1], "\"40 1/s\"");
  EXPECT_EQ(design.point(256)[5], "\"40 m/min\"");  // behind all samples
  EXPECT_EQ(design.point(256)[6], "\"20 m/min\"");
}

TEST(Design, SpacesRangesEvenlyOrInEqualRatios) {
  const model::SweepDesign linear = design_of("a = { linear = [1.0, 2.0], count = 5 }\n");
  EXPECT_EQ(all_points(linear), (std::vector<Point>{{"1"}, {"1.25"}, {"1.5"}, {"1.75"}, {"2"}}));
  // 0.2 + 2 / 3 (2.6 - 0.2) rounds to 1.7999999999999998
  const model::SweepDesign rounded = design_of("a = { linear = [0.2, 2.6], count = 4 }\n");
  EXPECT_EQ(all_points(rounded), (std::vector<Point>{{"0.2"}, {"1"}, {"1.8"}, {"2.6"}}));
  const model::SweepDesign log = design_of("a = { log = [\"1 mm\", \"100 mm\"], count = 3 }\n");
  EXPECT_EQ(all_points(log), (std::vector<Point>{{"\"1 mm\""}, {"\"10 mm\""}, {"\"100 mm\""}}));
  EXPECT_EQ(log.column(0).unit, "mm");
}

TEST(Design, VariesListsTogether) {
  const model::SweepDesign design =
      design_of("a = [1, 2]\n[[sweep.zip]]\nb = [10, 20]\nc.d = ['x', 'y']\n");
  EXPECT_EQ(all_points(design),
            (std::vector<Point>{
                {"1", "10", "'x'"}, {"1", "20", "'y'"}, {"2", "10", "'x'"}, {"2", "20", "'y'"}}));
}

const std::string kSampled =
    "samples = { design = \"latin_hypercube\", count = 500, seed = 7 }\n"
    "u = { uniform = [10.0, 20.0] }\n"
    "v = { log_uniform = [\"1 um\", \"100 um\"] }\n"
    "w = { normal = [150.0, 3.0] }\n"
    "x = { choice = ['a', 'b'] }\n";

std::vector<double> column(const model::SweepDesign& design, std::size_t key) {
  std::vector<double> out;
  for (std::uint64_t i = 0; i < design.size(); ++i)
    out.push_back(config::number_of(design.point(i)[key]));
  return out;
}

// A stratified sample meets each quantile to within one stratum: here to 1/500 of the range.
TEST(Design, SamplesAsItsDistributionsSay) {
  const model::SweepDesign design = design_of(kSampled);
  ASSERT_EQ(design.size(), 500U);
  auto u = column(design, 0), v = column(design, 1), w = column(design, 2);
  for (auto* all : {&u, &v, &w}) std::sort(all->begin(), all->end());
  EXPECT_GE(u.front(), 10.0);
  EXPECT_LE(u.back(), 20.0);
  EXPECT_NEAR(u[250], 15.0, 10.0 / 500);
  EXPECT_GE(v.front(), 1.0);
  EXPECT_LE(v.back(), 100.0);
  EXPECT_NEAR(v[250], 10.0, 10.0 * std::log(100.0) / 500);
  EXPECT_NEAR(w[250], 150.0, 3.0 * std::sqrt(2.0 * M_PI) / 500);
  EXPECT_NEAR(w[420], 150.0 + 3.0 * 0.994458, 3.0 / 0.243 / 500);  // 0.84; density 0.243 there
  std::size_t a = 0;
  for (std::uint64_t i = 0; i < design.size(); ++i) a += design.point(i)[3] == "'a'";
  EXPECT_EQ(a, 250U);
}

TEST(Design, RunsTheSameSamplesAtEveryPointOfTheGrid) {
  const model::SweepDesign design = design_of("feed = [1, 2, 3]\n" + kSampled);
  ASSERT_EQ(design.size(), 1500U);
  for (std::uint64_t i = 0; i < 500; ++i) {
    Point one = design.point(i), other = design.point(1000 + i);
    EXPECT_EQ(one[0], "1");
    EXPECT_EQ(other[0], "3");
    one.erase(one.begin());
    other.erase(other.begin());
    EXPECT_EQ(one, other);
  }
}

TEST(Design, ComputesAPointWithoutTheOthers) {
  const model::SweepDesign design = design_of(
      "samples = { design = \"sobol\", count = 10_000_000 }\nu = { uniform = [0.0, 1.0] }\n");
  const Point last = design.point(9'999'999);
  EXPECT_EQ(design_of("samples = { design = \"sobol\", count = 10_000_000 }\n"
                      "u = { uniform = [0.0, 1.0] }\n")
                .point(9'999'999),
            last);
  EXPECT_NE(design.point(9'999'998), last);
}

TEST(Design, WritesNumbersThatReadAgainToTheSameBits) {
  const model::SweepDesign design = design_of(
      "samples = { design = \"random\", count = 100 }\n"
      "u = { uniform = [0.0, 1e-7] }\n");
  for (std::uint64_t i = 0; i < design.size(); ++i) {
    const config::Document document = config::Document::from_text("u = " + design.point(i)[0], "");
    EXPECT_EQ(document.root().find("u")->real, config::number_of(design.point(i)[0]));
  }
}

TEST(Column, IsOfNumbersWhereAllValuesAre) {
  const model::SweepDesign design = design_of(
      "a = [1, 2.5]\nb = [\"60 1/s\", \"80 1/s\"]\nc = [\"60 1/s\", \"3 m/min/mm\"]\n"
      "d = [\"table\", \"gcode\", \"table\"]\ne = [\"auto\", 5]\nf = [0x10, 1_000]\n");
  EXPECT_TRUE(design.column(0).numeric);
  EXPECT_EQ(design.column(0).unit, "");
  EXPECT_TRUE(design.column(1).numeric);
  EXPECT_EQ(design.column(1).unit, "1/s");
  EXPECT_FALSE(design.column(2).numeric);
  EXPECT_EQ(design.column(3).texts, (model::ValueTexts{"\"table\"", "\"gcode\""}));
  EXPECT_EQ(design.column(4).texts, (model::ValueTexts{"\"auto\"", "5"}));
  EXPECT_TRUE(design.column(5).numeric);
  EXPECT_EQ(config::number_of(design.point(0)[5]), 16.0);
  EXPECT_EQ(config::number_of(design.point(1)[5]), 1000.0);
}

TEST(NumberOf, ReadsTheNumberOfAValue) {
  EXPECT_EQ(config::number_of("1.5"), 1.5);
  EXPECT_EQ(config::number_of("-2e3"), -2000.0);
  EXPECT_EQ(config::number_of("\"60 1/s\""), 60.0);
  EXPECT_EQ(config::number_of("'3 mm'"), 3.0);
  EXPECT_TRUE(std::isnan(config::number_of("\"table\"")));
  EXPECT_TRUE(std::isnan(config::number_of("")));
  EXPECT_TRUE(std::isnan(config::number_of("\"\"")));
}

const std::string kForm =
    "; must be a list of at least one value, a range such as { linear = [0.5, 2.0], count = 4 } or "
    "a distribution such as { normal = [1.0, 0.1] }";

TEST(ReadSweep, RefusesWhatIsNoDesign) {
  EXPECT_EQ(refusal("a = []\n"), "s.toml:2:5: error: sweep.a = []" + kForm);
  EXPECT_EQ(refusal("a = 1\n"), "s.toml:2:5: error: sweep.a = 1" + kForm);
  EXPECT_EQ(refusal("a = {}\n"), "s.toml:2:5: error: sweep.a = {...}" + kForm);
  EXPECT_EQ(refusal("a = [1]\n[[sweep.zip]]\na = [2]\n"),
            "s.toml:4:5: error: sweep.zip[0].a = [2]; is varied twice");
  EXPECT_EQ(refusal("\"sweep.a\" = [1]\n"),
            "s.toml:2:13: error: sweep.\"sweep.a\" = [1]; is common to all points; sweep cannot be "
            "swept");
  EXPECT_EQ(refusal("quantity = [[]]\n"),
            "s.toml:2:12: error: sweep.quantity = [[]]; is common to all points; quantity cannot "
            "be swept");
}

TEST(ReadSweep, RefusesListsThatCannotGoTogether) {
  EXPECT_EQ(refusal("[[sweep.zip]]\na = [1, 2]\nb = [1, 2, 3]\n"),
            "s.toml:4:5: error: sweep.zip[0].b = [1, 2, 3]; has 3 values, a has 2: zipped lists "
            "must have equal length");
  EXPECT_EQ(refusal("[[sweep.zip]]\na = 1\n"),
            "s.toml:3:5: error: sweep.zip[0].a = 1; must be a list of at least one value");
  EXPECT_EQ(refusal("[[sweep.zip]]\n"), "s.toml:2:1: error: sweep.zip[0]: does not name a key");
}

TEST(ReadSweep, RefusesRangesThatAreNone) {
  const std::string two = "; must be two numbers, the first and the last, in one unit";
  EXPECT_EQ(refusal("a = { linear = [1], count = 3 }\n"),
            "s.toml:2:16: error: sweep.a.linear = [1]" + two);
  EXPECT_EQ(refusal("a = { linear = [\"1 mm\", \"2 m\"], count = 3 }\n"),
            "s.toml:2:16: error: sweep.a.linear = [\"1 mm\", \"2 m\"]" + two);
  EXPECT_EQ(refusal("a = { linear = [1, 1], count = 3 }\n"),
            "s.toml:2:16: error: sweep.a.linear = [1, 1]; must be two different numbers");
  EXPECT_EQ(refusal("a = { log = [0, 1], count = 3 }\n"),
            "s.toml:2:13: error: sweep.a.log = [0, 1]; must have numbers > 0");
  EXPECT_EQ(refusal("a = { linear = [1, 2] }\n"), "s.toml:2:5: error: sweep.a.count is missing");
  EXPECT_EQ(refusal("a = { linear = [1, 2], count = 1 }\n"),
            "s.toml:2:32: error: sweep.a.count = 1; must be >= 2");
  EXPECT_EQ(refusal("a = { linear = [1, 2], cuont = 2 }\n"),
            "s.toml:2:5: error: sweep.a.count is missing\n"
            "s.toml:2:24: error: sweep.a.cuont is not known; did you mean 'count'?");
}

TEST(ReadSweep, RefusesMoreKeysToSampleThanThereAreDimensions) {
  std::string toml = "samples = { design = \"random\", count = 3 }\n";
  for (std::size_t k = 0; k < model::kMaxDimensions; ++k) {
    toml += "a" + std::to_string(k) + " = { choice = [1] }\n";
  }
  EXPECT_EQ(design_of(toml).sampled_dimensions, model::kMaxDimensions);
  for (const std::string form : {"{ choice = [1] }", "{ uniform = [0, 1] }"}) {
    EXPECT_EQ(refusal(toml + "b = " + form + "\n"),
              "s.toml:3670:5: error: sweep.b = {...}; exceeds the limit of 3667 sampled keys");
  }
}

TEST(ReadSweep, RefusesDistributionsThatAreNone) {
  const std::string samples = "samples = { design = \"random\", count = 3 }\n";
  EXPECT_EQ(refusal(samples + "a = { normal = [1.0, 0.0] }\n"),
            "s.toml:3:16: error: sweep.a.normal = [1.0, 0.0]; must have a standard deviation > 0");
  EXPECT_EQ(
      refusal(samples + "a = { uniform = [2, 1] }\n"),
      "s.toml:3:17: error: sweep.a.uniform = [2, 1]; must be [lower, upper] with lower < upper");
  EXPECT_EQ(refusal(samples + "a = { log_uniform = [-1, 1] }\n"),
            "s.toml:3:21: error: sweep.a.log_uniform = [-1, 1]; must have numbers > 0");
  EXPECT_EQ(refusal(samples + "a = { choice = [] }\n"),
            "s.toml:3:16: error: sweep.a.choice = []; must be a list of at least one value");
  EXPECT_EQ(
      refusal(samples + "a = { normal = [1.0, nan] }\n"),
      "s.toml:3:16: error: sweep.a.normal = [1.0, nan]; must be two numbers, the mean and the "
      "standard deviation, in one unit");
}

TEST(ReadSweep, RefusesSamplesWithoutDistributionAndTheOtherWayRound) {
  EXPECT_EQ(refusal("a = { normal = [1.0, 0.1] }\n"),
            "s.toml:1:1: error: sweep: samples is missing: keys with a distribution need, for "
            "example, samples = { design = \"latin_hypercube\", count = 100 }");
  EXPECT_EQ(refusal("samples = { design = \"sobol\", count = 3 }\na = [1]\n"),
            "s.toml:2:11: error: sweep.samples = {...}; has no key with a distribution to sample");
  EXPECT_EQ(refusal("samples = { design = \"sobl\", count = 0 }\na = { normal = [1.0, 0.1] }\n"),
            "s.toml:2:22: error: sweep.samples.design = \"sobl\"; must be one of random, "
            "latin_hypercube, sobol; did you mean 'sobol'?\n"
            "s.toml:2:38: error: sweep.samples.count = 0; must be >= 1");
}

TEST(ReadSweep, RefusesMoreThanTenMillionPoints) {
  EXPECT_EQ(design_of("a = { linear = [0, 1], count = 10_000_000 }\n").size(), model::kMaxPoints);
  EXPECT_EQ(refusal("a = { linear = [0, 1], count = 10_000_001 }\n"),
            "s.toml:1:1: error: sweep: has 10000001 points; must be <= 10000000");
  EXPECT_EQ(refusal("a = { linear = [0, 1], count = 9_000_000_000_000_000 }\n"
                    "b = { linear = [0, 1], count = 9_000_000_000_000_000 }\n"),
            "s.toml:1:1: error: sweep: has 8.1e+31 points; must be <= "
            "10000000");
}

TEST(Range, HasNoDigitsOfRounding) {
  const model::SweepDesign design =
      design_of("\"program.feed_override\" = { linear = [0.2, 2.0], count = 10 }\n");
  EXPECT_EQ(
      all_points(design),
      (std::vector<Point>{
          {"0.2"}, {"0.4"}, {"0.6"}, {"0.8"}, {"1"}, {"1.2"}, {"1.4"}, {"1.6"}, {"1.8"}, {"2"}}));
}

}  // namespace
}  // namespace servomill::sim::input::design_test
