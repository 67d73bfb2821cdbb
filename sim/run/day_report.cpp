#include "sim/run/day_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "plant/vocabulary/units.h"
#include "sim/run/day_course.h"
#include "sim/system/json.h"

namespace servomill::sim::run {
namespace {

constexpr double kMinute = 60.0, kHour = 3600.0;  // s

// Error of the parts, and what datums in between took.
std::string cycles_line(const DayCourse& day) {
  const auto by_most = [](const DayCycle& a, const DayCycle& b) { return a.most < b.most; };
  const auto [best, worst] = std::minmax_element(day.cycles.begin(), day.cycles.end(), by_most);
  std::string out = fmt::format(
      "{} cycles; heat displaces the tip by {:.2f} um at most in the best, begun after {:.2f} h, "
      "and by {:.2f} um in the worst, begun after {:.2f} h; {:.2f} um rms of all\n",
      day.cycles.size(), best->most / um, best->begin / kHour, worst->most / um,
      worst->begin / kHour, figures_of(day).rms / um);
  if (!day.datums.empty()) {
    out += fmt::format("{} datums, {:.1f} min of them in between cycles\n", day.datums.size(),
                       day.measuring / kMinute);
  }
  return out;
}

}  // namespace

std::string day_json(const std::string& case_name, const DayCourse& day) {
  system::JsonObject out;
  out.text("case", case_name);
  for (const DriftRange& range : day.ranges) {
    system::JsonObject place;
    for (std::size_t c = 0; c < kDrifts; ++c) {
      const std::string unit = c < 3 ? "um" : "urad", name = kDriftNames[c];
      place.number(fmt::format("{}_first_60_min_{}", name, unit), range.first_hour[c] / um);
      place.number(fmt::format("{}_{}", name, unit), range.whole[c] / um);
      place.number(name + "_reached_h", range.reached[c] / kHour);
    }
    out.raw(range.place, place.line());
  }
  if (!day.cycles.empty()) {
    const evaluation::DayFigures figures = figures_of(day);
    out.number("cycles", static_cast<double>(day.cycles.size()));
    out.number("rms_um", figures.rms / um);
    out.number("largest_um", figures.largest / um);
  }
  out.number("datums", static_cast<double>(day.datums.size()));
  out.number("measuring_min", day.measuring / kMinute);
  if (!day.stopped.empty()) out.text("stopped", day.stopped);
  return out.line();
}

std::string day_table(const DayCourse& day) {
  std::string out = fmt::format("{:<12} {:>10} {:>12} {:>12} {:>12}\n", "drift at", "direction",
                                "first 60 min", "whole", "reached");
  for (const DriftRange& range : day.ranges) {
    for (std::size_t c = 0; c < kDrifts; ++c) {
      const char* unit = c < 3 ? "um" : "urad";
      out += fmt::format("{:<12} {:>10} {:>7.2f} {:<4} {:>7.2f} {:<4} {:>10.2f} h\n",
                         c == 0 ? range.place : "", kDriftNames[c], range.first_hour[c] / um, unit,
                         range.whole[c] / um, unit, range.reached[c] / kHour);
    }
  }
  if (!day.cycles.empty()) out += cycles_line(day);
  if (!day.stopped.empty()) out += "stopped: " + day.stopped + "\n";
  return out;
}

}  // namespace servomill::sim::run
