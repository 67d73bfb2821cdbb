/// Rows in memory in the form in which a result file holds them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/records/page_encoder.h"
#include "sim/records/series.h"

namespace servomill::sim::records {

/// All columns of a series, encoded chunk by chunk.
class EncodedSeries final : public ColumnPages {
 public:
  /// @param series   in memory
  /// @param threads  that encode; 0: one a core
  EncodedSeries(const Series& series, const PageFormat& format, unsigned threads);

  std::size_t rows() const override { return rows_; }
  std::size_t page_rows() const override { return format_.chunk_rows; }
  void read(std::size_t column, std::size_t page, std::vector<double>& values) const override;
  bool read_encoded(std::size_t column, std::size_t page,
                    std::vector<std::uint8_t>& chunk) const override;

 private:
  const std::vector<std::uint8_t>& chunk(std::size_t column, std::size_t page) const {
    return chunks_[chunk_of_[page * storage_.size() + column]];
  }

  PageFormat format_;
  std::size_t rows_;
  std::vector<Storage> storage_;  // of each column
  std::vector<std::vector<std::uint8_t>> chunks_;
  std::vector<std::size_t> chunk_of_;  // index of that of each column, page after page
};

}  // namespace servomill::sim::records
