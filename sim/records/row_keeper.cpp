#include "sim/records/row_keeper.h"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace servomill::sim::records {
namespace {

// A thinned recording is bounded by its size, not by a number of rows; its chunks must reach the
// thinning in time.
std::size_t rows_within(const ThinningLimits& limits, const Series& series) {
  constexpr double kMinChunks = 16.0;
  const double rows =
      limits.bytes / (kMinChunks * static_cast<double>(series.width() * sizeof(double)));
  return static_cast<std::size_t>(std::clamp(rows, 64.0, 16384.0));
}

SpoolFormat format_of(const RowKeeping& keeping, std::size_t chunk_rows) {
  const std::string& folder = keeping.folder;
  return {.folder = folder.empty() ? std::filesystem::temp_directory_path().string() : folder,
          .page = {.chunk_rows = chunk_rows, .compression = keeping.compression},
          .encodes_beside = keeping.encodes_beside};
}

// Columns of the signals that are read.
std::vector<bool> read_columns(const RowKeeping& keeping, const std::vector<Signal>& signals) {
  std::vector<bool> out;
  for (const Signal& one : signals) {
    out.insert(out.end(), one.columns(), !keeping.read || keeping.read->contains(one.name));
  }
  return out;
}

}  // namespace

RowKeeper::RowKeeper(const std::vector<Signal>& signals, const RowKeeping& keeping,
                     std::size_t rows)
    : series_(signals) {
  if (keeping.thinning) {
    ThinningLimits limits = *keeping.thinning;
    limits.rows = rows;
    thinning_.emplace(signals, limits);
    series_ = Series(thinning_->signals());
    if (limits.every > 0) {
      make_room(keeping, rows / limits.every + 1);
      return;
    }
    // its size is asked for after every block of rows
    SpoolFormat format = format_of(keeping, rows_within(limits, series_));
    format.encodes_beside = false;
    spool_ = std::make_shared<SeriesSpool>(series_.signals(), std::move(format));
    return;
  }
  make_room(keeping, rows);
}

void RowKeeper::make_room(const RowKeeping& keeping, std::size_t rows) {
  const double size = static_cast<double>(rows) * static_cast<double>(series_.width()) *
                      static_cast<double>(sizeof(double));
  const bool is_long = size > keeping.most_in_memory;
  if (!is_long && !keeping.encodes) return series_.reserve(rows);
  SpoolFormat format = format_of(keeping, even_chunk_rows(rows));
  if (!is_long) {
    format.most_in_memory = keeping.most_in_memory;
    format.kept = read_columns(keeping, series_.signals());
  }
  spool_ = std::make_shared<SeriesSpool>(series_.signals(), std::move(format));
}

void RowKeeper::add(std::span<const double> rows) {
  if (!thinning_) return keep(rows);
  staying_.clear();
  thinning_->add(rows, staying_);
  keep(staying_);
  if (spool_ != nullptr) thinning_->account(spool_->bytes(), spool_->rows_encoded());
}

void RowKeeper::keep(std::span<const double> rows) {
  if (spool_ != nullptr) return spool_->append(rows);
  series_.append(rows);
}

Series RowKeeper::take() {
  if (thinning_) {
    staying_.clear();
    thinning_->finish(staying_);
    keep(staying_);
  }
  if (spool_ == nullptr) return std::move(series_);
  spool_->finish();
  return {series_.signals(), std::move(spool_)};
}

}  // namespace servomill::sim::records
