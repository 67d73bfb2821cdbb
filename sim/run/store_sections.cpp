#include "sim/run/store_sections.h"

#include <algorithm>
#include <optional>

#include "sim/records/hdf5_group.h"
#include "sim/records/nexus.h"
#include "sim/records/series.h"

namespace servomill::sim::run {

std::vector<SectionPass> passes_of(const records::Series& servo) {
  const std::size_t time = *servo.column("time"), s = *servo.column("s"),
                    section = *servo.column("section");
  const std::optional<std::size_t> window = servo.column("window");
  std::vector<SectionPass> out;
  double last_window = 0.0;
  for (std::size_t row = 0; row < servo.rows(); ++row) {
    const double t = servo.at(row, time), at = servo.at(row, s);
    const int number = static_cast<int>(servo.at(row, section));
    const double this_window = window ? servo.at(row, *window) : 0.0;
    if (out.empty() || number != out.back().section || this_window != last_window) {
      out.push_back({number, t, t, at, at});
    }
    out.back().end = t;
    out.back().end_at = at;
    last_window = this_window;
  }
  return out;
}

void write_sections(records::Hdf5Group group, const std::vector<SectionPass>& passes,
                    const std::vector<std::string>& names) {
  records::make_nexus_group(group, "NXcollection");
  group.attribute("names", names);
  std::vector<double> values(passes.size());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i + 1);
  group.counts("pass", values, {"1", "number of the pass, counted from 1"});
  const auto column = [&](auto member) -> const std::vector<double>& {
    std::transform(passes.begin(), passes.end(), values.begin(),
                   [member](const SectionPass& one) { return static_cast<double>(one.*member); });
    return values;
  };
  group.counts("section", column(&SectionPass::section),
               {"1", "section of the original program, index into attribute names"}, "pass");
  group.list("begin", column(&SectionPass::begin), {"s", "time of the first row"}, "pass");
  group.list("end", column(&SectionPass::end), {"s", "time of the last row"}, "pass");
  group.list("begin_s", column(&SectionPass::begin_at), {"mm", "arc length of the first row"},
             "pass");
  group.list("end_s", column(&SectionPass::end_at), {"mm", "arc length of the last row"}, "pass");
}

}  // namespace servomill::sim::run
