#include "sim/records/encoded_series.h"

#include <algorithm>

#include "sim/system/worker_thread.h"

namespace servomill::sim::records {

EncodedSeries::EncodedSeries(const Series& series, const PageFormat& format, unsigned threads)
    : series_(series), page_rows_(format.chunk_rows) {
  PageEncoder encoder(series.storage_of_columns(), format, system::thread_count(threads));
  for (std::size_t page = 0; page * page_rows_ < series.rows(); ++page) {
    encoder.encode(rows_of(page));
    for (const std::size_t chunk : encoder.chunk_of_columns()) {
      chunk_of_.push_back(chunks_.size() + chunk);
    }
    chunks_.insert(chunks_.end(), encoder.chunks().begin(), encoder.chunks().end());
  }
}

std::span<const double> EncodedSeries::rows_of(std::size_t page) const {
  const std::size_t first = page * page_rows_;
  const std::size_t count = std::min(page_rows_, series_.rows() - first);
  return {series_.row(first), count * series_.width()};
}

void EncodedSeries::read(std::size_t column, std::size_t page, std::vector<double>& values) const {
  values.clear();
  const std::span<const double> rows = rows_of(page);
  for (std::size_t i = column; i < rows.size(); i += series_.width()) values.push_back(rows[i]);
}

bool EncodedSeries::read_encoded(std::size_t column, std::size_t page,
                                 std::vector<std::uint8_t>& chunk) const {
  chunk = chunks_[chunk_of_[page * series_.width() + column]];
  return true;
}

}  // namespace servomill::sim::records
