#include "sim/records/series.h"

#include <utility>

namespace servomill::sim {

Series::Series(std::vector<Signal> signals) : signals_(std::move(signals)) {
  for (Signal& channel : signals_) {
    channel.offset = width_;
    width_ += channel.columns();
  }
}

double* Series::add_rows(std::size_t count) {
  data_.resize(data_.size() + count * width_, 0.0);
  return data_.data() + data_.size() - count * width_;
}

const Signal* Series::find(std::string_view name) const {
  for (const Signal& channel : signals_) {
    if (channel.name == name) return &channel;
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

}  // namespace servomill::sim
