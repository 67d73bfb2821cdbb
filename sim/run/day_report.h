/// The course of a day in words.
#pragma once

#include <string>

namespace servomill::sim::run {

struct DayCourse;  // sim/run/day_course.h

/// The ranges as one JSON object.
std::string day_json(const std::string& case_name, const DayCourse& day);

/// Ranges of the drift and the cycles with the least and the greatest error, as a table.
std::string day_table(const DayCourse& day);

}  // namespace servomill::sim::run
