#include "sim/readings/read_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "plant/vocabulary/units.h"
#include "sim/readings/columns.h"
#include "sim/readings/unit_normal.h"

namespace servomill::sim::readings {
namespace {

constexpr double kHottest = 50.0;  // degC; above, a temperature is taken to be one in Fahrenheit
constexpr double kColdest = -10.0;
constexpr std::string_view kTemperature = "temperature_degC";
constexpr std::string_view kPlaceOnCircle = "angle";
constexpr std::array<std::string_view, 3> kNormal = {"nx", "ny", "nz"};

// Names of the columns that hold the deviation of a kind, each with whether it is an absolute value
// from which the nominal one is taken away.
std::vector<std::string_view> value_columns(Kind kind) {
  switch (kind) {
    case Kind::positioning:
      return {"deviation", "position"};
    case Kind::ball_bar:
      return {"deviation", "length"};
    case Kind::r_test:
      return {"dx", "dy", "dz"};
    case Kind::sphere:
    case Kind::touch:
      return {};
    default:
      return {"deviation"};
  }
}

config::Quantity quantity_of(const Group& group) {
  return is_angular(group.kind, group.axis) ? config::kAngle : config::kLength;
}

std::string_view letter_text(Axis axis) {
  return std::string_view("XYZABC").substr(static_cast<std::size_t>(index_of(axis)), 1);
}

// "p1", "p12": the actual position of a run, beside the target
std::optional<int> run_of(std::string_view name) {
  if (name.size() < 2 || name.front() != 'p') return std::nullopt;
  int run = 0;
  for (const char digit : name.substr(1)) {
    if (digit < '0' || digit > '9') return std::nullopt;
    run = 10 * run + (digit - '0');
  }
  return run - 1;
}

class RowsReader {
 public:
  RowsReader(Group& group, const plant::MachineChain& chain, const Joints& lower,
             const Joints& upper, Numbers numbers, std::vector<Fault>& faults)
      : group_(group),
        numbers_(numbers),
        layout_(chain.layout),
        lower_(lower),
        upper_(upper),
        faults_(faults),
        table_(read_table(group.file)) {
    for (const Column& column : table_.columns) {
      if (const auto run = run_of(column.written)) runs_.emplace_back(*run, &column);
    }
  }

  void read() {
    if (!check_columns()) return;
    for (const Row& row : table_.rows) {
      if (runs_.empty()) {
        add(row, 0, nullptr);
      } else {
        for (const auto& [run, column] : runs_) add(row, run, column);
      }
    }
    set_directions(group_, layout_, travel_);
  }

 private:
  using Names = std::vector<std::string_view>;

  void fault(const Place& place, std::string message) {
    faults_.push_back({place, std::move(message)});
  }

  const Column* target() const {
    return group_.axis && group_.kind != Kind::circle ? table_.find("target") : nullptr;
  }

  Names known_columns() const {
    Names names = {"direction", "run", "time", kTemperature};
    for (const Axis axis : kAllAxes) {
      if (layout_.joint_of(axis)) names.push_back(letter_text(axis));
    }
    for (const std::string_view name : value_columns(group_.kind)) names.push_back(name);
    if (group_.axis) names.emplace_back("target");
    if (group_.kind == Kind::circle) names.emplace_back("angle");
    if (is_of_spheres(group_.kind)) names.emplace_back("sphere");
    if (group_.kind == Kind::part) names.insert(names.end(), kNormal.begin(), kNormal.end());
    return names;
  }

  // A column must be known, and have a unit of its quantity.
  bool check_columns() {
    const std::size_t before = faults_.size();
    const Names names = known_columns();
    for (const Column& column : table_.columns) {
      const Place place{table_.file, 0, 0};
      if (run_of(column.written) && group_.kind == Kind::positioning) continue;
      if (std::find(names.begin(), names.end(), column.name) == names.end()) {
        fault(place, fmt::format("column {} is unknown in readings of kind {}{}; known are {}",
                                 column.written, kKinds[static_cast<std::size_t>(group_.kind)],
                                 did_you_mean(column.name, names), fmt::join(names, ", ")));
        continue;
      }
      check_unit(column);
    }
    require_values();
    require_positions();
    require_all_axes();
    if (group_.expansion && table_.find(kTemperature) == nullptr) {
      fault(group_.place, fmt::format("group \"{}\" has a table expansion, and {} no column {}",
                                      group_.name, group_.file, kTemperature));
    }
    return faults_.size() == before;
  }

