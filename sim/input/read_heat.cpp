#include "sim/input/read_heat.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "plant/heat/temperature.h"
#include "sim/input/known_name.h"
#include "sim/input/read_errors.h"
#include "sim/model/heat.h"
#include "sim/model/machine.h"

namespace servomill::sim::input {
namespace {

constexpr config::Quantity kPower{.m = 2, .kg = 1, .s = -3};
constexpr config::Quantity kCapacity{.m = 2, .kg = 1, .s = -2, .K = -1};
constexpr config::Quantity kConductance{.m = 2, .kg = 1, .s = -3, .K = -1};

constexpr double kHour = 3600.0;
constexpr double kColdest = kelvin(-10.0), kWarmest = kelvin(100.0);  // of the structure
constexpr double kWarmestWinding = kelvin(180.0);

// A temperature in degC as K.
double read_degC(config::Reader& table, const char* key, double fallback) {
  return kelvin(table.real_or(key, celsius(fallback), config::kNumber,
                              {config::at_least(-100.0), config::at_most(1000.0)}));
}

bool is_plain(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
}

class HeatReader {
 public:
  HeatReader(config::Reader& heat, const model::MachineSettings& machine)
      : heat_(heat), machine_(machine) {}

  model::HeatSettings read() {
    const std::size_t before = heat_.faults();
    out_.reference = read_degC(heat_, "reference_degC", out_.reference);
    out_.clock = heat_.real_or("clock_h", 0.0, config::kTime, {config::at_least(0.0)});
    read_surroundings();
    read_bodies();
    read_sources();
    read_sensors();
    read_part();
    read_start();
    if (heat_.faults() == before) {
      for (const std::string& rule : plant::implausible(out_.network)) heat_.fault(rule);
    }
    return std::move(out_);
  }

 private:
  void read_surroundings() {
    config::Reader all = heat_.table("surroundings");
    for (const std::string& name : all.keys()) {
      config::Reader table = all.table(name);
      plant::Surroundings one;
      one.name = name;
      one.mean = read_degC(table, "mean_degC", one.mean);
      one.amplitude =
          table.real_or("amplitude_K", 0.0, config::kTemperature, {config::at_least(0.0)});
      one.period = table.real_or("period_h", one.period, config::kTime, {config::above(0.0)});
      one.warmest_at = table.real_or("warmest_at_h", 15.0 * kHour, config::kTime);
      if (one.mean - one.amplitude < kColdest || one.mean + one.amplitude > kWarmest) {
        all.fault(fmt::format("{}: from {:g} to {:g} degC; must be within -10 to 100 degC", name,
                              celsius(one.mean - one.amplitude),
                              celsius(one.mean + one.amplitude)));
      }
      surroundings_[name] = static_cast<int>(out_.network.surroundings.size());
      out_.network.surroundings.push_back(one);
    }
  }

  void read_bodies() {
    config::Reader all = heat_.table("body");
    for (const std::string& name : all.keys()) {  // links name bodies that come later, too
      bodies_[name] = static_cast<int>(bodies_.size());
      if (!is_plain(name)) all.fault(name + ": must consist of letters, digits and _");
      if (surroundings_.contains(name)) all.fault(name + ": is the name of surroundings, too");
    }
    for (const std::string& name : all.keys()) {
      config::Reader table = all.table(name);
      out_.network.bodies.push_back(
          {name, table.real("capacity_J_per_K", kCapacity, {config::above(0.0)})});
      const bool is_winding = table.boolean_or("winding", false);
      out_.coldest.push_back(kColdest);
      out_.warmest.push_back(is_winding ? kWarmestWinding : kWarmest);
      read_links(table, bodies_[name]);
      read_thermal_errors(table, bodies_[name], out_.errors);
    }
  }

