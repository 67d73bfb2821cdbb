/// Days of several cases side by side: drift, temperatures, readings, parts.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace servomill::sim::run {

struct DayCourse;  // sim/run/day_course.h

/// The day of a case.
struct NamedDay {
  std::string name;
  std::shared_ptr<const DayCourse> day;
};

/// A line for each range of drift, each rise of a body's temperature or of a reading, and for the
/// parts, with a column for each day; "-" where a day has none.
std::string days_side_by_side(const std::vector<NamedDay>& days);

}  // namespace servomill::sim::run
