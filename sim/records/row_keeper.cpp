#include "sim/records/row_keeper.h"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace servomill::sim {
namespace {

SpoolFormat format_of(const RowKeeping& keeping, std::size_t rows) {
  const std::string& folder = keeping.folder;
  return {.folder = folder.empty() ? std::filesystem::temp_directory_path().string() : folder,
          .chunk_rows = even_chunk_rows(rows),
          .compression = keeping.compression};
}

}  // namespace

RowKeeper::RowKeeper(std::vector<Signal> signals, const RowKeeping& keeping, std::size_t rows)
    : series_(std::move(signals)) {
  const double size = static_cast<double>(rows) * static_cast<double>(series_.width()) *
                      static_cast<double>(sizeof(double));
  if (size > keeping.most_in_memory) {
    spool_ = std::make_shared<SeriesSpool>(series_.signals(), format_of(keeping, rows));
  } else {
    series_.reserve(rows);
  }
}

void RowKeeper::add(std::span<const double> rows) {
  if (spool_ != nullptr) return spool_->append(rows);
  std::copy(rows.begin(), rows.end(), series_.add_rows(rows.size() / series_.width()));
}

Series RowKeeper::take() {
  if (spool_ == nullptr) return std::move(series_);
  spool_->finish();
  return {series_.signals(), std::move(spool_)};
}

}  // namespace servomill::sim