  void read_links(config::Reader& body, int from) {
    if (!body.has("conductance_W_per_K")) return;  // others may name this one
    config::Reader links = body.table("conductance_W_per_K");
    for (const std::string& to : links.keys()) {
      const double G = links.real(to, kConductance, {config::at_least(0.0)});
      if (const auto around = surroundings_.find(to); around != surroundings_.end()) {
        out_.network.surface_links.push_back({from, around->second, G});
      } else if (const auto other = bodies_.find(to); other == bodies_.end()) {
        links.fault(to, "must be the name of a body or of surroundings: " + names());
      } else if (other->second == from) {
        links.fault(to, "leads back to the same body");
      } else if (are_linked(from, other->second)) {
        links.fault(to, fmt::format("is linked to {} there; one direction is enough",
                                    out_.network.bodies[static_cast<std::size_t>(from)].name));
      } else {
        out_.network.links.push_back({from, other->second, G});
      }
    }
  }

  bool are_linked(int a, int b) const {
    return std::any_of(out_.network.links.begin(), out_.network.links.end(),
                       [&](const plant::ThermalLink& one) {
                         return (one.from == a && one.to == b) || (one.from == b && one.to == a);
                       });
  }

  void read_thermal_errors(config::Reader& of, int index, std::vector<plant::ThermalError>& out) {
    if (!of.has("errors_per_K")) return;
    config::Reader table = of.table("errors_per_K");
    plant::ErrorModel errors = read_errors(table, MachineAxes(machine_));
    for (const Axis axis : kAllAxes) {
      for (const Axis direction : kAllAxes) {
        if (errors.component({direction, axis, false}).reversals.empty()) continue;
        table.fault("errors that depend on the temperature must not have a reversal");
      }
    }
    out.push_back({index, std::move(errors)});
  }

  void read_sources() {
    if (!heat_.has("source")) return;
    config::Reader all = heat_.table("source");
    for (const std::string& name : all.keys()) {
      config::Reader table = all.table(name);
      model::HeatSource source;
      source.name = name;
      source.body = read_body(table);
      constexpr std::array<std::string_view, 5> kKinds = {"constant", "spindle", "motor",
                                                          "friction", "cutting"};
      const std::size_t before = table.faults();
      source.kind = static_cast<model::HeatKind>(table.choice("kind", kKinds));
      if (table.faults() > before) {
        table.skip_rest();
        continue;
      }
      read_power(table, source);
      out_.sources.push_back(std::move(source));
    }
    check_cutting(all);
  }

  void check_cutting(config::Reader& all) const {
    double shares = 0.0;
    for (const model::HeatSource& one : out_.sources) {
      if (one.kind == model::HeatKind::cutting) shares += one.share;
    }
    if (shares > 1.0 + 1e-12) {
      all.fault(
          fmt::format("shares of the cutting power add up to {:g}; must not exceed 1", shares));
    }
  }

  void read_part() {
    if (!heat_.has("part")) return;
    config::Reader table = heat_.table("part");
    model::PartExpansion part;
    part.body = read_body(table);
    part.expansion =
        table.real("expansion", config::kExpansion, {config::at_least(0.0), config::at_most(2e-4)});
    const std::vector<double> fixed = table.reals("fixed_at_mm", config::kLength);
    if (fixed.size() == 3) {
      part.fixed = Eigen::Map<const Eigen::Vector3d>(fixed.data());
    } else if (table.has("fixed_at_mm")) {
      table.fault("fixed_at_mm", "must be three coordinates, X, Y, Z of the workpiece");
    }
    out_.part = part;
  }

  int read_body(config::Reader& source) {
    const std::size_t before = source.faults();
    const std::string name = source.text("body");
    const auto found = bodies_.find(name);
    if (found != bodies_.end()) return found->second;
    if (source.faults() == before) must_be_known(source, "body", name, "body", body_names());
    return 0;
  }