  void check_unit(const Column& column) {
    std::optional<config::Quantity> expected;
    const Names values = value_columns(group_.kind);
    if (std::find(values.begin(), values.end(), column.name) != values.end()) {
      expected = quantity_of(group_);
    } else if (column.name == "target") {
      expected = is_linear(*group_.axis) ? config::kLength : config::kAngle;
    } else if (column.name == kPlaceOnCircle) {
      expected = config::kAngle;
    } else if (column.name == "time") {
      expected = config::kTime;
    } else if (column.name.size() == 1 && axis_of(column.name.front())) {
      expected = is_linear(*axis_of(column.name.front())) ? config::kLength : config::kAngle;
    }
    if (!expected || column.unit.quantity == *expected) return;
    const std::string unit = config::example_unit(*expected);
    fault({table_.file, 0, 0},
          fmt::format("column {} must name {} in its unit, such as {}_{}", column.written,
                      config::name_of(*expected), column.name, unit));
  }

  void require_values() {
    if (!runs_.empty()) {
      if (target() == nullptr) {
        fault({table_.file},
              "columns p1, p2, ... are positions at a target; column target_mm or "
              "target_deg is missing");
      }
      return;
    }
    const Names values = value_columns(group_.kind);
    if (values.empty()) return;
    if (group_.kind == Kind::r_test) {
      for (const std::string_view name : values) {
        if (table_.find(name) == nullptr) {
          fault({table_.file}, fmt::format("column {}_um is missing", name));
        }
      }
      return;
    }
    const auto found = std::count_if(values.begin(), values.end(), [&](std::string_view name) {
      return table_.find(name) != nullptr;
    });
    if (found != 1) {
      fault({table_.file},
            fmt::format("{} column of values; expected one of {}",
                        found == 0 ? "no" : "more than one", fmt::join(values, ", ")));
    }
  }

  void require_positions() {
    if (group_.kind == Kind::part) {
      for (const std::string_view name : kNormal) {
        if (table_.find(name) == nullptr) {
          fault({table_.file}, fmt::format("column {} is missing", name));
        }
      }
    }
    if (group_.kind == Kind::circle) {
      if (table_.find("angle") == nullptr) fault({table_.file}, "column angle_deg is missing");
      return;
    }
    if (group_.axis && target() == nullptr && table_.find(letter_text(*group_.axis)) == nullptr) {
      fault({table_.file},
            fmt::format("column target_{} is missing", is_linear(*group_.axis) ? "mm" : "deg"));
    }
  }

  // Unknown is unknown: an axis of which neither rows nor group say where it stood.
  void require_all_axes() {
    for (int j = 0; j < kJoints; ++j) {
      if (!layout_.has(j) || group_.stands[static_cast<std::size_t>(j)]) continue;
      const Axis axis = *layout_.axis[static_cast<std::size_t>(j)];
      if (table_.find(letter_text(axis)) != nullptr) continue;
      if (group_.axis == axis && target() != nullptr) continue;
      const std::string key = fmt::format("{}_{}", letter(axis), is_linear(axis) ? "mm" : "deg");
      fault(group_.place,
            fmt::format("group \"{}\" does not give the position of {}; add {} to its "
                        "table at, or a column to {}",
                        group_.name, letter(axis), key, group_.file));
    }
  }

  double value(const Row& row, const Column& column) {
    const auto number = table_.number(row, column, faults_);
    if (!number) fault(table_.place(row, column), fmt::format("{} is empty", column.written));
    return number.value_or(0.0);
  }

  Joints position(const Row& row) {
    Joints Q = group_.at;
    for (const Axis axis : kAllAxes) {
      const auto joint = layout_.joint_of(axis);
      const Column* column = table_.find(letter_text(axis));
      if (joint && column != nullptr) Q[*joint] = value(row, *column);
    }
    if (target() != nullptr) Q[*layout_.joint_of(*group_.axis)] = value(row, *target());
    if (group_.kind == Kind::circle) {
      const double angle = value(row, *table_.find("angle"));
      Q[*layout_.joint_of(group_.plane[0])] += group_.radius * std::cos(angle);
      Q[*layout_.joint_of(group_.plane[1])] += group_.radius * std::sin(angle);
    }
    for (int j = 0; j < kJoints; ++j) {
      if (Q[j] >= lower_[j] - kSlack && Q[j] <= upper_[j] + kSlack) continue;
      const bool linear = j < kLinearJoints;
      const double unit = linear ? mm : deg;
      fault({table_.file, row.line},
            fmt::format("{} = {:g} {} is outside the travel of the machine, {:g} to {:g} {}",
                        layout_.letter_of(j), Q[j] / unit, linear ? "mm" : "deg", lower_[j] / unit,
                        upper_[j] / unit, linear ? "mm" : "deg"));
    }
    return Q;
  }

