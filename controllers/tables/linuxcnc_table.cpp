#include "controllers/tables/linuxcnc_table.h"

#include <fmt/format.h>

#include "controllers/tables/table_text.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr std::size_t kMaxPoints = 256;   // EMCMOT_COMP_SIZE
constexpr std::size_t kLineLength = 255;  // LINELEN, with the end of the line
constexpr std::string_view kSection = "[JOINT_";

struct JointSection {
  int line = 0;
  std::size_t joint = 0;
  std::string_view file = {};
  int type = 0;
};

// Keys of the sections [JOINT_n]; '#' and ';' begin comments.
std::vector<JointSection> sections_of(const TableText& ini) {
  std::vector<JointSection> out;
  bool is_joint = false;
  int number = 0;
  for (std::string_view line : lines_of(ini.text)) {
    ++number;
    line = trimmed(line);
    if (line.empty() || line.front() == '#' || line.front() == ';') continue;
    if (line.front() == '[') {
      is_joint = line.substr(0, kSection.size()) == kSection && line.back() == ']';
      if (!is_joint) continue;
      const auto joint = line.substr(kSection.size(), line.size() - kSection.size() - 1);
      out.push_back(
          {.line = number, .joint = static_cast<std::size_t>(index_at(joint, ini.name, number))});
      continue;
    }
    const std::size_t equals = line.find('=');
    if (!is_joint || equals == std::string_view::npos) continue;
    const std::string_view key = trimmed(line.substr(0, equals));
    const std::string_view value = trimmed(line.substr(equals + 1));
    if (key == "COMP_FILE") out.back().file = value;
    if (key != "COMP_FILE_TYPE") continue;
    if (value != "0" && value != "1") {
      refuse(ini.name, number, fmt::format("COMP_FILE_TYPE = {}; must be 0 or 1", value));
    }
    out.back().type = value == "1" ? 1 : 0;
  }
  return out;
}

ControlTable table_of(const TableText& file, Axis axis, int type) {
  ControlTable table{.file = file.name, .base_axis = axis, .compensated_axis = axis};
  const double unit = is_linear(axis) ? mm : deg;
  const auto lines = lines_of(file.text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const int number = static_cast<int>(i) + 1;
    const auto words = words_of(lines[i]);
    bool is_triplet = words.size() >= 3;
    for (std::size_t n = 0; n < 3 && is_triplet; ++n) is_triplet = number_in(words[n]).has_value();
    if (!is_triplet) {
      refuse(file.name, number, "is not three numbers; LinuxCNC stops reading here");
    }
    if (lines[i].size() + 1 >= kLineLength) refuse(file.name, number, "is too long");
    const double nominal = *number_in(words[0]);
    double up = *number_in(words[1]), down = *number_in(words[2]);
    if (type == 0) up = nominal - up, down = nominal - down;
    table.points.push_back({nominal * unit, up * unit, down * unit, number});
  }
  check_points(table, kMaxPoints);
  return table;
}

}  // namespace

std::vector<ControlTable> read_linuxcnc_tables(std::span<const TableText> files,
                                               std::span<const Axis> joints) {
  std::vector<ControlTable> out;
  for (const TableText& ini : files) {
    if (!std::string_view(ini.name).ends_with(".ini")) continue;
    for (const JointSection& section : sections_of(ini)) {
      if (section.file.empty()) continue;
      if (section.joint >= joints.size()) {
        refuse(ini.name, section.line, fmt::format("the machine has no joint {}", section.joint));
      }
      const TableText& file = file_of(files, section.file, ini.name, section.line);
      out.push_back(table_of(file, joints[section.joint], section.type));
    }
  }
  return out;
}

}  // namespace servomill::controllers
