#include "sim/records/encoded_series.h"

#include <algorithm>

#include "sim/records/chunk_decoder.h"
#include "sim/system/worker_thread.h"

namespace servomill::sim::records {

EncodedSeries::EncodedSeries(const Series& series, const PageFormat& format, unsigned threads)
    : format_(format), rows_(series.rows()), storage_(series.storage_of_columns()) {
  PageEncoder encoder(storage_, format, system::thread_count(threads));
  std::vector<std::span<const double>> columns(series.width());
  for (std::size_t first = 0; first < rows_; first += page_rows()) {
    const std::size_t count = std::min(page_rows(), rows_ - first);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      columns[c] = series.table().column(c).subspan(first, count);
    }
    encoder.encode(columns);
    for (const std::size_t chunk : encoder.chunk_of_columns()) {
      chunk_of_.push_back(chunks_.size() + chunk);
    }
    chunks_.insert(chunks_.end(), encoder.chunks().begin(), encoder.chunks().end());
  }
}

void EncodedSeries::read(std::size_t column, std::size_t page, std::vector<double>& values) const {
  values.resize(std::min(page_rows(), rows_ - page * page_rows()));
  ChunkDecoder().decode(chunk(column, page), page_rows(), storage_[column], format_.compression,
                        values);
}

bool EncodedSeries::read_encoded(std::size_t column, std::size_t page,
                                 std::vector<std::uint8_t>& chunk) const {
  chunk = this->chunk(column, page);
  return true;
}

}  // namespace servomill::sim::records
