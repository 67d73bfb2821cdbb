#include "sim/records/shared_signals.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <utility>

namespace servomill::sim::records {

using Chunk = std::vector<std::uint8_t>;

// Chunks of the columns of a series.
class EncodedColumns {
 public:
  explicit EncodedColumns(const ColumnPages& pages) : pages_(pages) {}
  std::size_t chunks() const {
    return (pages_.rows() + pages_.page_rows() - 1) / pages_.page_rows();
  }
  std::size_t first_row(std::size_t chunk) const { return chunk * pages_.page_rows(); }
  // @param room  for a chunk that is not kept
  const Chunk& encoded(std::size_t column, std::size_t chunk, Chunk& room) {
    if (chunk > 0) return read(column, chunk, room);
    // asked for again and again: by it signals mostly differ
    Chunk& first = first_chunks_[column];
    return first.empty() ? read(column, chunk, first) : first;
  }

 private:
  const Chunk& read(std::size_t column, std::size_t chunk, Chunk& to) const {
    if (!pages_.read_encoded(column, chunk, to)) {
      throw std::logic_error("recorded signals are not encoded");
    }
    return to;
  }

  const ColumnPages& pages_;
  std::map<std::size_t, Chunk> first_chunks_;  // by column
};

namespace {

constexpr std::string_view kEquals = " = ", kIs = ": ";

// Columns of a channel.
struct Columns {
  std::size_t first, count;
};

// @param other  a chunk of the same signal elsewhere, by column, chunk and room for it
template <class Other>
bool are_equal(EncodedColumns& encoded, Columns columns, Other&& other) {
  Chunk one, another;
  for (std::size_t c = 0; c < columns.count; ++c) {
    for (std::size_t chunk = 0; chunk < encoded.chunks(); ++chunk) {
      if (encoded.encoded(columns.first + c, chunk, one) != other(c, chunk, another)) return false;
    }
  }
  return true;
}

bool equals_stored(EncodedColumns& encoded, Columns columns, Hdf5Dataset stored) {
  return are_equal(encoded, columns,
                   [&](std::size_t c, std::size_t chunk, Chunk& room) -> const Chunk& {
                     stored.read_chunk(encoded.first_row(chunk), c, room);
                     return room;
                   });
}

Columns columns_of(const Series& series, const Channel& channel) {
  const Signal& signal = *series.find(channel.name);
  return {signal.offset, signal.columns()};
}

bool may_share(const Channel& one, const Channel& other) {
  return !one.labels.empty() && one.labels == other.labels && one.storage == other.storage &&
         one.storage != Storage::int32 && one.meaning.units == other.meaning.units;
}

// Shares within a series.
void share_channels(EncodedColumns& encoded, const Series& series, std::vector<Channel>& channels) {
  std::vector<std::vector<const Channel*>> sharing(channels.size());
  for (std::size_t i = 0; i < channels.size(); ++i) {
    sharing[i].push_back(&channels[i]);
    const Columns columns = columns_of(series, channels[i]);
    for (std::size_t earlier = 0; earlier < i && channels[i].same_as.empty(); ++earlier) {
      const Channel& other = channels[earlier];
      if (!other.same_as.empty() || !may_share(channels[i], other)) continue;
      const Columns before = columns_of(series, other);
      const auto chunk_before = [&](std::size_t c, std::size_t chunk, Chunk& room) -> const Chunk& {
        return encoded.encoded(before.first + c, chunk, room);
      };
      if (!are_equal(encoded, columns, chunk_before)) continue;
      channels[i].same_as = other.name;
      sharing[earlier].push_back(&channels[i]);
    }
  }
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (sharing[i].size() > 1) channels[i].meaning.long_name = long_name_of_all(sharing[i]);
  }
}

bool is_drawn(const Plot& plot, const std::string& name) {
  return plot.signal == name ||
         std::find(plot.others.begin(), plot.others.end(), name) != plot.others.end();
}

bool is_same(const Meaning& one, const Meaning& other) {
  return one.units == other.units && one.long_name == other.long_name;
}

bool is_same(const ColumnLabels& one, const ColumnLabels& other) {
  return one.name == other.name && one.letters == other.letters && one.long_name == other.long_name;
}

// @pre the labels of the same name are the same
bool is_same(const Channel& one, const Channel& other) {
  return one.name == other.name && is_same(one.meaning, other.meaning) &&
         one.labels == other.labels && one.storage == other.storage;
}

const ColumnLabels* find_labels(const std::vector<ColumnLabels>& all, const std::string& name) {
  const auto at = std::find_if(all.begin(), all.end(),
                               [&](const ColumnLabels& one) { return one.name == name; });
  return at == all.end() ? nullptr : &*at;
}

Channel index_of(const SeriesLayout& layout) {
  return {layout.index, layout.index_meaning, "", Storage::float64, layout.index_same_as};
}

}  // namespace