  void add(const Row& row, int run, const Column* column) {
    Reading reading;
    reading.line = row.line;
    reading.run = run;
    if (column != nullptr && table_.text(row, *column).empty()) {
      fault(table_.place(row, *column),
            fmt::format("run {} is missing at this target; use one row per reading (columns "
                        "target, run, position) to omit readings",
                        run + 1));
      return;
    }
    reading.Q = position(row);
    if (const Column* direction = table_.find("direction")) {
      const std::string& word = table_.text(row, *direction);
      if (const auto sign = direction_of(word)) {
        travel_.push_back(*sign);
      } else {
        travel_.push_back(0);
        fault(table_.place(row, *direction),
              fmt::format("direction = {}; must be forward or backward (up, down, positive, "
                          "negative, +, -, cw, ccw)",
                          word));
      }
    } else {
      travel_.push_back(0);
    }
    if (const Column* c = table_.find("run")) reading.run = static_cast<int>(value(row, *c)) - 1;
    if (const Column* c = table_.find("time")) reading.time = value(row, *c);
    if (const Column* c = table_.find(kTemperature)) read_temperature(row, *c, reading);
    if (is_of_spheres(group_.kind)) read_sphere(row, reading);
    if (group_.kind == Kind::part) read_normal(row, reading);
    read_values(row, column, reading);
    group_.rows.push_back(reading);
  }

  void read_temperature(const Row& row, const Column& column, Reading& reading) {
    reading.temperature = value(row, column);
    if (reading.temperature > kHottest || reading.temperature < kColdest) {
      fault(table_.place(row, column),
            fmt::format("{} = {:g}; must be between {:g} and {:g} degC (is it in Fahrenheit?)",
                        column.written, reading.temperature, kColdest, kHottest));
    }
  }

  void read_sphere(const Row& row, Reading& reading) {
    const Column* column = table_.find("sphere");
    const std::string name = column != nullptr ? table_.text(row, *column) : "sphere";
    const auto found = std::find(group_.spheres.begin(), group_.spheres.end(), name);
    reading.sphere = static_cast<std::size_t>(found - group_.spheres.begin());
    if (found == group_.spheres.end()) group_.spheres.push_back(name);
  }

  void read_normal(const Row& row, Reading& reading) {
    for (int k = 0; k < 3; ++k) {
      reading.normal[k] = value(row, *table_.find(kNormal[std::size_t(k)]));
    }
    const std::string wrong = make_unit(reading.normal, "nx, ny, nz");
    if (!wrong.empty()) fault({table_.file, row.line}, wrong);
  }

  void read_values(const Row& row, const Column* run, Reading& reading) {
    if (numbers_ == Numbers::ignored) return;
    const bool angular = is_angular(group_.kind, group_.axis);
    if (run != nullptr) {
      const auto actual = table_.number(row, *run, faults_);
      reading.deviation[0] = actual.value_or(0.0) * target()->unit.factor - value(row, *target());
    } else {
      int i = 0;
      for (const std::string_view name : value_columns(group_.kind)) {
        const Column* column = table_.find(name);
        if (column == nullptr) continue;
        double number = value(row, *column);
        if (name == "position") number -= reading.Q[*layout_.joint_of(*group_.axis)];
        if (name == "length") number -= group_.length;
        reading.deviation[i++] = number;
      }
    }
    const double largest = reading.deviation.cwiseAbs().maxCoeff();
    if (largest <= (angular ? kLargestAngle : kLargestDeviation)) return;
    fault({table_.file, row.line},
          angular
              ? fmt::format("deviation of {:g} mrad; must be at most {:g} mrad: check the unit",
                            largest / 1e-3, kLargestAngle / 1e-3)
              : fmt::format("deviation of {:g} mm; must be at most {:g} mm: check unit and sign "
                            "of target and position",
                            largest / mm, kLargestDeviation / mm));
  }

  static constexpr double kSlack = 1e-9;  // m, rad
  Group& group_;
  Numbers numbers_;
  const JointLayout& layout_;
  const Joints &lower_, &upper_;
  std::vector<Fault>& faults_;
  Table table_;
  std::vector<std::pair<int, const Column*>> runs_;
  std::vector<int> travel_;
};

}  // namespace

void read_rows(Group& group, const plant::MachineChain& chain, const Joints& lower,
               const Joints& upper, Numbers numbers, std::vector<Fault>& faults) {
  RowsReader(group, chain, lower, upper, numbers, faults).read();
}

}  // namespace servomill::sim::readings
