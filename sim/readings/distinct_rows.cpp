#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <vector>

#include "sim/readings/read_rows.h"

namespace servomill::sim::readings {
namespace {

// Joints, direction of travel and run of a row.
std::vector<double> place_in_order(const Reading& row) {
  std::vector<double> out(row.Q.begin(), row.Q.end());
  out.insert(out.end(), row.direction.begin(), row.direction.end());
  out.push_back(row.run);
  return out;
}

bool counts_runs(const Group& group) {
  return std::any_of(group.rows.begin(), group.rows.end(),
                     [](const Reading& row) { return row.run > 0; });
}

}  // namespace

void require_distinct_rows(const Group& group, std::vector<Fault>& faults) {
  const bool is_line = group.kind == Kind::positioning || group.kind == Kind::straightness ||
                       group.kind == Kind::angle;
  if (!is_line || !counts_runs(group)) return;
  std::map<std::vector<double>, int> lines;
  for (const Reading& row : group.rows) {
    const auto [found, is_new] = lines.try_emplace(place_in_order(row), row.line);
    if (is_new) continue;
    faults.push_back({{group.file, row.line},
                      fmt::format("repeats the target of line {}, run {} and direction; number the "
                                  "runs, or remove one of the two",
                                  found->second, row.run + 1)});
  }
}

}  // namespace servomill::sim::readings
