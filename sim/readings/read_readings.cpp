#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "plant/kinematics/structure.h"
#include "plant/vocabulary/units.h"
#include "plant/vocabulary/user_file.h"
#include "sim/config/document.h"
#include "sim/config/reader.h"
#include "sim/readings/read_rows.h"
#include "sim/readings/readings.h"

namespace servomill::sim::readings {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 6> kAxisNames = {"X", "Y", "Z", "A", "B", "C"};
constexpr std::array<std::string_view, 2> kTools = {"unknown", "adjusted"};
constexpr std::array<std::string_view, 2> kFeatures = {"surface", "centre"};
constexpr std::int64_t kMaxWaves = 8;
constexpr std::int64_t kTargets = 11;
constexpr std::int64_t kMaxTargets = 10'000;
constexpr double kSteel = 11.5e-6;  // 1/K

std::string beside(const std::string& file, const std::string& path) {
  return (fs::path(file).parent_path() / path).lexically_normal().string();
}

// One item of the list `group`.
class GroupReader {
 public:
  GroupReader(config::Reader& table, const Readings& all, const plant::MachineChain& chain,
              Numbers numbers)
      : table_(table), all_(all), layout_(chain.layout), numbers_(numbers) {}

  Group read(std::size_t number) {
    group_.place = table_.place("kind");
    group_.name = table_.text_or("name", fmt::format("group {}", number));
    const std::size_t before = table_.faults();
    group_.kind = static_cast<Kind>(table_.choice("kind", kKinds));
    if (table_.faults() > before) {
      table_.skip_rest();
      return group_;
    }
    read_axes();
    read_place();
    read_lengths();
    read_uncertainty();
    read_expansion();
    read_dead_path();
    group_.drifts = table_.boolean_or("drift", false);
    if (group_.kind == Kind::squareness) {
      read_squareness();
    } else {
      group_.file = beside(all_.path, table_.text("readings"));
    }
    return group_;
  }

 private:
  std::optional<Axis> read_axis(std::string_view key) {
    const auto axis = static_cast<Axis>(table_.choice(key, kAxisNames));
    if (layout_.joint_of(axis)) return axis;
    table_.fault(key, "is not an axis of the machine");
    return std::nullopt;
  }

  void read_axes() {
    switch (group_.kind) {
      case Kind::positioning:
        if (table_.has("axis")) group_.axis = read_axis("axis");
        return;
      case Kind::straightness:
      case Kind::angle: {
        group_.axis = read_axis("axis");
        const auto direction = static_cast<Axis>(table_.choice("direction", kAxisNames));
        group_.direction = direction;
        const bool wants_linear = group_.kind == Kind::straightness;
        if (is_linear(direction) != wants_linear) {
          table_.fault("direction", wants_linear ? "must be X, Y or Z" : "must be A, B or C");
        } else if (wants_linear && group_.axis == group_.direction) {
          table_.fault("direction",
                       "is the direction of the axis itself: use kind = \"positioning\"");
        }
        return;
      }
      case Kind::circle:
        read_plane("plane");
        return;
      case Kind::squareness:
        read_plane("axes");
        return;
      default:
        return;
    }
  }

  void read_plane(std::string_view key) {
    const std::string text = table_.text(key);
    const bool two = text.size() == 2 && axis_of(text[0]) && axis_of(text[1]);
    if (!two || text[0] == text[1] || !is_linear(*axis_of(text[0])) ||
        !is_linear(*axis_of(text[1]))) {
      table_.fault(key, "must be two linear axes, such as \"XY\"");
      return;
    }
    group_.plane = {*axis_of(text[0]), *axis_of(text[1])};
    for (const Axis axis : group_.plane) {
      if (!layout_.joint_of(axis))
        table_.fault(key, "contains an axis that the machine does not have");
    }
  }

  void read_place() {
    config::Reader at = table_.table_or_empty("at");
    for (const Axis axis : kAllAxes) {
      const auto joint = layout_.joint_of(axis);
      if (!joint) continue;
      const bool linear = is_linear(axis);
      const std::string key = fmt::format("{}_{}", letter(axis), linear ? "mm" : "deg");
      group_.stands[static_cast<std::size_t>(*joint)] = at.has(key);
      group_.at[*joint] = at.real_or(key, 0.0, linear ? config::kLength : config::kAngle);
    }
    group_.p_ST = read_point("point_mm");
    if (group_.kind == Kind::ball_bar || group_.kind == Kind::r_test ||
        is_of_spheres(group_.kind)) {
      group_.tool_is_known = table_.choice_or("tool", 0, kTools) == 1;
    }
  }

