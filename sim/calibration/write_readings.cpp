#include "sim/calibration/write_readings.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "plant/vocabulary/units.h"
#include "sim/config/document.h"
#include "sim/system/write_file.h"

namespace servomill::sim::calibration {
namespace {

namespace fs = std::filesystem;
using readings::Group;
using readings::Kind;
using readings::Reading;

// Direction of travel of a row: of its axis, else of the first joint that moved; on a circle
// counter-clockwise is forward.
int travel_of(const Group& group, const Reading& reading, const JointLayout& layout) {
  if (group.axis) return reading.direction[std::size_t(*layout.joint_of(*group.axis))];
  if (group.kind == Kind::circle) {
    const int a = *layout.joint_of(group.plane[0]), b = *layout.joint_of(group.plane[1]);
    const double u = reading.Q[a] - group.at[a], v = reading.Q[b] - group.at[b];
    const double turn =
        u * reading.direction[std::size_t(b)] - v * reading.direction[std::size_t(a)];
    return turn > 0.0 ? 1 : turn < 0.0 ? -1 : 0;
  }
  if (group.kind != Kind::positioning) return 0;
  const Joints path = group.rows.back().Q - group.rows.front().Q;
  for (int j = 0; j < kJoints; ++j) {
    const int direction = reading.direction[std::size_t(j)];
    if (direction != 0 && path[j] != 0.0) return path[j] > 0.0 ? direction : -direction;
  }
  return 0;
}

class CsvWriter {
 public:
  CsvWriter(const Group& group, const JointLayout& layout, bool with_numbers = true)
      : group_(group), layout_(layout), with_numbers_(with_numbers) {
    for (const Reading& row : group.rows) {
      has_direction_ = has_direction_ || travel_of(group, row, layout) != 0;
      has_run_ = has_run_ || row.run != 0;
      has_time_ = has_time_ || !std::isnan(row.time);
      has_temperature_ = has_temperature_ || !std::isnan(row.temperature);
    }
  }

  std::string text() const {
    std::string out = fmt::format("{}\n", fmt::join(names(), ","));
    for (const Reading& row : group_.rows) out += fmt::format("{}\n", fmt::join(fields(row), ","));
    return out;
  }

 private:
  // The axes of a circle's plane stand in its angle.
  bool has_column(int joint) const {
    if (!layout_.has(joint)) return false;
    const Axis axis = *layout_.axis[std::size_t(joint)];
    return group_.kind != Kind::circle || (axis != group_.plane[0] && axis != group_.plane[1]);
  }
  bool is_angular() const { return readings::is_angular(group_.kind, group_.axis); }

  std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (int j = 0; j < kJoints; ++j) {
      if (has_column(j)) {
        out.push_back(fmt::format("{}_{}", layout_.letter_of(j), j < kLinearJoints ? "mm" : "deg"));
      }
    }
    if (group_.kind == Kind::circle) out.emplace_back("angle_deg");
    if (readings::is_of_spheres(group_.kind)) out.emplace_back("sphere");
    if (group_.kind == Kind::part) out.insert(out.end(), {"nx", "ny", "nz"});
    if (has_direction_) out.emplace_back("direction");
    if (has_run_) out.emplace_back("run");
    if (has_time_) out.emplace_back("time_s");
    if (has_temperature_) out.emplace_back("temperature_degC");
    if (group_.kind == Kind::r_test) {
      out.insert(out.end(), {"dx_um", "dy_um", "dz_um"});
    } else if (!readings::is_of_spheres(group_.kind)) {
      out.emplace_back(is_angular() ? "deviation_urad" : "deviation_um");
    }
    return out;
  }

  // Nanometres and nanoradians are far below any instrument: ten digits of a position.
  static std::string number(double value) { return fmt::format("{:.10g}", value); }

  std::vector<std::string> fields(const Reading& row) const {
    std::vector<std::string> out;
    for (int j = 0; j < kJoints; ++j) {
      if (has_column(j)) out.push_back(number(row.Q[j] / (j < kLinearJoints ? mm : deg)));
    }
    if (group_.kind == Kind::circle) {
      const int a = *layout_.joint_of(group_.plane[0]), b = *layout_.joint_of(group_.plane[1]);
      out.push_back(number(std::atan2(row.Q[b] - group_.at[b], row.Q[a] - group_.at[a]) / deg));
    }
    if (readings::is_of_spheres(group_.kind)) out.push_back(group_.spheres[row.sphere]);
    if (group_.kind == Kind::part) {
      for (const double component : row.normal) out.push_back(number(component));
    }
    if (has_direction_) {
      const int travel = travel_of(group_, row, layout_);
      out.emplace_back(travel < 0 ? "backward" : "forward");
    }
    if (has_run_) out.push_back(std::to_string(row.run + 1));
    if (has_time_) out.push_back(number(row.time));
    if (has_temperature_) out.push_back(number(row.temperature));
    const int numbers =
        readings::is_of_spheres(group_.kind) ? 0 : readings::numbers_of(group_.kind);
    for (int k = 0; k < numbers; ++k) {
      out.push_back(with_numbers_ ? fmt::format("{:.4f}", row.deviation[k] / um) : std::string());
    }
    return out;
  }

