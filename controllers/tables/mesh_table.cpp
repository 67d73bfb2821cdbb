#include "controllers/tables/mesh_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "controllers/tables/table_text.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr int kMaxPoints = 100;  // along an axis

void check_size(const MeshTable& mesh, const TableText& file, int line) {
  if (mesh.nx < 2 || mesh.ny < 2 || mesh.nx > kMaxPoints || mesh.ny > kMaxPoints) {
    refuse(
        file.name, line,
        fmt::format("a mesh of {} x {} points; must be from 2 x 2 to 100 x 100", mesh.nx, mesh.ny));
  }
  const auto points = static_cast<std::size_t>(mesh.nx) * static_cast<std::size_t>(mesh.ny);
  if (mesh.z.size() != points) {
    refuse(file.name, line,
           fmt::format("{} heights in a mesh of {} x {}", mesh.z.size(), mesh.nx, mesh.ny));
  }
}

MeshTable read_marlin(const TableText& file) {
  std::map<std::pair<int, int>, double> found;  // row, column
  MeshTable mesh;
  int number = 0;
  for (const std::string_view line : lines_of(file.text)) {
    ++number;
    const auto words = words_of(trimmed(line.substr(0, line.find(';'))));
    if (words.empty()) continue;
    const bool is_point = words.size() == 4 && words[0] == "M421" && words[1].front() == 'I' &&
                          words[2].front() == 'J' && words[3].front() == 'Z';
    if (!is_point)
      refuse(file.name, number, fmt::format("'{}' is not supported; only M421 I J Z", line));
    const int i = index_at(words[1].substr(1), file.name, number);
    const int j = index_at(words[2].substr(1), file.name, number);
    const double z = number_at(words[3].substr(1), file.name, number) * mm;
    if (!found.emplace(std::pair(j, i), z).second)
      refuse(file.name, number, "a mesh point appears twice");
    mesh.nx = std::max(mesh.nx, i + 1);
    mesh.ny = std::max(mesh.ny, j + 1);
  }
  for (const auto& [place, z] : found) mesh.z.push_back(z);
  check_size(mesh, file, 0);
  return mesh;
}

void add_row(std::string_view text, const TableText& file, int line, MeshTable& mesh) {
  for (const std::string_view cell : cells_of(text)) {
    mesh.z.push_back(number_at(trimmed(cell), file.name, line) * mm);
  }
}

double value_of(const std::map<std::string, std::string, std::less<>>& values, const char* key,
                const TableText& file) {
  const auto found = values.find(key);
  if (found == values.end()) refuse(file.name, 0, fmt::format("{} is missing", key));
  return number_at(found->second, file.name, 0);
}

MeshTable read_klipper(const TableText& file) {
  MeshTable mesh;
  std::map<std::string, std::string, std::less<>> values;
  bool has_section = false, in_points = false;
  int number = 0;
  for (const std::string_view line : lines_of(file.text)) {
    ++number;
    const std::string_view bare = line.substr(0, line.find('#')), text = trimmed(bare);
    if (text.empty()) continue;
    if (text.starts_with("[bed_mesh ") && text.back() == ']') {
      if (has_section) refuse(file.name, number, "a second mesh; only one is supported");
      has_section = true;
      continue;
    }
    if (!has_section) refuse(file.name, number, fmt::format("'{}' is not supported", text));
    if (in_points && bare.front() == ' ') {
      add_row(text, file, number, mesh);
      continue;
    }
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos)
      refuse(file.name, number, fmt::format("'{}' is not supported", text));
    const std::string key(trimmed(text.substr(0, equals)));
    in_points = key == "points";
    if (!values.emplace(key, trimmed(text.substr(equals + 1))).second) {
      refuse(file.name, number, fmt::format("{} appears twice", key));
    }
  }
  if (!has_section) refuse(file.name, 0, "contains no section [bed_mesh NAME]");
  if (value_of(values, "version", file) != 1.0) refuse(file.name, 0, "the version must be 1");
  for (const char* key : {"mesh_x_pps", "mesh_y_pps"}) {
    if (value_of(values, key, file) != 0.0) refuse(file.name, 0, fmt::format("{} is not 0", key));
  }
  mesh.nx = static_cast<int>(value_of(values, "x_count", file));
  mesh.ny = static_cast<int>(value_of(values, "y_count", file));
  mesh.range = {value_of(values, "min_x", file) * mm, value_of(values, "max_x", file) * mm,
                value_of(values, "min_y", file) * mm, value_of(values, "max_y", file) * mm};
  check_size(mesh, file, 0);
  return mesh;
}

MeshTable read_reprapfirmware(const TableText& file) {
  const auto lines = lines_of(file.text);
  constexpr std::string_view kComment = "RepRapFirmware height map file v2";
  constexpr std::string_view kNames =
      "axis0,axis1,min0,max0,min1,max1,radius,spacing0,spacing1,num0,num1";
  if (lines.size() < 3 || !lines[0].starts_with(kComment)) {
    refuse(file.name, 1, fmt::format("starts with '{}'", kComment));
  }
  if (lines[1] != kNames) refuse(file.name, 2, fmt::format("must be {}", kNames));
  const auto cells = cells_of(lines[2]);
  constexpr std::size_t kCells = 11;
  if (cells.size() != kCells || cells[0] != "X" || cells[1] != "Y") {
    refuse(file.name, 3, "must be the values of a mesh over X and Y");
  }
  MeshTable mesh;
  const auto at = [&](std::size_t i) { return number_at(cells[i], file.name, 3); };
  mesh.range = {at(2) * mm, at(3) * mm, at(4) * mm, at(5) * mm};
  mesh.nx = static_cast<int>(at(9));
  mesh.ny = static_cast<int>(at(10));
  for (std::size_t i = 3; i < lines.size(); ++i) {
    if (trimmed(lines[i]).empty()) continue;
    for (const std::string_view cell : cells_of(lines[i])) {
      if (trimmed(cell) == "0")
        refuse(file.name, int(i) + 1, "the mesh contains a point that was not probed");
    }
    add_row(lines[i], file, static_cast<int>(i) + 1, mesh);
  }
  check_size(mesh, file, 3);
  return mesh;
}

}  // namespace

double MeshTable::at(double x, double y, const std::array<double, 4>& over) const {
  const auto place = [](double q, double from, double to, int n) {
    const double share = std::clamp((q - from) / (to - from), 0.0, 1.0) * (n - 1);
    const int cell = std::min(static_cast<int>(share), n - 2);
    return std::pair(cell, share - cell);
  };
  const auto [i, u] = place(x, over[0], over[1], nx);
  const auto [j, v] = place(y, over[2], over[3], ny);
  const auto height = [&, i = i, j = j](int di, int dj) {
    return z[static_cast<std::size_t>((j + dj) * nx + i + di)];
  };
  return (1.0 - v) * ((1.0 - u) * height(0, 0) + u * height(1, 0)) +
         v * ((1.0 - u) * height(0, 1) + u * height(1, 1));
}

MeshTable read_mesh_table(const TableText& file, SkewFirmware firmware) {
  if (firmware == SkewFirmware::marlin) return read_marlin(file);
  return firmware == SkewFirmware::klipper ? read_klipper(file) : read_reprapfirmware(file);
}

}  // namespace servomill::controllers
