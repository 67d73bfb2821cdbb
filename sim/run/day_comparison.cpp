#include "sim/run/day_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "plant/vocabulary/units.h"
#include "sim/run/day_course.h"
#include "sim/system/text_table.h"

namespace servomill::sim::run {
namespace {

constexpr double kHour = 3600.0;  // s
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Values of the days, line after line in the order in which they are first given.
class Lines {
 public:
  explicit Lines(std::size_t days) : days_(days) {}
  void give(std::size_t day, const std::string& what, const std::string& at, const char* unit,
            double value) {
    const auto [place, is_new] = places_.try_emplace(what + "\n" + at, lines_.size());
    if (is_new) lines_.push_back({what, at, unit, std::vector<double>(days_, kNone)});
    lines_[place->second].values[day] = value;
  }

  std::string text(const std::vector<NamedDay>& days) const {
    std::vector<std::vector<std::string>> out = {{"day", "at", "unit"}};
    std::set<std::size_t> right;
    for (const NamedDay& one : days) {
      right.insert(out[0].size());
      out[0].push_back(one.name);
    }
    for (const Line& line : lines_) {
      std::vector<std::string>& cells = out.emplace_back();
      cells = {line.what, line.at, line.unit};
      for (const double value : line.values) {
        cells.push_back(std::isnan(value) ? "-" : fmt::format("{:.2f}", value));
      }
    }
    return system::text_table(std::move(out), 1, right);
  }

 private:
  struct Line {
    std::string what, at, unit;
    std::vector<double> values;
  };
  std::size_t days_;
  std::vector<Line> lines_;
  std::map<std::string, std::size_t> places_;
};

// The greatest change of a temperature since the start, K; falling ones are negative.
double change_of(const std::vector<double>& T) {
  double most = 0.0;
  for (const double now : T) {
    if (std::abs(now - T.front()) > std::abs(most)) most = now - T.front();
  }
  return most;
}

void give_drift(const DayCourse& day, std::size_t number, Lines& lines) {
  for (const DriftRange& range : day.ranges) {
    for (std::size_t c = 0; c < kDrifts; ++c) {
      const char* unit = c < 3 ? "um" : "urad";
      const std::string at = fmt::format("{} {}", range.place, kDriftNames[c]);
      lines.give(number, "range of drift", at, unit, range.whole[c] / um);
      lines.give(number, "first 60 min", at, unit, range.first_hour[c] / um);
    }
  }
}

void give_parts(const DayCourse& day, std::size_t number, Lines& lines) {
  if (day.cycles.empty()) return;
  const auto by_most = [](const DayCycle& a, const DayCycle& b) { return a.most < b.most; };
  const auto [best, worst] = std::minmax_element(day.cycles.begin(), day.cycles.end(), by_most);
  lines.give(number, "parts", "number", "1", static_cast<double>(day.cycles.size()));
  lines.give(number, "displacement by heat", "best part", "um", best->most / um);
  lines.give(number, "displacement by heat", "worst part", "um", worst->most / um);
  lines.give(number, "displacement by heat", "first part", "um", day.cycles.front().most / um);
  lines.give(number, "displacement by heat", "last part", "um", day.cycles.back().most / um);
}

}  // namespace

std::string days_side_by_side(const std::vector<NamedDay>& days) {
  Lines lines(days.size());
  for (std::size_t n = 0; n < days.size(); ++n) {
    const DayCourse& day = *days[n].day;
    if (!day.time.empty()) lines.give(n, "duration", "", "h", day.time.back() / kHour);
    give_drift(day, n, lines);
    for (std::size_t i = 0; i < day.bodies.size(); ++i) {
      lines.give(n, "change of temperature", day.bodies[i], "K", change_of(day.temperatures[i]));
    }
    for (std::size_t i = 0; i < day.sensors.size(); ++i) {
      lines.give(n, "change of reading", day.sensors[i], "K", change_of(day.readings[i]));
    }
    give_parts(day, n, lines);
  }
  std::string out = lines.text(days);
  for (const NamedDay& one : days) {
    if (!one.day->stopped.empty()) {
      out += fmt::format("day of {} stopped: {}\n", one.name, one.day->stopped);
    }
  }
  return out;
}

}  // namespace servomill::sim::run
