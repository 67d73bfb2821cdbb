#include "sim/run/store_series.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "sim/records/encoded_series.h"
#include "sim/records/series.h"
#include "sim/records/series_spool.h"

namespace servomill::sim::run {
namespace {

// Contour error over time, next to the other distances of one column; without it, the first signal.
records::Plot plot_of(const records::Series& series, const std::string& index) {
  const records::Signal* signal = series.find("contour_error");
  for (const records::Signal& one : series.signals()) {
    if (signal == nullptr && one.name != index) signal = &one;
  }
  records::Plot plot{signal->name, {index}, {}};
  if (!signal->labels.empty()) plot.axes.push_back(records::kNoAxis);
  for (const records::Signal& one : series.signals()) {
    const bool fits = one.units == signal->units && one.labels == signal->labels;
    if (fits && one.name != index && one.name != signal->name) plot.others.push_back(one.name);
  }
  return plot;
}

records::SeriesLayout layout_of(const records::Series& series, const std::string& index) {
  records::SeriesLayout layout;
  layout.plot = plot_of(series, index);
  layout.index = index;
  for (const records::Signal& signal : series.signals()) {
    if (signal.name == index) {
      layout.index_meaning = {signal.units, signal.long_name};
      continue;
    }
    if (!signal.labels.empty() && std::none_of(layout.labels.begin(), layout.labels.end(),
                                               [&](const records::ColumnLabels& known) {
                                                 return known.name == signal.scale;
                                               })) {
      layout.labels.push_back({signal.scale, signal.labels, signal.scale});
    }
    layout.channels.push_back(
        {signal.name, {signal.units, signal.long_name}, signal.scale, signal.storage});
  }
  return layout;
}

}  // namespace

bool has_even_times(const records::Series& series, const records::EvenSteps& steps) {
  const std::size_t rows = series.rows(), time = *series.column("time");
  for (std::size_t row = 0; row < rows; ++row) {
    const auto ticks = static_cast<std::int64_t>(row) * steps.ticks;
    if (series.at(row, time) != static_cast<double>(ticks) * steps.tick) return false;
  }
  return true;
}

std::shared_ptr<const records::ColumnPages> encoded_pages(const records::Series& series,
                                                          const SeriesFormat& format) {
  if (auto own = series.shared_pages()) return own;
  const records::PageFormat of_pages = {records::even_chunk_rows(series.rows()),
                                        format.compression};
  return std::make_shared<const records::EncodedSeries>(series, of_pages, format.threads);
}

records::SeriesLayout write_series(records::Hdf5Group group, const records::Series& series,
                                   const records::ColumnPages& pages, const SeriesFormat& format,
                                   const records::SharedSignals& shared) {
  records::SeriesLayout layout = layout_of(series, "time");
  if (has_even_times(series, format.steps)) layout.index_steps = format.steps;
  layout.compression = format.compression;
  layout.chunk_rows = pages.page_rows();
  shared.find(group, series, pages, layout);
  records::write_pages(std::move(group), layout, pages);
  return layout;
}

}  // namespace servomill::sim::run
