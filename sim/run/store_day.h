/// The course of a day in a result file.
#pragma once

#include <memory>
#include <string>

namespace servomill::sim::records {
class Hdf5Group;
class InputFile;
}  // namespace servomill::sim::records

namespace servomill::sim::run {

struct DayCourse;  // sim/run/day_course.h

/// Temperatures and drift over time, ranges of the drift, error of each cycle.
void write_day(records::Hdf5Group group, const DayCourse& day);

/// Reads what write_day() has written; nullptr: the file has no such group.
/// @throws InputError if something is missing in it
std::shared_ptr<const DayCourse> read_day(const records::InputFile& file, const std::string& group);

}  // namespace servomill::sim::run
