#include "sim/sweep/selection.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>

#include "plant/vocabulary/input_error.h"

namespace servomill::sim::sweep {
namespace {

constexpr std::uint64_t kLongestBlock = 16;
constexpr std::uint64_t kBlocks = 4;  // a shard, at least, where there are points enough
constexpr std::uint64_t kMaxShards = 1'000'000;

std::optional<std::uint64_t> number(std::string_view digits) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

// "A-B", "I/N"
std::optional<std::pair<std::uint64_t, std::uint64_t>> two_numbers(std::string_view text,
                                                                   char between) {
  const std::size_t at = text.find(between);
  if (at == std::string_view::npos) return std::nullopt;
  const auto a = number(text.substr(0, at)), b = number(text.substr(at + 1));
  if (!a || !b) return std::nullopt;
  return std::pair(*a, *b);
}

}  // namespace

std::uint64_t Selection::block() const {
  return std::clamp<std::uint64_t>((last - first) / (kBlocks * shards), 1, kLongestBlock);
}

std::uint64_t Selection::size() const {
  const std::uint64_t points = last - first, turn = block() * shards;
  const std::uint64_t before = std::min((shard - 1) * block(), points % turn);
  return points / turn * block() + std::min(points % turn - before, block());
}

std::uint64_t Selection::point(std::uint64_t place) const {
  return first + (place / block() * shards + shard - 1) * block() + place % block();
}

std::uint64_t Selection::place(std::uint64_t point) const {
  const std::uint64_t from_first = point - first, turn = block() * shards;
  return from_first / turn * block() + from_first % block();
}

std::uint64_t Selection::shard_of(std::uint64_t point) const {
  return (point - first) / block() % shards + 1;
}

Selection read_selection(std::uint64_t points, const std::string& range, const std::string& shard) {
  Selection selection{0, points};
  if (!range.empty()) {
    const Place place{"--points " + range};
    const auto ends = two_numbers(range, '-');
    if (!ends || ends->first < 1 || ends->first > ends->second) {
      throw InputError(place, "must be A-B (first and last point), counted from 1");
    }
    if (ends->second > points) {
      throw InputError(place, fmt::format("the sweep has {} points", points));
    }
    selection.first = ends->first - 1;
    selection.last = ends->second;
  }
  if (!shard.empty()) {
    const Place place{"--shard " + shard};
    const auto of = two_numbers(shard, '/');
    if (!of || of->first < 1 || of->first > of->second || of->second > kMaxShards) {
      throw InputError(
          place, fmt::format("must be I/N, shard I of N, with 1 <= I <= N <= {}", kMaxShards));
    }
    if (of->second > selection.last - selection.first) {
      throw InputError(place,
                       fmt::format("the sweep has only {} points: too few for so many shards",
                                   selection.last - selection.first));
    }
    std::tie(selection.shard, selection.shards) = *of;
  }
  return selection;
}

std::string shard_name(const std::string& path, const Selection& selection) {
  const std::string_view ending = path.ends_with(".h5") ? ".h5" : "";
  return fmt::format("{}.{}-of-{}{}", path.substr(0, path.size() - ending.size()), selection.shard,
                     selection.shards, ending);
}

}  // namespace servomill::sim::sweep
