/// Recorded signals in a result file.
#pragma once

#include <memory>

#include "sim/records/series_writer.h"
#include "sim/records/shared_signals.h"

namespace servomill::sim::run {

struct SeriesFormat {
  records::EvenSteps steps;  // of the rows of a recording from which none was left out
  int compression = 1;
  unsigned threads = 0;  // that compress; 0: one a core; the file does not depend on it
};

/// True if the rows have these times: none was left out, as windows do, or added in between.
/// @pre  the series has time
bool has_even_times(const records::Series& series, const records::EvenSteps& steps);

/// Pages of a series as a result file holds them: its own, if it has some, or those that its rows
/// are encoded in here.
std::shared_ptr<const records::ColumnPages> encoded_pages(const records::Series& series,
                                                          const SeriesFormat& format);

/// Writes a series with its default plot: the contour error over time; without it, the first
/// signal.
/// @param pages  encoded_pages() of it
/// @param shared  series of the file, whose equal signals are not written again
/// @return layout as it was written
records::SeriesLayout write_series(records::Hdf5Group group, const records::Series& series,
                                   const records::ColumnPages& pages, const SeriesFormat& format,
                                   const records::SharedSignals& shared = {});

}  // namespace servomill::sim::run
