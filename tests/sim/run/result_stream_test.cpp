/// Results on the way from a child process to its parent.
#include "sim/run/result_stream.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>

namespace servomill::sim::run::result_stream_test {
namespace {

constexpr std::chrono::milliseconds kPatience{10000};

std::vector<records::Signal> signals() {
  return {{.name = "time", .units = "s", .long_name = "time", .labels = "", .scale = ""},
          {.name = "true_linear",
           .units = "mm",
           .long_name = "actual position",
           .labels = "XYZ",
           .scale = "axis_linear",
           .storage = records::Storage::float64,
           .quantum = 0x1p-20}};
}

double value(std::size_t row, std::size_t column) {
  if (row == 7) return std::numeric_limits<double>::quiet_NaN();
  return std::sin(static_cast<double>(row)) / static_cast<double>(column + 1);
}

records::Series some_series(std::size_t rows, const records::RowKeeping& keeping) {
  records::RowKeeper keeper(signals(), keeping, rows);
  for (std::size_t row = 0; row < rows; ++row) {
    const double values[] = {value(row, 0), value(row, 1), value(row, 2), value(row, 3)};
    keeper.add(values);
  }
  return keeper.take();
}

engine::CaseResult sent(const std::shared_ptr<engine::CaseResult>& result,
                        const records::RowKeeping& keeping) {
  strategies::PluginChild child("strategy x (x.so)", [&] {
    return [&](strategies::ProcessPipe& to) { write_result(*result, to); };
  });
  child.begin();
  while (!child.wait(kPatience)) {
  }
  return read_result(child, keeping);
}

void expect_same(const records::Series& one, const records::Series& other) {
  ASSERT_EQ(one.rows(), other.rows());
  ASSERT_EQ(one.width(), other.width());
  for (std::size_t k = 0; k < one.signals().size(); ++k) {
    const records::Signal &a = one.signals()[k], &b = other.signals()[k];
    EXPECT_EQ(a.name + a.units + a.long_name + a.labels + a.scale,
              b.name + b.units + b.long_name + b.labels + b.scale);
    EXPECT_EQ(a.offset, b.offset);
    EXPECT_EQ(a.storage, b.storage);
    EXPECT_EQ(a.quantum, b.quantum);
  }
  for (std::size_t row = 0; row < one.rows(); ++row) {
    for (std::size_t c = 0; c < one.width(); ++c) {
      const double a = one.at(row, c), b = other.at(row, c);
      EXPECT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << row << " " << c;
    }
  }
}

// Rows in memory or on the disk, on either side.
TEST(ResultStream, KeepsEveryBit) {
  const records::RowKeeping in_memory, on_disk = {.folder = "", .most_in_memory = 0.0};
  records::RowKeeping encoded;
  encoded.encodes = true;
  for (const records::RowKeeping& there : {in_memory, on_disk}) {
    for (const records::RowKeeping& here : {in_memory, on_disk, encoded}) {
      for (const std::size_t rows : {1UL, 1024UL, 20001UL}) {
        const auto result = std::make_shared<engine::CaseResult>();
        result->outcome = {false, false, "axis Y: following error beyond 10 mm", 'Y', 1.25};
        result->servo = some_series(rows, there);
        result->last_ticks = some_series(3, in_memory);
        result->saturations = {{.joint = 1, .of_rate = true, .limit = 0.1, .first = 0.2}, {}};
        result->demands.motion[2][4] = {123.0, 0.7};
        result->simulated_time = 1.26;
        const engine::CaseResult got = sent(result, here);
        EXPECT_FALSE(got.outcome.finished);
        EXPECT_FALSE(got.outcome.interrupted);
        EXPECT_EQ(got.outcome.reason, result->outcome.reason);
        EXPECT_EQ(got.outcome.axis, 'Y');
        EXPECT_EQ(got.outcome.time, 1.25);
        EXPECT_EQ(got.demands.motion[2][4].size, 123.0);
        EXPECT_EQ(got.demands.motion[2][4].time, 0.7);
        EXPECT_EQ(got.simulated_time, 1.26);
        ASSERT_EQ(got.saturations.size(), 2U);
        EXPECT_EQ(got.saturations[0].joint, 1);
        EXPECT_TRUE(got.saturations[0].of_rate);
        EXPECT_EQ(got.saturations[0].first, 0.2);
        expect_same(result->servo, got.servo);
        EXPECT_EQ(got.servo.pages() != nullptr, here.most_in_memory == 0.0 || here.encodes);
        expect_same(result->last_ticks, got.last_ticks);
        EXPECT_EQ(got.last_ticks.pages() != nullptr, here.most_in_memory == 0.0);
      }
    }
  }
}

// A case that has stopped where it begins has no last ticks.
TEST(ResultStream, KeepsWhatIsEmpty) {
  const auto result = std::make_shared<engine::CaseResult>();
  const engine::CaseResult got = sent(result, {});
  EXPECT_TRUE(got.outcome.finished);
  EXPECT_EQ(got.servo.rows(), 0U);
  EXPECT_EQ(got.last_ticks.width(), 0U);
  EXPECT_TRUE(got.saturations.empty());
}

TEST(ResultStream, SaysWhyThereIsNone) {
  const auto why = [](const strategies::PluginChild::Work& work) -> std::string {
    strategies::PluginChild child("strategy x (x.so)", work);
    child.begin();
    try {
      while (!child.wait(kPatience)) {
      }
      read_result(child, {});
    } catch (const strategies::PluginFailed& failed) {
      return failed.what();
    } catch (const std::runtime_error& error) {
      return std::string("error: ") + error.what();
    }
    return "";
  };
  using Result = strategies::PluginChild::Result;
  EXPECT_EQ(why([]() -> Result { throw std::runtime_error("no room"); }), "error: no room");
  EXPECT_EQ(why([]() -> Result { ::_exit(3); }),
            "strategy x (x.so): the plug-in ended its process with status 3");
  EXPECT_EQ(why([]() -> Result { return [](strategies::ProcessPipe&) { ::_exit(4); }; }),
            "strategy x (x.so): the plug-in ended its process with status 4");
  EXPECT_EQ(why([]() -> Result {
              ::kill(::getpid(), SIGKILL);
              throw std::logic_error("lives on");
            }),
            "strategy x (x.so): its process was ended by signal 9");
}

}  // namespace
}  // namespace servomill::sim::run::result_stream_test