std::string long_name_of_all(std::span<const Channel* const> channels) {
  std::string out;
  for (const Channel* channel : channels) {
    if (!out.empty()) out += kEquals;
    out += channel->name;
    out += kIs;
    out += channel->meaning.long_name;
  }
  return out;
}

std::string own_long_name(std::string_view long_name, std::string_view name) {
  for (std::string_view rest = long_name; !rest.empty();) {
    const std::string_view part = rest.substr(0, rest.find(kEquals));
    if (part.starts_with(name) && part.substr(name.size()).starts_with(kIs)) {
      return std::string(part.substr(name.size() + kIs.size()));
    }
    rest.remove_prefix(std::min(rest.size(), part.size() + kEquals.size()));
  }
  return std::string(long_name);
}

// Sets `same_as` of all that a family with the same index has.
void SharedSignals::share(Hdf5Group& file, const Family& family, const Series& series,
                          EncodedColumns& encoded, SeriesLayout& layout) {
  layout.index_same_as = family.index.same_as;
  for (ColumnLabels& labels : layout.labels) {
    const ColumnLabels* known = find_labels(family.labels, labels.name);
    if (known != nullptr && is_same(*known, labels)) labels.same_as = known->same_as;
  }
  for (Channel& channel : layout.channels) {
    const ColumnLabels* labels = find_labels(layout.labels, channel.labels);
    if (!channel.same_as.empty() || (labels != nullptr && labels->same_as.empty())) continue;
    const auto same =
        std::find_if(family.signals.begin(), family.signals.end(), [&](const Stored& one) {
          return is_same(one.channel, channel) &&
                 one.is_drawn == is_drawn(layout.plot, channel.name) &&
                 equals_stored(encoded, columns_of(series, channel),
                               file.dataset(one.channel.same_as));
        });
    if (same != family.signals.end()) channel.same_as = same->channel.same_as;
  }
}

void SharedSignals::find(Hdf5Group& file, const Series& series, const ColumnPages& pages,
                         SeriesLayout& layout) const {
  if (pages.rows() == 0) return;
  EncodedColumns encoded(pages);
  share_channels(encoded, series, layout.channels);
  const Columns index = {*series.column(layout.index), 1};
  const auto family = std::find_if(families_.begin(), families_.end(), [&](const Family& one) {
    return one.rows == pages.rows() && one.chunk_rows == layout.chunk_rows &&
           is_same(one.index, index_of(layout)) &&
           equals_stored(encoded, index, file.dataset(one.index.same_as));
  });
  if (family != families_.end()) share(file, *family, series, encoded, layout);
}

void SharedSignals::add(const std::string& group, std::size_t rows, const SeriesLayout& layout) {
  const auto here = [&](const std::string& name) { return group + "/" + name; };
  auto family = std::find_if(families_.begin(), families_.end(), [&](const Family& one) {
    return one.index.same_as == layout.index_same_as;
  });
  if (family == families_.end()) {
    families_.push_back({rows, layout.chunk_rows, index_of(layout), {}, {}});
    family = families_.end() - 1;
    family->index.same_as = here(layout.index);
  }
  for (const ColumnLabels& labels : layout.labels) {
    if (find_labels(family->labels, labels.name) != nullptr) continue;
    family->labels.push_back(labels);
    family->labels.back().same_as = here(labels.name);
  }
  for (const Channel& channel : layout.channels) {
    const ColumnLabels* labels = find_labels(family->labels, channel.labels);
    const ColumnLabels* own = find_labels(layout.labels, channel.labels);
    // further names, and signals whose scale is another one
    if (!channel.same_as.empty() || (labels != nullptr && !is_same(*labels, *own))) continue;
    family->signals.push_back({channel, is_drawn(layout.plot, channel.name)});
    family->signals.back().channel.same_as = here(channel.name);
  }
}

}  // namespace servomill::sim::records