  const Group& group_;
  const JointLayout& layout_;
  bool with_numbers_;
  bool has_direction_ = false, has_run_ = false, has_time_ = false, has_temperature_ = false;
};

// A file as another file in a folder names it.
std::string path_from(const std::string& folder, const std::string& file) {
  const fs::path base = fs::absolute(folder).lexically_normal();
  return fs::absolute(file).lexically_normal().lexically_relative(base).string();
}

// The keys of a group in a file of readings.
class GroupWriter {
 public:
  GroupWriter(const Group& group, const JointLayout& layout) : group_(group), layout_(layout) {}

  std::string text(const std::string& file) const {
    std::string out =
        fmt::format("\n[[group]]\nname = {}\nkind = \"{}\"\n", config::quoted_text(group_.name),
                    readings::kKinds[std::size_t(group_.kind)]);
    if (group_.axis) out += fmt::format("axis = \"{}\"\n", letter(*group_.axis));
    if (group_.direction) out += fmt::format("direction = \"{}\"\n", letter(*group_.direction));
    const std::string plane{letter(group_.plane[0]), letter(group_.plane[1])};
    if (group_.kind == Kind::circle) {
      out += fmt::format("plane = \"{}\"\nradius_mm = {:g}\n", plane, group_.radius / mm);
    }
    if (group_.kind == Kind::squareness) {
      out += fmt::format("axes = \"{}\"\nlengths_mm = [{:g}, {:g}]\ntargets = {}\n", plane,
                         group_.legs[0] / mm, group_.legs[1] / mm, group_.targets);
    }
    out += fmt::format(
        "at = {{ {} }}\npoint_mm = [{:g}, {:g}, {:g}]\n{} = {:g}\n", at(), group_.p_ST.x() / mm,
        group_.p_ST.y() / mm, group_.p_ST.z() / mm,
        readings::is_angular(group_.kind, group_.axis) ? "uncertainty_urad" : "uncertainty_um",
        *group_.uncertainty / um);
    if (group_.kind == Kind::squareness) return out + "# deviation_urad =\n";
    return out + fmt::format("readings = {}\n", config::quoted_text(file));
  }

 private:
  std::string at() const {
    std::vector<std::string> out;
    for (int j = 0; j < kJoints; ++j) {
      if (!layout_.has(j)) continue;
      const bool linear = j < kLinearJoints;
      out.push_back(fmt::format("{}_{} = {:g}", layout_.letter_of(j), linear ? "mm" : "deg",
                                group_.at[j] / (linear ? mm : deg)));
    }
    return fmt::format("{}", fmt::join(out, ", "));
  }

  const Group& group_;
  const JointLayout& layout_;
};

using Texts = std::vector<std::pair<std::string, std::string>>;

void write_all(const Texts& texts, bool force) {
  for (const auto& [path, text] : texts) system::refuse_unwritable_text(path, force);
  for (const auto& [path, text] : texts) system::write_text_file(path, text, force);
}

}  // namespace

void write_readings(const std::string& folder, const readings::Readings& readings,
                    const plant::MachineChain& chain, const std::string& machine, bool force) {
  config::Document document = config::Document::from_file(readings.path);
  const auto name_of = [](const std::string& path) { return fs::path(path).filename().string(); };
  const std::string file = (fs::path(folder) / name_of(readings.path)).string();
  document.set("machine=" + config::quoted_text(path_from(folder, machine)));
  for (std::size_t a = 0; a < readings.artefacts.size(); ++a) {
    document.set(fmt::format("artefact[{}].centres={}", a,
                             config::quoted_text(path_from(folder, readings.artefacts[a].file))));
  }
  std::set<std::string> names = {file};
  Texts texts;
  for (std::size_t g = 0; g < readings.groups.size(); ++g) {
    const Group& group = readings.groups[g];
    if (group.file.empty()) {
      document.set(
          fmt::format("group[{}].deviation_urad={:.4f}", g, group.rows[0].deviation[0] / urad));
      continue;
    }
    const std::string path = (fs::path(folder) / name_of(group.file)).string();
    if (!names.insert(path).second) {
      throw InputError(group.place,
                       fmt::format("{} appears twice: every made-up group needs its own file",
                                   name_of(group.file)));
    }
    document.set(fmt::format("group[{}].readings={}", g, config::quoted_text(name_of(group.file))));
    texts.emplace_back(path, CsvWriter(group, chain.layout).text());
  }
  texts.emplace_back(file, document.to_toml());
  write_all(texts, force);
}

void write_plan(const std::string& folder, const readings::Readings& plan,
                const plant::MachineChain& chain, const std::string& machine, bool force) {
  Texts texts;
  std::string text = fmt::format("machine = {}\n", config::quoted_text(path_from(folder, machine)));
  for (std::size_t g = 0; g < plan.groups.size(); ++g) {
    const Group& group = plan.groups[g];
    const std::string file =
        fmt::format("{:02}_{}.csv", g + 1, readings::kKinds[std::size_t(group.kind)]);
    text += GroupWriter(group, chain.layout).text(file);
    if (group.kind == Kind::squareness) continue;
    texts.emplace_back((fs::path(folder) / file).string(),
                       CsvWriter(group, chain.layout, false).text());
  }
  texts.emplace_back((fs::path(folder) / "readings.toml").string(), text);
  write_all(texts, force);
}

}  // namespace servomill::sim::calibration
