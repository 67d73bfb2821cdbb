/// Points of a sweep record what their quantities read, and no more.
#include "sim/evaluation/outputs_read.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>

#include "sim/evaluation/quantity.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"
#include "sim/run/point_batch.h"

namespace servomill::sim::evaluation {
namespace {

// Every quantity that says what it reads, of the circles of a machine with imposed errors.
std::string all_that_say_what_they_read() {
  std::string list;
  for (const QuantityEntry& entry : quantities()) {
    if (!entry.reads) continue;
    std::string one = fmt::format("name=\"{}\"", entry.name);
    if (entry.needs_axis()) one += ",axis=\"X\"";
    if (entry.has_statistic) one += ",statistic=\"rms\"";
    if (entry.needs_baseline) one += ",baseline=\"exact\",cases=[\"table\"]";
    if (entry.circles == 1) one += ",sections=[\"8 m/min ccw\"]";
    if (entry.circles == 2) one += ",sections=[\"8 m/min ccw\",\"8 m/min cw\"]";
    list += fmt::format("{}{{{}}}", list.empty() ? "" : ",", one);
  }
  return "quantity=[" + list + "]";
}

model::Scenario circles() {
  return input::read_scenario(
      SERVOMILL_SOURCE_DIR "/scenarios/iso/circular.toml",
      {"errors.bent.EXX.harmonic={amplitude_um=5.0,period_mm=30.0}", "imposed=\"bent\"",
       "program.feed_override=2.0",
       "case=[{name=\"exact\"},{name=\"table\",strategy=[{type=\"table\",model=\"bent\","
       "action=\"impose\",spacing_mm=1.6384,from_mm=-100.0,to_mm=100.0}]}]",
       all_that_say_what_they_read()});
}

std::vector<ComparisonRow> rows_of(const model::Scenario& scenario, run::Keep keep) {
  const engine::StopFlag never = false;
  std::atomic<float> progress = 0.0F;
  std::vector<ComparisonRow> rows;
  run::run_batch({&scenario, 1}, never, progress,
                 [&](std::vector<run::EndedPoint>&& ended) {
                   EXPECT_EQ(ended.front().result.status, run::PointStatus::done)
                       << ended.front().result.reason;
                   rows = std::move(ended.front().result.rows);
                 },
                 {.keep = keep});
  return rows;
}

TEST(OutputsRead, GiveQuantitiesTheBitsThatTheyHaveOfAWholeRun) {
  const model::Scenario scenario = circles();
  ASSERT_TRUE(outputs_read_by(scenario.quantities).signals);
  const auto whole = rows_of(scenario, run::Keep::series);
  const auto read = rows_of(scenario, run::Keep::comparison);
  ASSERT_EQ(whole.size(), read.size());
  ASSERT_GT(whole.size(), 20U);
  for (std::size_t n = 0; n < whole.size(); ++n) {
    EXPECT_TRUE(std::isfinite(whole[n].value)) << whole[n].quantity << ": " << whole[n].note;
    EXPECT_EQ(std::bit_cast<std::uint64_t>(read[n].value),
              std::bit_cast<std::uint64_t>(whole[n].value))
        << whole[n].quantity;
    EXPECT_EQ(read[n].note, whole[n].note) << whole[n].quantity;
  }
}

TEST(OutputsRead, AreThoseOfEachQuantity) {
  model::QuantitySpec contour, blocks, jerk, ball;
  contour.name = "contour_error";
  blocks.name = "blocks";
  jerk.name = "jerk_demand";
  ball.name = "axial_ball_deviation";  // does not say
  const auto read = [](std::vector<model::QuantitySpec> specs) { return outputs_read_by(specs); };
  using Names = engine::RunOutputs::Names;
  EXPECT_EQ(read({contour, blocks}).signals, Names{"contour_error"});
  EXPECT_FALSE(read({contour, blocks}).demands);
  EXPECT_EQ(read({jerk}).signals, Names());
  EXPECT_TRUE(read({jerk}).demands);
  EXPECT_EQ(read({contour, ball, blocks}).signals, std::nullopt);
}

}  // namespace
}  // namespace servomill::sim::evaluation
