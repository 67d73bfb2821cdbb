#include "sim/readings/part_readings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "plant/vocabulary/units.h"
#include "sim/readings/columns.h"
#include "sim/readings/unit_normal.h"
#include "sim/records/input_file.h"

namespace servomill::sim::readings {
namespace {

// x, y, z and deviation are lengths, i, j, k numbers.
struct Wanted {
  std::string_view name, other;  // other: as groups of readings call it
  bool is_length;
};
constexpr std::array<Wanted, 7> kWanted = {{{"x", "X", true},
                                            {"y", "Y", true},
                                            {"z", "Z", true},
                                            {"i", "nx", false},
                                            {"j", "ny", false},
                                            {"k", "nz", false},
                                            {"deviation", "deviation", true}}};

using Columns = std::array<const Column*, kWanted.size()>;

Columns columns_of(const Table& table) {
  Columns out{};
  std::vector<Fault> faults;
  for (std::size_t n = 0; n < kWanted.size(); ++n) {
    const Wanted& wanted = kWanted[n];
    out[n] = table.find(wanted.name);
    if (out[n] == nullptr) out[n] = table.find(wanted.other);
    const std::string unit = !wanted.is_length ? "" : wanted.name == "deviation" ? "_um" : "_mm";
    if (out[n] == nullptr) {
      faults.push_back({{table.file}, fmt::format("has no column {}{}", wanted.name, unit)});
    } else if (wanted.is_length && out[n]->unit.quantity != config::kLength) {
      faults.push_back({{table.file},
                        fmt::format("column {} has no unit of length: name it {}{}",
                                    out[n]->written, wanted.name, unit)});
    }
  }
  if (!faults.empty()) throw InputError(faults);
  return out;
}

// The point of a row; what is wrong with it is added to the faults.
PartPoint point_of(const Table& table, const Row& row, const Columns& columns,
                   std::vector<Fault>& faults) {
  std::array<double, kWanted.size()> values{};
  for (std::size_t n = 0; n < values.size(); ++n) {
    const std::optional<double> value = table.number(row, *columns[n], faults);
    if (!value) {
      faults.push_back({table.place(row, *columns[n]), columns[n]->written + " is empty"});
    }
    values[n] = value.value_or(0.0);
  }
  PartPoint out{.place = {table.file, row.line}, .name = {}};
  out.point = {values[0], values[1], values[2]};
  out.normal = {values[3], values[4], values[5]};
  out.deviation = values[6];
  return out;
}

void check_normal(PartPoint& one, std::vector<Fault>& faults) {
  const std::string fault = make_unit(one.normal, "i, j, k");
  if (!fault.empty()) faults.push_back({one.place, fault});
}

std::vector<Eigen::Vector3d> vectors(const std::vector<double>& values) {
  std::vector<Eigen::Vector3d> out;
  for (std::size_t n = 0; n + 2 < values.size(); n += 3) {
    out.emplace_back(values[n], values[n + 1], values[n + 2]);
  }
  return out;
}

// Means of the columns of a table.
std::vector<double> means(const std::vector<double>& values, std::size_t columns) {
  std::vector<double> out(columns, 0.0);
  for (std::size_t n = 0; n < values.size(); ++n) out[n % columns] += values[n];
  const double rows = static_cast<double>(values.size() / columns);
  for (double& one : out) one /= rows;
  return out;
}

void add_feature(const records::InputFile& file, const std::string& group, const std::string& name,
                 std::vector<PartPoint>& out) {
  const auto nominal = vectors(file.values(group + "/nominal"));
  const auto normal = vectors(file.values(group + "/normal"));
  const std::vector<double> measured = file.values(group + "/measured");
  const std::size_t points = nominal.size();
  if (points == 0 || normal.size() != points || measured.empty() || measured.size() % points != 0) {
    throw InputError(
        {file.path()},
        fmt::format("'{}' has different numbers of nominal and measured points", group));
  }
  const std::vector<double> deviation = means(measured, points);
  std::vector<Fault> faults;
  for (std::size_t n = 0; n < points; ++n) {
    PartPoint one{.place = {file.path()}, .name = fmt::format("point {} of {}", n, name)};
    one.point = nominal[n] * mm;
    one.normal = normal[n];
    one.deviation = deviation[n] * um;
    if (std::isnan(one.deviation)) {
      faults.push_back({one.place, one.name + " was not reached by the CMM; choose other probes"});
    }
    check_normal(one, faults);
    out.push_back(std::move(one));
  }
  if (!faults.empty()) throw InputError(faults);
}

}  // namespace

std::vector<PartPoint> read_part_table(const std::string& path) {
  const Table table = read_table(path);
  const Columns columns = columns_of(table);
  std::vector<PartPoint> out;
  std::vector<Fault> faults;
  for (const Row& row : table.rows) {
    const std::size_t before = faults.size();
    out.push_back(point_of(table, row, columns, faults));
    if (faults.size() == before) check_normal(out.back(), faults);
  }
  if (!faults.empty()) throw InputError(faults);
  if (out.empty()) throw InputError({path}, "has no points");
  return out;
}

std::vector<PartPoint> read_part_of_case(const std::string& path, const std::string& case_name,
                                         const std::vector<std::string>& probes) {
  const records::InputFile file(path);
  const std::string group = fmt::format("/cases/{}/probes", case_name);
  if (!file.has(group)) {
    throw InputError({path}, fmt::format("has no probed part of a case {}", case_name));
  }
  const std::vector<std::string> all = file.groups(group);
  std::vector<PartPoint> out;
  for (const std::string& name : probes.empty() ? all : probes) {
    if (std::find(all.begin(), all.end(), name) == all.end()) {
      throw InputError({path}, fmt::format("case {} has no probe {}; it has {}", case_name, name,
                                           fmt::join(all, ", ")));
    }
    add_feature(file, group + "/" + name, name, out);
  }
  return out;
}

}  // namespace servomill::sim::readings