  Eigen::Vector3d read_point(std::string_view key) {
    const auto numbers = table_.reals(key, config::kLength);
    if (numbers.size() == 3) return {numbers[0], numbers[1], numbers[2]};
    if (!numbers.empty()) table_.fault(key, "must be three numbers, X, Y and Z");
    return Eigen::Vector3d::Zero();
  }

  // Lengths of the instrument, and how well they are known.
  void read_lengths() {
    const auto length = [this](std::string_view key) {
      return table_.real(key, config::kLength, {config::above(0.0)});
    };
    std::string_view key = "radius_uncertainty_um";
    switch (group_.kind) {
      case Kind::circle:
        group_.radius = length("radius_mm");
        break;
      case Kind::ball_bar:
        group_.length = length("length_mm");
        group_.ball_W = read_point("ball_mm");
        key = "length_uncertainty_um";
        break;
      case Kind::touch:
        group_.radius = 0.5 * (length("sphere_mm") + length("stylus_mm"));
        read_lobes();
        read_artefact();
        break;
      case Kind::sphere:
        return read_artefact();
      case Kind::part:
        group_.is_surface = table_.choice_or("feature", 0, kFeatures) == 0;
        break;
      default:
        return;
    }
    if (table_.has(key)) {
      group_.size_uncertainty = table_.real(key, config::kLength, {config::above(0.0)});
    }
  }

  void read_lobes() {
    if (!table_.has("pretravel")) return;
    config::Reader table = table_.table("pretravel");
    group_.lobes = static_cast<int>(
        table.integer("waves", {config::at_least(2.0), config::at_most(double(kMaxWaves))}));
    group_.lobe_size = table.real("size_um", config::kLength, {config::above(0.0)});
  }

  void read_artefact() {
    if (!table_.has("artefact")) return;
    group_.artefact = find_named(all_.artefacts, "artefact");
  }

  // Index of the item whose name a key holds.
  template <typename Item>
  std::optional<std::size_t> find_named(const std::vector<Item>& items, std::string_view key) {
    const std::string name = table_.text(key);
    const auto found =
        std::find_if(items.begin(), items.end(), [&](const Item& one) { return one.name == name; });
    if (found != items.end()) return static_cast<std::size_t>(found - items.begin());
    std::vector<std::string_view> names;
    for (const Item& one : items) names.push_back(one.name);
    table_.fault(key, fmt::format("is not in the list [[{}]]{}", key, did_you_mean(name, names)));
    return std::nullopt;
  }

  void read_uncertainty() {
    if (table_.has("instrument")) {
      group_.instrument = find_named(all_.instruments, "instrument");
    }
    if (table_.is("uncertainty", config::Value::Type::text) &&
        table_.text("uncertainty") == "estimate") {
      return;
    }
    const bool angular = is_angular(group_.kind, group_.axis);
    group_.uncertainty =
        table_.real(angular ? "uncertainty_urad" : "uncertainty_um",
                    angular ? config::kAngle : config::kLength, {config::above(0.0)});
  }

  void read_expansion() {
    if (!table_.has("expansion")) return;
    config::Reader table = table_.table("expansion");
    Expansion expansion;
    expansion.coefficient = table.real_or("coefficient_per_K", kSteel, config::kExpansion);
    expansion.coefficient_uncertainty = table.real_or("coefficient_uncertainty_per_K", 0.0,
                                                      config::kExpansion, {config::at_least(0.0)});
    expansion.temperature_uncertainty = table.real_or(
        "temperature_uncertainty_K", 0.0, config::kTemperature, {config::at_least(0.0)});
    group_.expansion = expansion;
  }

  void read_dead_path() {
    if (!table_.has("dead_path")) return;
    config::Reader table = table_.table("dead_path");
    group_.dead_path = DeadPath{
        table.real("length_mm", config::kLength),
        table.real("wavelength_uncertainty_um_per_m", config::kNumber, {config::above(0.0)})};
    if (group_.kind != Kind::positioning || (group_.axis && !is_linear(*group_.axis))) {
      table_.fault("dead_path", "must be a laser group of kind positioning");
    }
  }

  void read_squareness() {
    for (int j = 0; j < kJoints; ++j) {
      if (layout_.has(j) && !group_.stands[static_cast<std::size_t>(j)]) {
        table_.fault(fmt::format("does not give the position of {}; add it to the table at",
                                 layout_.letter_of(j)));
      }
    }
    const auto legs = table_.reals("lengths_mm", config::kLength);
    if (legs.size() == 2 && legs[0] != 0.0 && legs[1] != 0.0) {
      group_.legs = {legs[0], legs[1]};
    } else if (!legs.empty()) {
      table_.fault("lengths_mm", "must be the lengths of the two lines, along each axis");
    }
    group_.targets = static_cast<int>(table_.integer_or(
        "targets", kTargets, {config::at_least(2.0), config::at_most(double(kMaxTargets))}));
    Reading reading;
    reading.Q = group_.at;
    if (numbers_ == Numbers::required || table_.has("deviation_urad")) {
      reading.deviation[0] =
          table_.real("deviation_urad", config::kAngle,
                      {config::at_least(-kLargestAngle), config::at_most(kLargestAngle)});
    }
    reading.line = table_.place("deviation_urad").line;
    group_.rows.push_back(reading);
  }

