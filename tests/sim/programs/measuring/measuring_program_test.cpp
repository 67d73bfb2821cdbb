// Measuring programs of touch probes: every control reads the moves that were meant, and a program
// that says anything else is refused.
#include "sim/programs/measuring/measuring_program.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "plant/kinematics/structure.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "tests/text.h"

namespace servomill::sim::programs::measuring_program_test {
namespace {

constexpr double kLength = 0.1;  // m

model::MachineSettings trunnion() {
  model::MachineSettings out;
  out.chain = plant::make_chain(plant::parse_structure("[w C' A' b X Y Z (C1) t]"));
  out.chain.at(Axis::A).centre.z() = 0.05;
  out.nc.lower << -0.4, -0.3, -0.2, -2.0, -std::numeric_limits<double>::infinity();
  out.nc.upper << 0.4, 0.3, 0.5, 2.0, std::numeric_limits<double>::infinity();
  return out;
}

readings::Readings plan_of(const model::MachineSettings& machine, std::vector<double> tilts) {
  readings::Group group;
  group.kind = readings::Kind::sphere;
  group.p_ST = {0.0, 0.0, -kLength};
  group.spheres = {"sphere 1"};
  for (const double a : tilts) {
    for (int c = 0; c < 4; ++c) {
      Joints rotary = Joints::Zero();
      rotary[3] = a;
      rotary[4] = 90.0 * deg * c;
      readings::Reading reading;
      reading.Q = *plant::inverse_fixed_rotary(machine.chain, {0.1, 0.0, 0.06}, rotary, group.p_ST);
      group.rows.push_back(reading);
    }
  }
  readings::Readings out;
  out.groups = {group};
  return out;
}

class Measuring : public testing::TestWithParam<Dialect> {
 protected:
  Measuring()
      : moves_(measuring_moves(plan_of(machine_, {-0.5, 0.0, 0.5}), machine_, settings_, kLength)) {
  }

  std::string text() const {
    return measuring_program(moves_, machine_, settings_, kLength, GetParam()).text;
  }
  std::string faults(const std::string& text) const {
    return fault_messages([&] {
      verify_measuring_program({text, {}}, moves_, machine_, settings_, kLength, GetParam());
    });
  }
  static std::string changed(std::string text, const std::string& old, const std::string& now) {
    const std::size_t at = text.find(old);
    EXPECT_NE(at, std::string::npos) << old;
    return at == std::string::npos ? text : text.replace(at, old.size(), now);
  }

