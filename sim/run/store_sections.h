/// Sections of the program in a result file: when and where each pass begins and ends.
#pragma once

#include <string>
#include <vector>

namespace servomill::sim::records {
class Hdf5Group;
class Series;
}  // namespace servomill::sim::records

namespace servomill::sim::run {

/// Consecutive rows of one section; a section that a loop repeats has several passes. Rows that
/// windows left out end a pass.
struct SectionPass {
  int section = 0;                      // index of its name
  double begin = 0.0, end = 0.0;        // s, times of the first and the last row
  double begin_at = 0.0, end_at = 0.0;  // mm, arc lengths of these rows
};

/// @pre  the series has time, s and section
std::vector<SectionPass> passes_of(const records::Series& servo);

/// Writes the passes as numbers, and the names of the sections as an attribute `names`.
void write_sections(records::Hdf5Group group, const std::vector<SectionPass>& passes,
                    const std::vector<std::string>& names);

}  // namespace servomill::sim::run