  void read_power(config::Reader& table, model::HeatSource& source) {
    switch (source.kind) {
      case model::HeatKind::constant:
        source.power = table.real("power_W", kPower, {config::at_least(0.0)});
        return;
      case model::HeatKind::spindle:
        read_spindle(table, source);
        return;
      case model::HeatKind::motor:
        source.joint = read_axis(table);
        source.resistance = table.real("resistance", config::kResistance, {config::above(0.0)});
        return;
      case model::HeatKind::friction:
        source.joint = read_axis(table);
        source.share = table.real_or("share", 1.0, config::kNumber,
                                     {config::above(0.0), config::at_most(1.0)});
        return;
      case model::HeatKind::cutting:
        source.share =
            table.real("share", config::kNumber, {config::above(0.0), config::at_most(1.0)});
        return;
    }
  }

  static void read_spindle(config::Reader& table, model::HeatSource& source) {
    const std::size_t before = table.faults();
    std::vector<double>& speeds = source.spindle.s;
    std::vector<double>& powers = source.spindle.error;
    speeds = table.reals("speed_rpm", config::kAngularVelocity, {config::at_least(0.0)});
    powers = table.reals("power_W", kPower, {config::at_least(0.0)});
    if (table.faults() > before) return;
    const bool rises =
        std::adjacent_find(speeds.begin(), speeds.end(), std::greater_equal<>()) == speeds.end();
    if (speeds.size() < 2 || speeds.front() != 0.0 || !rises) {
      table.fault("speed_rpm", "must have at least two speeds, rising from 0");
    } else if (powers.size() != speeds.size()) {
      table.fault("power_W", fmt::format("has {} powers for {} speeds; must have one for each",
                                         powers.size(), speeds.size()));
    }
  }

  int read_axis(config::Reader& table) {
    const std::size_t before = table.faults();
    const std::string text = table.text("axis");
    const JointLayout& layout = machine_.chain.layout;
    std::vector<char> letters;
    for (int j = 0; j < kJoints; ++j) {
      if (!layout.has(j)) continue;
      if (text == std::string(1, layout.letter_of(j))) return j;
      letters.push_back(layout.letter_of(j));
    }
    if (table.faults() == before) {
      table.fault("axis",
                  fmt::format("must be an axis of the machine: {}", fmt::join(letters, ", ")));
    }
    return 0;
  }

  void read_sensors() {
    out_.noise_seed =
        static_cast<std::uint64_t>(heat_.integer_or("noise_seed", 0, {config::at_least(0.0)}));
    if (!heat_.has("sensor")) return;
    config::Reader all = heat_.table("sensor");
    for (const std::string& name : all.keys()) {
      config::Reader table = all.table(name);
      if (!is_plain(name)) all.fault(name + ": must consist of letters, digits and _");
      const int body = read_body(table);
      out_.sensors.push_back({name, body,
                              table.real_or("noise_K", 0.0, config::kTemperature,
                                            {config::at_least(0.0), config::at_most(100.0)})});
      read_thermal_errors(table, static_cast<int>(out_.sensors.size()) - 1, out_.sensor_errors);
    }
  }

  void read_start() {
    if (!heat_.has("start_degC")) return;
    const double T = read_degC(heat_, "start_degC", out_.reference);
    if (T < kColdest || T > kWarmest) {
      heat_.fault("start_degC", "must be within -10 to 100 degC");
    }
    out_.start.assign(out_.network.bodies.size(), T);
  }

  std::vector<std::string> body_names() const {
    std::vector<std::string> all;
    for (const auto& [name, index] : bodies_) all.push_back(name);
    return all;
  }

  std::string names() const {
    std::vector<std::string> all = body_names();
    for (const auto& [name, index] : surroundings_) all.push_back(name);
    return fmt::format("{}", fmt::join(all, ", "));
  }

  config::Reader& heat_;
  const model::MachineSettings& machine_;
  model::HeatSettings out_;
  std::map<std::string, int> bodies_, surroundings_;
};

}  // namespace

std::shared_ptr<const model::HeatSettings> read_heat(config::Reader& machine_table,
                                                     const model::MachineSettings& machine) {
  if (!machine_table.has("heat")) return nullptr;
  config::Reader heat = machine_table.table("heat");
  return std::make_shared<const model::HeatSettings>(HeatReader(heat, machine).read());
}

}  // namespace servomill::sim::input