  config::Reader& table_;
  const Readings& all_;
  const JointLayout& layout_;
  Numbers numbers_;
  Group group_;
};

void read_instruments(config::Reader& root, Readings& out) {
  for (config::Reader& table : root.tables_or_none("instrument")) {
    Instrument one;
    one.name = table.text("name");
    one.scale_uncertainty =
        table.real_or("scale_uncertainty_um_per_m", 0.0, config::kNumber, {config::at_least(0.0)});
    const bool twice = std::any_of(out.instruments.begin(), out.instruments.end(),
                                   [&](const Instrument& other) { return other.name == one.name; });
    if (twice) table.fault("name", "appears twice");
    out.instruments.push_back(std::move(one));
  }
}

void read_artefacts(config::Reader& root, Readings& out) {
  for (config::Reader& table : root.tables_or_none("artefact")) {
    Artefact one;
    one.name = table.text("name");
    one.uncertainty =
        table.real_or("uncertainty_um", 0.0, config::kLength, {config::at_least(0.0)});
    one.scale_uncertainty =
        table.real_or("scale_uncertainty_um_per_m", 0.0, config::kNumber, {config::at_least(0.0)});
    one.file = beside(out.path, table.text("centres"));
    const bool twice = std::any_of(out.artefacts.begin(), out.artefacts.end(),
                                   [&](const Artefact& other) { return other.name == one.name; });
    if (twice) table.fault("name", "appears twice");
    out.artefacts.push_back(std::move(one));
  }
}

}  // namespace

std::optional<std::size_t> Artefact::find(const std::string& ball) const {
  const auto found =
      std::find_if(balls.begin(), balls.end(), [&](const Ball& one) { return one.name == ball; });
  if (found == balls.end()) return std::nullopt;
  return static_cast<std::size_t>(found - balls.begin());
}

bool is_of_spheres(Kind kind) { return kind == Kind::sphere || kind == Kind::touch; }

int numbers_of(Kind kind) { return kind == Kind::r_test || kind == Kind::sphere ? 3 : 1; }

bool is_angular(Kind kind, std::optional<Axis> axis) {
  return kind == Kind::angle || kind == Kind::squareness ||
         (kind == Kind::positioning && axis && !is_linear(*axis));
}

std::string place_of(const Group& group, const Reading& reading) {
  const std::string& file = group.file.empty() ? group.place.file : group.file;
  return to_string(Place{file, reading.line, 0});
}

std::string named_machine(const std::string& path) {
  const config::Document document = config::Document::from_file(path);
  const config::Value* machine = document.root().find("machine");
  if (machine == nullptr || machine->type != config::Value::Type::text) return {};
  return beside(path, machine->text);
}

Readings read_readings(const std::string& path, const plant::MachineChain& chain,
                       const Joints& lower, const Joints& upper, Numbers numbers) {
  const config::Document document = config::Document::from_file(path);
  config::Reader root(document);
  Readings out;
  out.path = path;
  out.lower = lower;
  out.upper = upper;
  if (root.has("machine")) out.machine = root.text("machine");
  root.raw("adjustment");  // belongs to the calibration
  read_instruments(root, out);
  read_artefacts(root, out);
  for (config::Reader& table : root.tables("group")) {
    out.groups.push_back(GroupReader(table, out, chain, numbers).read(out.groups.size() + 1));
    const std::string& name = out.groups.back().name;
    const bool twice = std::any_of(out.groups.begin(), out.groups.end() - 1,
                                   [&](const Group& other) { return other.name == name; });
    if (twice) table.fault("name", fmt::format("\"{}\" appears twice", name));
  }
  root.finish();

  std::vector<Fault> faults;
  const auto collect = [&faults](const auto& read) {
    try {
      read();
    } catch (const InputError& error) {
      faults.insert(faults.end(), error.faults().begin(), error.faults().end());
    }
  };
  for (Artefact& artefact : out.artefacts) {
    collect([&] { read_balls(artefact, faults); });
  }
  for (Group& group : out.groups) {
    if (group.file.empty()) continue;
    collect([&] { read_rows(group, chain, lower, upper, numbers, faults); });
    require_distinct_rows(group, faults);
    if (group.artefact) require_balls(out.artefacts[*group.artefact], group, faults);
  }
  if (!faults.empty()) throw InputError(std::move(faults));
  return out;
}

}  // namespace servomill::sim::readings
