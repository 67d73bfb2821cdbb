#include "sim/records/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace servomill::sim::records {

Series::Series(std::vector<Signal> signals) : signals_(std::move(signals)) {
  for (Signal& channel : signals_) {
    channel.offset = width_;
    width_ += channel.columns();
  }
  table_ = ColumnTable(width_);
}

Series::Series(std::vector<Signal> signals, std::shared_ptr<const ColumnPages> pages)
    : Series(std::move(signals)) {
  pages_ = std::move(pages);
  residents_.resize(width_);
}

// Neighbouring rows are often asked for in turn, on both sides of the end of a page.
double Series::at_other_page(std::size_t row_index, std::size_t column_index) const {
  auto& [latest, former] = residents_[column_index];
  std::swap(latest, former);
  if (row_index - latest.first >= latest.values.size()) {
    const std::size_t page = row_index / pages_->page_rows();
    pages_->read(column_index, page, latest.values);
    latest.first = page * pages_->page_rows();
  }
  return latest.values[row_index - latest.first];
}

std::vector<Storage> Series::storage_of_columns() const {
  std::vector<Storage> out;
  for (const Signal& signal : signals_) out.insert(out.end(), signal.columns(), signal.storage);
  return out;
}

std::vector<double> Series::by_rows() const {
  std::vector<double> out;
  out.reserve(rows() * width_);
  for (std::size_t row = 0; row < rows(); ++row) {
    for (std::size_t c = 0; c < width_; ++c) out.push_back(at(row, c));
  }
  return out;
}

const Signal* Series::find(std::string_view name) const {
  for (const Signal& channel : signals_) {
    if (channel.name == name) return &channel;
  }
  if (std::find(left_out_.begin(), left_out_.end(), name) != left_out_.end()) {
    throw std::logic_error(fmt::format("{} was not recorded, as nobody asked for it", name));
  }
  return nullptr;
}

std::optional<std::size_t> Series::column(std::string_view name, char label) const {
  const Signal* channel = find(name);
  if (channel == nullptr) return std::nullopt;
  if (channel->labels.empty()) return channel->offset;
  const std::size_t place = channel->labels.find(label);
  if (place == std::string::npos) return std::nullopt;
  return channel->offset + place;
}

}  // namespace servomill::sim::records
