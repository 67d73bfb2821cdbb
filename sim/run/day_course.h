/// Temperatures and drift over a day: the servo loops were simulated for one cycle, heat goes on
/// through breaks and repeated cycles.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "sim/evaluation/comparison.h"

namespace servomill::sim::engine {
struct CaseResult;
}  // namespace servomill::sim::engine
namespace servomill::sim::model {
struct Scenario;
}  // namespace servomill::sim::model

namespace servomill::sim::preparation {
struct PreparedParts;
}  // namespace servomill::sim::preparation

namespace servomill::sim::run {

/// Note of commands that run a scenario without its day.
inline constexpr const char* kDayLeftOut =
    "[day] is omitted; servomill run computes it (a sweep does for quantities of the day)";

/// True if a quantity of the scenario is one of its day: then sweeps compute it, too.
bool is_day_asked_for(const model::Scenario& scenario);

/// Directions of drift, of the machine: of the tip along X, Y, Z (m), of the tool axis about X, Y,
/// Z (rad).
inline constexpr std::array<const char*, 6> kDriftNames = {"X", "Y", "Z", "A", "B", "C"};
inline constexpr std::size_t kDrifts = kDriftNames.size();

/// Drift at one place; ISO 230-3:2020 states these of each of its tests.
struct DriftRange {
  std::string place;
  std::array<double, kDrifts> first_hour{}, whole{};  // m, rad; greatest less least drift
  std::array<double, kDrifts> reached{};              // s since the start: when `whole` was reached
};

/// One cycle of the program.
struct DayCycle {
  double begin = 0.0;  // s since the start
  // m; what heat displaces the tip by along the path, datum and what strategies correct taken off
  double rms = 0.0, most = 0.0;
};

struct DayCourse {
  std::vector<double> time;                       // s since the start, of each reading
  std::vector<std::string> bodies, places;        // names
  std::vector<std::vector<double>> temperatures;  // K; of each body, at each time
  std::vector<std::string> sensors;               // names
  std::vector<std::vector<double>> readings;      // K; of each sensor, at each time
  std::vector<std::vector<std::array<double, kDrifts>>> drift;  // since the start; of each place
  std::vector<DriftRange> ranges;
  std::vector<DayCycle> cycles;
  std::vector<double> datums;  // s since the start, when they were taken
  double measuring = 0.0;      // s, of datums in between cycles
  std::string stopped;         // why the day ended early: a body beyond its limits
};

/// Powers of a cycle are averaged over steps of at most a second.
/// @param cycle     of the program, run once, with its powers
/// @param duration  s, of a cycle
/// @pre the scenario has a day, and the machine of the case heat
DayCourse course_of_day(const preparation::PreparedParts& parts, const engine::CaseResult& cycle,
                        double duration);

/// @pre it has cycles
evaluation::DayFigures figures_of(const DayCourse& day);

}  // namespace servomill::sim::run
