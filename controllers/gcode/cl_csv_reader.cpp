#include "controllers/gcode/cl_csv_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "controllers/gcode/cl_reader.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

class CsvReader : ClReader {
 public:
  using ClReader::ClReader;

  ClData read(std::string_view text) {
    int line = 0;
    bool has_header = false;
    while (!text.empty() && faults_.size() < kMaxFaults) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      PlacedText whole;
      int column = 0;
      ++line;
      for (const char c : text.substr(0, end)) whole.add(c, line, ++column);
      text.remove_prefix(std::min(end + 1, text.size()));
      whole = whole.trimmed(0, whole.text.size());
      if (whole.text.empty() || whole.text.front() == '#') continue;
      const auto cells = split(whole, 0, ',');
      if (has_header) {
        guarded([&] { location(cells, {line, 1}); });
        continue;
      }
      guarded([&] { header(cells, {line, 1}); });
      if (!faults_.empty()) break;
      has_header = true;
    }
    return finish();
  }

 private:
  struct Column {
    std::string_view name;
    std::size_t value;  // place among x y z i j k feed
    double unit;
  };
  static constexpr std::size_t kFeed = 6, kValues = 7;
  static constexpr std::array<Column, 14> kColumns = {{{"x", 0, mm},
                                                       {"y", 1, mm},
                                                       {"z", 2, mm},
                                                       {"x_mm", 0, mm},
                                                       {"y_mm", 1, mm},
                                                       {"z_mm", 2, mm},
                                                       {"x_in", 0, inch},
                                                       {"y_in", 1, inch},
                                                       {"z_in", 2, inch},
                                                       {"i", 3, 1.0},
                                                       {"j", 4, 1.0},
                                                       {"k", 5, 1.0},
                                                       {"feed", kFeed, mm_per_min},
                                                       {"feed_mm_per_min", kFeed, mm_per_min}}};

  void header(const std::vector<PlacedText>& cells, Spot at) {
    static constexpr std::array<std::string_view, kValues> kNames = {"x", "y", "z",   "i",
                                                                     "j", "k", "feed"};
    std::array<bool, kValues> seen{};
    for (const PlacedText& cell : cells) {
      const auto known = std::find_if(kColumns.begin(), kColumns.end(),
                                      [&](const Column& one) { return one.name == cell.text; });
      if (known == kColumns.end()) {
        fail(cell.spot(),
             fmt::format(
                 "unknown column '{}'; must be one of x, y, z (also x_mm, x_in), i, j, k, feed",
                 cell.text));
      }
      if (seen[known->value]) {
        fail(cell.spot(), fmt::format("column {} appears twice", kNames[known->value]));
      }
      seen[known->value] = true;
      columns_.push_back(*known);
    }
    for (std::size_t i = 0; i < kFeed; ++i) {
      if (!seen[i]) fail(at, fmt::format("the header lacks column {}", kNames[i]));
    }
  }

  void location(const std::vector<PlacedText>& cells, Spot at) {
    if (cells.size() != columns_.size()) {
      fail(at, fmt::format("{} values; the header has {}", cells.size(), columns_.size()));
    }
    std::array<double, kValues> values{};
    Spot axis, feed;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      values[columns_[c].value] = number(cells[c]) * columns_[c].unit;
      if (columns_[c].value == 3) axis = cells[c].spot();
      if (columns_[c].value == kFeed) feed = cells[c].spot();
    }
    if (feed.line > 0 && !(values[kFeed] > 0.0)) fail(feed, "the feed rate must be > 0");
    ClRecord record;
    record.line = at.line;
    record.P.p_WT = {values[0], values[1], values[2]};
    record.P.k_W = unit_axis({values[3], values[4], values[5]}, axis);
    record.feed = values[kFeed];
    out_.records.push_back(record);
  }

  std::vector<Column> columns_;
};

}  // namespace

ClData read_cl_csv(std::string_view text, const std::string& file,
                   std::vector<Warning>* of_refused) {
  return CsvReader(file, of_refused).read(text);
}

}  // namespace servomill::controllers
