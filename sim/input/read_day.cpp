#include "sim/input/read_day.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/input/known_name.h"
#include "sim/model/scenario.h"
#include "sim/model/working_day.h"

namespace servomill::sim::input {
namespace {

constexpr double kLongestTool = 100.0;            // m: farther places are slips, and overflow
constexpr double kLongestPhase = 30.0 * 86400.0;  // s
constexpr int kCycleLimit = 1000000;

// Positions of all axes: none is taken to be at 0.
Joints read_pose(config::Reader& place, const model::MachineSettings& machine) {
  config::Reader at = place.table("at");
  Joints Q = Joints::Zero();
  for (int j = 0; j < kJoints; ++j) {
    if (!machine.chain.layout.has(j)) continue;
    const bool linear = j < kLinearJoints;
    const std::string key =
        fmt::format("{}_{}", machine.chain.layout.letter_of(j), linear ? "mm" : "deg");
    const std::size_t before = at.faults();
    Q[j] = at.real(key, linear ? config::kLength : config::kAngle);
    const double lower = machine.nc.lower[j], upper = machine.nc.upper[j];
    if (at.faults() > before || (Q[j] >= lower && Q[j] <= upper)) continue;
    const double unit = linear ? mm : deg;
    at.fault(key,
             fmt::format("must be within the travel, {:g} to {:g}", lower / unit, upper / unit));
  }
  return Q;
}

class DayReader {
 public:
  DayReader(config::Reader& day, const model::Scenario& scenario)
      : day_(day), scenario_(scenario) {}

  model::WorkingDay read() {
    out_.sample = day_.real_or("sample_min", out_.sample, config::kTime,
                               {config::at_least(1.0), config::at_most(86400.0)});
    out_.probe_noise =
        day_.real_or("probe_noise_um", 0.0, config::kLength, {config::at_least(0.0)});
    out_.noise_seed =
        static_cast<std::uint64_t>(day_.integer_or("noise_seed", 0, {config::at_least(0.0)}));
    for (config::Reader& place : day_.tables("place")) read_place(place);
    read_remeasuring();
    for (config::Reader& phase : day_.tables("phase")) read_phase(phase);
    return std::move(out_);
  }

 private:
  void read_place(config::Reader& table) {
    model::DayPlace place;
    place.name = table.text("name");
    if (place.name.find('/') != std::string::npos) table.fault("name", "must not have a /");
    if (place_of(place.name)) table.fault("name", "appears twice");
    place.Q = read_pose(table, scenario_.machine);
    place.p_ST.z() = -table.real("tool_length_mm", config::kLength,
                                 {config::at_least(0.0), config::at_most(kLongestTool)});
    out_.places.push_back(std::move(place));
  }

  void read_remeasuring() {
    if (!day_.has("remeasure")) return;
    config::Reader table = day_.table("remeasure");
    model::Remeasuring one;
    one.place = read_datum(table);
    one.every = table.real("every_min", config::kTime,
                           {config::above(0.0), config::at_most(kLongestPhase)});
    one.duration = table.real_or("duration_min", one.duration, config::kTime,
                                 {config::at_least(0.0), config::at_most(kLongestPhase)});
    out_.remeasuring = one;
  }

  void read_phase(config::Reader& table) {
    constexpr std::array<std::string_view, 4> kActivities = {"idle", "spindle", "program", "probe"};
    const std::size_t before = table.faults();
    model::DayPhase phase;
    phase.activity = static_cast<model::Activity>(table.choice("activity", kActivities));
    if (table.faults() > before) {
      table.skip_rest();
      return;
    }
    if (phase.activity == model::Activity::program) {
      phase.cycles = static_cast<int>(
          table.integer("cycles", {config::at_least(1.0), config::at_most(kCycleLimit)}));
    } else if (phase.activity == model::Activity::probe) {
      phase.place = read_datum(table);
    } else {
      phase.duration = table.real("duration_min", config::kTime,
                                  {config::above(0.0), config::at_most(kLongestPhase)});
    }
    if (phase.activity == model::Activity::spindle) {
      phase.spindle = table.real("speed_rpm", config::kAngularVelocity, {config::above(0.0)});
    }
    out_.phases.push_back(phase);
  }

  int read_datum(config::Reader& table) {
    const std::size_t before = table.faults();
    const std::string name = table.text("place");
    if (table.faults() > before) return 0;
    std::vector<std::string> names;
    for (const model::DayPlace& place : out_.places) names.push_back(place.name);
    must_be_known(table, "place", name, "place", names);
    return place_of(name).value_or(0);
  }

  std::optional<int> place_of(const std::string& name) const {
    for (std::size_t k = 0; k < out_.places.size(); ++k) {
      if (out_.places[k].name == name) return static_cast<int>(k);
    }
    return std::nullopt;
  }

  config::Reader& day_;
  const model::Scenario& scenario_;
  model::WorkingDay out_;
};

}  // namespace

std::shared_ptr<const model::WorkingDay> read_day(config::Reader& root,
                                                  const model::Scenario& scenario) {
  if (!root.has("day")) return nullptr;
  config::Reader day = root.table("day");
  if (scenario.machine.heat == nullptr && root.faults() == 0) {
    day.fault("needs [heat] in the machine of the scenario; that of a case alone is not enough");
    day.skip_rest();
    return nullptr;
  }
  return std::make_shared<const model::WorkingDay>(DayReader(day, scenario).read());
}

}  // namespace servomill::sim::input