  model::MachineSettings machine_ = trunnion();
  ProbingSettings settings_;
  MeasuringMoves moves_;
};

TEST_P(Measuring, IsReadAsItWasMeant) {
  EXPECT_GT(moves_.touches, 40);
  EXPECT_EQ(faults(text()), "") << text().substr(0, 2000);
}

// Any line that is lost shows: a probing move, a retreat, a tool length, the end.
TEST_P(Measuring, NoticesALineThatIsMissing) {
  const std::string whole = text();
  const std::string_view words[] = {"G38.2", "G31 ", "MEAS=1", "TCH PROBE 0.1", "G0 X", "L X"};
  int tried = 0;
  for (const std::string_view word : words) {
    const std::size_t at = whole.find(word);
    if (at == std::string::npos) continue;
    const std::size_t begin = whole.rfind('\n', at) + 1, end = whole.find('\n', at) + 1;
    EXPECT_NE(faults(whole.substr(0, begin) + whole.substr(end)), "") << word;
    ++tried;
  }
  EXPECT_GE(tried, 1);
}

TEST_P(Measuring, NoticesAMoveWithoutTheProbeArmed) {
  const std::pair<std::string, std::string> words[] = {
      {"G38.2", "G1"}, {"G31 ", "G1 "}, {"MEAS=1 ", ""}, {"Q5 Z-", "Q5 Z+"}};
  const auto& [old, now] = words[GetParam() == Dialect::linuxcnc  ? 0
                                 : GetParam() == Dialect::fanuc   ? 1
                                 : GetParam() == Dialect::siemens ? 2
                                                                  : 3];
  EXPECT_NE(faults(changed(text(), old, now)), "");
}

TEST_P(Measuring, NoticesASpindleThatTurns) {
  const std::string old = GetParam() == Dialect::heidenhain ? "L M5" : "M5";
  const std::string now = GetParam() == Dialect::heidenhain ? "L M3" : "S100 M3";
  EXPECT_NE(faults(changed(text(), old, now)), "");
}

INSTANTIATE_TEST_SUITE_P(EachControl, Measuring,
                         testing::Values(Dialect::linuxcnc, Dialect::heidenhain, Dialect::fanuc,
                                         Dialect::siemens));

// Each touch is followed by a rapid back to where it began, along the same axis; it begins at the
// clearance and ends behind the surface at the latest.
TEST(MeasuringSteps, EveryTouchIsFollowedByItsRetreat) {
  const model::MachineSettings machine = trunnion();
  const ProbingSettings settings;
  const auto moves = measuring_moves(plan_of(machine, {0.0, 0.5}), machine, settings, kLength);
  std::array<std::optional<double>, kAxisWords> now;
  for (std::size_t i = 0; i < moves.steps.size(); ++i) {
    const MeasuringStep& step = moves.steps[i];
    const auto named = std::count_if(step.to.begin(), step.to.end(),
                                     [](const auto& to) { return to.has_value(); });
    ASSERT_EQ(named, 1);
    if (step.is_probe) {
      const auto axis = static_cast<std::size_t>(
          std::find_if(step.to.begin(), step.to.end(), [](const auto& to) { return bool(to); }) -
          step.to.begin());
      ASSERT_LT(i + 1, moves.steps.size());
      EXPECT_FALSE(moves.steps[i + 1].is_probe);
      EXPECT_EQ(moves.steps[i + 1].to[axis], now[axis]);
      EXPECT_NEAR(std::abs(*step.to[axis] - *now[axis]), settings.clearance + settings.beyond,
                  1e-12);
      continue;
    }
    for (std::size_t axis = 0; axis < step.to.size(); ++axis) {
      if (step.to[axis]) now[axis] = step.to[axis];
    }
  }
}

// A touch is never from the side on which the table rises.
TEST(MeasuringSteps, TouchesFromTheSideThatFallsAway) {
  const model::MachineSettings machine = trunnion();
  const auto moves = measuring_moves(plan_of(machine, {0.5}), machine, {}, kLength);
  const auto along = [&](int axis, double sign) {
    int count = 0;
    double now = 0.0;
    for (const MeasuringStep& step : moves.steps) {
      const auto& to = step.to[std::size_t(axis)];
      if (step.is_probe && to && (*to - now) * sign > 0.0) ++count;
      if (!step.is_probe && to) now = *to;
    }
    return count;
  };
  EXPECT_EQ(along(0, 1.0), 4);
  EXPECT_EQ(along(0, -1.0), 4);
  EXPECT_EQ(along(2, -1.0), 4);
  EXPECT_EQ(along(1, 1.0) + along(1, -1.0), 4);
}

TEST(MeasuringSteps, LeavesOutWhatItCannotReachAndSaysSo) {
  const model::MachineSettings machine = trunnion();
  const auto moves = measuring_moves(plan_of(machine, {0.0, 1.2}), machine, {}, kLength);
  EXPECT_EQ(moves.notes,
            std::vector<std::string>{"sphere 1: the table is rotated by more than 60 deg from the "
                                     "spindle, at 4 poses that are omitted"});
}

TEST(MeasuringSteps, RefusesMachinesWhoseSpindleTurns) {
  model::MachineSettings machine = trunnion();
  machine.chain = plant::make_chain(plant::parse_structure("[w b X Y Z C A (C1) t]"));
  EXPECT_NE(fault_messages([&] {
              measuring_moves({}, machine, {}, kLength);
            }).find("carries the spindle"),
            std::string::npos);
}

}  // namespace
}  // namespace servomill::sim::programs::measuring_program_test
