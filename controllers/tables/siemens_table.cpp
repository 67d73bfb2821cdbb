#include "controllers/tables/siemens_table.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "controllers/tables/table_text.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr double kSlack = 1e-6;  // of a step, for digits of MIN, MAX and STEP

struct Value {
  std::string text;
  int line = 0;
};

// The variables of one table: "STEP", "MIN", ...; points by their number.
struct Variables {
  int line = 0;
  std::map<std::string, Value, std::less<>> named;
  std::map<int, Value> points;
};

// "$AA_ENC_COMP_STEP[0,X1]=5" in parts.
struct Assignment {
  std::string_view name;
  std::vector<std::string_view> index;
  std::string_view value;
};

Assignment assignment_of(std::string_view line, const std::string& file, int number) {
  const std::size_t open = line.find('['), close = line.find(']'), equals = line.find('=');
  if (open == std::string_view::npos || close == std::string_view::npos || close < open ||
      equals != close + 1) {
    refuse(file, number, fmt::format("'{}' is not a table assignment", line));
  }
  return {line.substr(0, open), cells_of(line.substr(open + 1, close - open - 1)),
          trimmed(line.substr(equals + 1))};
}

Axis machine_axis(std::string_view name, const std::string& file, int line) {
  if (name.starts_with('(') && name.ends_with(')')) name = name.substr(1, name.size() - 2);
  if (name.size() == 2 && name[1] == '1') {
    if (const auto axis = axis_of(name[0])) return *axis;
  }
  refuse(file, line, fmt::format("'{}' is not a machine axis", name));
}

class SiemensFile {
 public:
  SiemensFile(const TableText& file, std::size_t max_points)
      : file_(file), max_points_(max_points) {}

  void read(std::vector<ControlTable>& out) {
    collect();
    for (const auto& [axis, variables] : encoder_) {
      const Axis own = machine_axis(axis, file_.name, variables.line);
      out.push_back(table_of(variables, own, own, -1.0, 0));
    }
    for (const auto& [index, variables] : cross_) out.push_back(cross_table(variables));
  }

 private:
  [[noreturn]] void fault(int line, std::string message) const {
    refuse(file_.name, line, std::move(message));
  }

  void collect() {
    const auto lines = lines_of(file_.text);
    int number = 0;
    bool has_ended = false;
    for (std::string_view line : lines) {
      ++number;
      line = trimmed(line.substr(0, line.find(';')));
      const bool is_frame = line.empty() || line.starts_with('%') || line == "CHANDATA(1)";
      if (has_ended && !line.empty()) fault(number, "follows M17");
      if (line == "M17") has_ended = true;
      if (is_frame || has_ended) continue;
      take(assignment_of(line, file_.name, number), number);
    }
    if (!has_ended) fault(number, "the file ends without M17");
  }

  void take(const Assignment& a, int number) {
    constexpr std::string_view kEncoder = "$AA_ENC_COMP", kCross = "$AN_CEC";
    const bool is_encoder = a.name.starts_with(kEncoder);
    if (!is_encoder && !a.name.starts_with(kCross)) {
      fault(number, fmt::format("unknown variable {}", a.name));
    }
    const std::string_view rest = a.name.substr((is_encoder ? kEncoder : kCross).size());
    // $AA_ENC_COMP[encoder,k,axis], $AA_ENC_COMP_STEP[encoder,axis]; $AN_CEC[t,k], $AN_CEC_STEP[t]
    const std::size_t expected = (is_encoder ? 2U : 1U) + (rest.empty() ? 1U : 0U);
    if (a.index.size() != expected) fault(number, fmt::format("{} indices", a.index.size()));
    Variables& table = is_encoder ? encoder_[std::string(a.index.back())]
                                  : cross_[index_at(a.index.front(), file_.name, number)];
    if (table.line == 0) table.line = number;
    const Value value{std::string(a.value), number};
    if (rest.empty()) {
      table.points[index_at(a.index[1], file_.name, number)] = value;
    } else {
      table.named[std::string(rest.substr(1))] = value;
    }
  }

  const Value& named(const Variables& table, std::string_view name) const {
    const auto found = table.named.find(name);
    if (found != table.named.end()) return found->second;
    fault(table.line, fmt::format("the table does not assign {}", name));
  }

  double number(const Variables& table, std::string_view name) const {
    const Value& value = named(table, name);
    return number_at(value.text, file_.name, value.line);
  }

  ControlTable cross_table(const Variables& table) const {
    const Value &input = named(table, "INPUT_AXIS"), &output = named(table, "OUTPUT_AXIS");
    if (number(table, "MULT_BY_TABLE") != 0.0) {
      fault(named(table, "MULT_BY_TABLE").line, "products of tables are not supported");
    }
    const double direction = number(table, "DIRECTION");
    if (direction != 0.0 && std::abs(direction) != 1.0) {
      fault(named(table, "DIRECTION").line, "DIRECTION must be -1, 0 or 1");
    }
    return table_of(table, machine_axis(input.text, file_.name, input.line),
                    machine_axis(output.text, file_.name, output.line), 1.0,
                    static_cast<int>(direction));
  }

  ControlTable table_of(const Variables& v, Axis base, Axis output, double sign,
                        int direction) const {
    ControlTable table{.file = file_.name, .base_axis = base, .compensated_axis = output};
    const double min = number(v, "MIN"), max = number(v, "MAX"), step = number(v, "STEP");
    if (!(step > 0.0 && max > min)) fault(named(v, "STEP").line, "STEP and MAX - MIN must be > 0");
    const double intervals = (max - min) / step;
    if (intervals > static_cast<double>(max_points_)) {
      fault(named(v, "STEP").line, fmt::format("more than {} points", max_points_));
    }
    if (std::abs(intervals - std::round(intervals)) > kSlack * intervals) {
      fault(named(v, "MAX").line, "MAX - MIN is not a multiple of STEP");
    }
    const double place_unit = is_linear(base) ? mm : deg;
    const double unit = sign * (is_linear(output) ? mm : deg);
    const int last = static_cast<int>(std::round(intervals));
    for (int k = 0; k <= last; ++k) {
      const auto found = v.points.find(k);
      if (found == v.points.end()) {
        fault(v.line, fmt::format("the table has no point {} of 0 to {}", k, last));
      }
      const double value = unit * number_at(found->second.text, file_.name, found->second.line);
      table.points.push_back({(min + k * step) * place_unit, direction < 0 ? 0.0 : value,
                              direction > 0 ? 0.0 : value, found->second.line});
    }
    if (v.points.rbegin()->first > last) {
      fault(v.points.rbegin()->second.line, fmt::format("the last point of the table is {}", last));
    }
    table.repeats = number(v, "IS_MODULO") != 0.0;
    check_points(table, max_points_);
    if (table.repeats && (table.points.front().up != table.points.back().up ||
                          table.points.front().down != table.points.back().down)) {
      fault(table.points.back().line, "a periodic table must end with its first value");
    }
    return table;
  }

  const TableText& file_;
  std::size_t max_points_;
  std::map<std::string, Variables> encoder_;  // by machine axis
  std::map<int, Variables> cross_;            // by table
};

}  // namespace

std::vector<ControlTable> read_siemens_tables(std::span<const TableText> files,
                                              std::size_t max_points) {
  std::vector<ControlTable> out;
  for (const TableText& file : files) {
    if (std::string_view(file.name).ends_with(".INI")) SiemensFile(file, max_points).read(out);
  }
  return out;
}

}  // namespace servomill::controllers
