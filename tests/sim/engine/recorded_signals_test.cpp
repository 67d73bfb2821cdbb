#include "sim/engine/recorded_signals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "plant/vocabulary/units.h"
#include "sim/input/read_scenario.h"
#include "sim/model/machine.h"

namespace servomill::sim::engine::recorded_signals_test {
namespace {

std::vector<records::Signal> signals_on(const std::string& machine, SignalParts parts = {}) {
  return recorded_signals(
      input::read_machine_file(SERVOMILL_SOURCE_DIR "/scenarios/machines/" + machine), parts);
}

const records::Signal* find(const std::vector<records::Signal>& signals, const std::string& name) {
  const auto at = std::find_if(signals.begin(), signals.end(),
                               [&](const records::Signal& one) { return one.name == name; });
  return at == signals.end() ? nullptr : &*at;
}

TEST(RecordedSignals, HaveAColumnForEachAxisOfTheMachine) {
  const auto five = signals_on("hsm600u.toml");
  EXPECT_EQ(find(five, "following_error_linear")->columns(), 3u);
  EXPECT_EQ(find(five, "following_error_rotary")->columns(), 2u);
  const auto three = signals_on("router_3axis.toml");
  EXPECT_EQ(find(three, "ref_linear")->columns(), 3u);
  EXPECT_EQ(find(three, "ref_rotary"), nullptr);
}

TEST(RecordedSignals, HaveTheNamesOfAPartOnlyWhereTheCaseHasIt) {
  const auto plain = signals_on("hsm600u.toml");
  for (const char* name : {"imposed_linear", "uncorrectable_tcp", "cutting_force", "spindle_angle",
                           "programmed_linear"}) {
    EXPECT_EQ(find(plain, name), nullptr) << name;
  }
  EXPECT_NE(find(signals_on("hsm600u.toml", {.imposed = true}), "imposed_linear"), nullptr);
  EXPECT_NE(find(signals_on("hsm600u.toml", {.uncorrectable = true}), "uncorrectable_axis"),
            nullptr);
  EXPECT_NE(find(signals_on("hsm600u.toml", {.cut = true}), "structural_deflection"), nullptr);
  EXPECT_NE(find(signals_on("hsm600u.toml", {.cut = true, .teeth = true}), "spindle_angle"),
            nullptr);
  EXPECT_NE(find(signals_on("hsm600u.toml", {.programmed = true}), "programmed_linear"), nullptr);
}

// 1 nm: 2^-20 mm = 0.95 nm, 2^-10 um = 0.98 nm; 1 nm at 1 m: 1 nrad = 5.7e-8 deg, above 2^-25 deg.
TEST(RecordedSignals, AreRoundedToThePowerOfTwoNextBelowTheResolution) {
  auto signals = signals_on("hsm600u.toml", {.cut = true, .teeth = true});
  round_to({.resolution = 1e-9, .storage = records::Storage::float32}, signals);
  EXPECT_EQ(find(signals, "true_linear")->quantum, std::ldexp(1.0, -20));
  EXPECT_EQ(find(signals, "contour_error")->quantum, std::ldexp(1.0, -10));
  EXPECT_EQ(find(signals, "true_rotary")->quantum, std::ldexp(1.0, -25));
  EXPECT_EQ(find(signals, "tool_axis_true")->quantum, std::ldexp(1.0, -30));
  EXPECT_EQ(find(signals, "true_linear")->storage, records::Storage::float32);
  // grows with every turn: float32 would lose the angle after a minute
  EXPECT_EQ(find(signals, "spindle_angle")->storage, records::Storage::float64);
  for (const char* name : {"time", "line", "rapid"}) {
    EXPECT_EQ(find(signals, name)->quantum, 0.0) << name;
    const bool is_time = find(signals, name)->name == "time";
    EXPECT_EQ(find(signals, name)->storage,
              is_time ? records::Storage::float64 : records::Storage::int32)
        << name;
  }
  EXPECT_EQ(find(signals, "s")->storage, records::Storage::float64);
}

TEST(RecordedSignals, KeepEveryBitWithoutAResolution) {
  auto signals = signals_on("hsm600u.toml");
  round_to({}, signals);
  for (const records::Signal& one : signals) EXPECT_EQ(one.quantum, 0.0) << one.name;
}

}  // namespace
}  // namespace servomill::sim::engine::recorded_signals_test
