/// The course of a day in a result file.
#pragma once

namespace servomill::sim::records {
class Hdf5Group;
}  // namespace servomill::sim::records

namespace servomill::sim::run {

struct DayCourse;  // sim/run/day_course.h

/// Temperatures and drift over time, ranges of the drift, error of each cycle.
void write_day(records::Hdf5Group group, const DayCourse& day);

}  // namespace servomill::sim::run
