#include "sim/input/write_identified.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "sim/config/value.h"
#include "sim/input/machine_description.h"
#include "sim/input/machine_document.h"
#include "sim/system/write_file.h"

namespace servomill::sim::input {
namespace {

std::string with_unit(const std::string& number, const std::string& unit) {
  return unit == kPlainNumber ? number : number + " " + unit;
}

// An uncertainty with two digits: "120", "0.0031".
std::string two_digits(double value) {
  return fmt::format("{}", std::strtod(fmt::format("{:.2g}", value).c_str(), nullptr));
}

// "moving_mass = "95 kg"  # +- 1 kg (k = 2)"
std::string key_line(const std::string& key, double value, const std::string& unit,
                     const std::string& comment) {
  const std::string number = fmt::format("{}", value);
  return fmt::format("{} = {}  # {}\n", config::quoted_key(key.substr(key.rfind('.') + 1)),
                     unit == kPlainNumber ? number : config::quoted_text(with_unit(number, unit)),
                     comment);
}

std::string value_line(const IdentifiedFile& file, std::size_t k) {
  const IdentifiedValues& identified = file.identified;
  const std::string& unit = identified.units[k];
  const auto i = static_cast<Eigen::Index>(k);
  const double half =
      file.half_widths.empty() ? 2.0 * std::sqrt(identified.covariance(i, i)) : file.half_widths[k];
  return key_line(identified.keys[k], identified.values[k], unit,
                  fmt::format("+- {} (k = 2)", with_unit(two_digits(half), unit)));
}

// "axis.X" of "axis.X.moving_mass"; empty: a key of the root.
std::string table_of(const std::string& key) {
  const std::size_t dot = key.rfind('.');
  return dot == std::string::npos ? "" : key.substr(0, dot);
}

// Tables in the order of their first key, each once; keys of the root first.
std::vector<std::string> tables_of(const std::vector<std::string>& keys) {
  std::vector<std::string> out = {""};
  for (const std::string& key : keys) {
    const std::string table = table_of(key);
    if (std::find(out.begin(), out.end(), table) == out.end()) out.push_back(table);
  }
  return out;
}

void refuse_incomplete(const std::string& path, const IdentifiedFile& file) {
  const IdentifiedValues& v = file.identified;
  const std::size_t n = v.keys.size();
  const auto rows = static_cast<Eigen::Index>(n);
  if (v.units.size() == n && v.values.size() == n && v.covariance.rows() == rows &&
      v.covariance.cols() == rows && (file.half_widths.empty() || file.half_widths.size() == n)) {
    return;
  }
  throw std::logic_error(path + ": lists of identified values differ in length");
}

bool same(const IdentifiedValues& a, const IdentifiedValues& b) {
  return a.keys == b.keys && a.units == b.units && a.values == b.values &&
         a.covariance == b.covariance && a.unidentifiable == b.unidentifiable;
}

// Reads the text as the machine that it will be.
void refuse_unreadable(const std::string& text, const std::string& path,
                       const IdentifiedValues& identified) {
  InputFiles files;
  const MachineDocument read = machine_document_of_text(text, path, files);
  if (!read.identified || !same(*read.identified, identified)) {
    throw std::logic_error(path + ": the identified values differ when read back");
  }
  described(read.document);
}

}  // namespace

std::string identified_text(const IdentifiedFile& file) {
  std::string out;
  for (const std::string& line : file.comments) {
    out += line.empty() ? "#\n" : fmt::format("# {}\n", line);
  }
  out += fmt::format("based_on = {}  # machine that was started from\n",
                     config::quoted_text(file.based_on));
  const std::vector<std::string>& keys = file.identified.keys;
  std::vector<std::string> all = keys;
  for (const HeldValue& one : file.held) all.push_back(one.key);
  for (const std::string& table : tables_of(all)) {
    if (!table.empty()) out += fmt::format("\n[{}]\n", table);
    for (std::size_t k = 0; k < keys.size(); ++k) {
      if (table_of(keys[k]) == table) out += value_line(file, k);
    }
    for (const HeldValue& one : file.held) {
      if (table_of(one.key) == table) out += key_line(one.key, one.value, one.unit, one.why);
    }
  }
  return out + "\n[identified]\n" + table_lines(file.identified);
}

void write_identified_file(const std::string& path, const IdentifiedFile& file, bool force) {
  refuse_incomplete(path, file);
  system::refuse_unwritable_text(path, force);
  const std::string text = identified_text(file);
  refuse_unreadable(text, path, file.identified);
  system::write_text_file(path, text, force);
}

std::string machine_seen_from(const std::string& path, const std::string& machine) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::absolute(path).lexically_normal().parent_path();
  return fs::absolute(machine).lexically_normal().lexically_relative(folder).string();
}

}  // namespace servomill::sim::input
