#include "sim/system/text_table.h"

#include <fmt/format.h>

#include <algorithm>

namespace servomill::sim::system {

std::string text_table(std::vector<std::vector<std::string>> lines, std::size_t grouped,
                       const std::set<std::size_t>& right) {
  std::vector<std::size_t> width;
  for (const auto& line : lines) {
    width.resize(std::max(width.size(), line.size()));
    for (std::size_t i = 0; i < line.size(); ++i) width[i] = std::max(width[i], line[i].size());
  }
  std::string out;
  std::vector<std::string> last_group;
  for (std::size_t n = 0; n < lines.size(); ++n) {
    std::vector<std::string>& line = lines[n];
    const auto end = line.begin() + static_cast<std::ptrdiff_t>(std::min(grouped, line.size()));
    std::vector<std::string> group(line.begin(), end);
    if (group == last_group) {
      for (auto cell = line.begin(); cell != end; ++cell) cell->clear();
    }
    last_group = std::move(group);
    std::string text;
    for (std::size_t i = 0; i < line.size(); ++i) {
      text += right.contains(i) ? fmt::format("{:>{}}  ", line[i], width[i])
                                : fmt::format("{:<{}}  ", line[i], width[i]);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    out += text + '\n';
    if (n == 0) out += std::string(text.size(), '-') + '\n';
  }
  return out;
}

}  // namespace servomill::sim::system
