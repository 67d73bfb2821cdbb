#include "sim/metrology/read_stl.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"

namespace servomill::sim::metrology {
namespace {

using Eigen::Vector3d;

static_assert(std::endian::native == std::endian::little, "numbers of STL are little-endian");

constexpr std::size_t kHeader = 80, kTriangle = 50;  // bytes
constexpr std::size_t kBefore = kHeader + 4;         // the number of triangles follows the header

// Makes one corner of all that have the same coordinates.
class Welder {
 public:
  int corner(const Vector3d& mm_place) {
    const Vector3d at = mm_place + Vector3d::Zero();  // -0 becomes 0
    const auto [entry, is_new] =
        known_.try_emplace({at.x(), at.y(), at.z()}, static_cast<int>(out.corners.size()));
    if (is_new) out.corners.push_back(at * mm);
    return entry->second;
  }
  Triangles out;

 private:
  std::map<std::array<double, 3>, int> known_;
};

template <typename T>
T number_at(std::string_view bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

Triangles read_binary(std::string_view bytes, const std::string& file) {
  const std::size_t count = number_at<std::uint32_t>(bytes, kHeader);
  if (bytes.size() != kBefore + count * kTriangle) {
    throw InputError(
        {file}, fmt::format("binary STL with {} triangles has {} bytes, but the file has {}: it {}",
                            count, kBefore + count * kTriangle, bytes.size(),
                            bytes.size() < kBefore + count * kTriangle
                                ? fmt::format("is truncated in triangle {}",
                                              (bytes.size() - kBefore) / kTriangle + 1)
                                : "continues after them"));
  }
  Welder welder;
  for (std::size_t i = 0; i < count; ++i) {
    std::array<int, 3>& triangle = welder.out.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t at = kBefore + i * kTriangle + 12 * (k + 1);  // the normal comes first
      const Vector3d place(number_at<float>(bytes, at), number_at<float>(bytes, at + 4),
                           number_at<float>(bytes, at + 8));
      if (!place.allFinite()) {
        throw InputError({file},
                         fmt::format("triangle {}, byte {}: corner {} is ({}, {}, {}); must "
                                     "be finite",
                                     i + 1, at, k + 1, place.x(), place.y(), place.z()));
      }
      triangle[k] = welder.corner(place);
    }
  }
  return std::move(welder.out);
}

// Some programs write upper case.
bool is(std::string_view found, std::string_view word) {
  return std::equal(found.begin(), found.end(), word.begin(), word.end(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

std::string_view without_byte_order_mark(std::string_view bytes) {
  return bytes.substr(bytes.starts_with("\xEF\xBB\xBF") ? 3 : 0);
}

bool begins_like_text(std::string_view text) {
  const std::size_t first = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  return is(text.substr(first, 5), "solid");
}

class Words {
 public:
  Words(std::string_view text, const std::string& file) : text_(text), place_{file, 1, 1} {}

  // The next word, or an empty one at the end; place() is where it stands.
  std::string_view next() {
    advance([](char c) { return is_space(c); });
    place_ = ahead();
    const std::size_t first = at_;
    advance([](char c) { return !is_space(c); });
    return text_.substr(first, at_ - first);
  }
  void skip_line() {
    advance([](char c) { return c != '\n'; });
  }
  const Place& place() const { return place_; }

  void expect(std::string_view word) {
    const std::string_view found = next();
    if (!is(found, word)) fail(fmt::format("expected '{}'", word), found);
  }
  double number() {
    const std::string_view word = next();
    double value = 0.0;
    const char* const end = word.data() + word.size();
    const auto result = std::from_chars(word.data() + (word.starts_with('+') ? 1 : 0), end, value);
    if (word.empty() || result.ec != std::errc() || result.ptr != end) {
      fail("expected a number", word);
    }
    if (!std::isfinite(value)) fail("expected a finite number", word);
    return value;
  }
  [[noreturn]] void fail(const std::string& expected, std::string_view found) const {
    throw InputError(place_, found.empty()
                                 ? fmt::format("{}, but the file ends here", expected)
                                 : fmt::format("{}, found '{}'", expected, found.substr(0, 40)));
  }

 private:
  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
  Place ahead() const { return {place_.file, line_, static_cast<int>(at_ - line_begin_) + 1}; }
  template <typename Condition>
  void advance(Condition condition) {
    for (; at_ < text_.size() && condition(text_[at_]); ++at_) {
      if (text_[at_] == '\n') {
        ++line_;
        line_begin_ = at_ + 1;
      }
    }
  }

  std::string_view text_;
  Place place_;
  std::size_t at_ = 0, line_begin_ = 0;
  int line_ = 1;
};

void read_loop(Words& words, Welder& welder) {
  words.expect("normal");
  for (int k = 0; k < 3; ++k) words.next();  // not used: some writers have nan here
  words.expect("outer");
  words.expect("loop");
  std::array<int, 3>& triangle = welder.out.triangles.emplace_back();
  for (int& corner : triangle) {
    words.expect("vertex");
    const double x = words.number(), y = words.number();
    corner = welder.corner({x, y, words.number()});
  }
  words.expect("endloop");
  words.expect("endfacet");
}

Triangles read_ascii(std::string_view text, const std::string& file) {
  Words words(text, file);
  Welder welder;
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (!is(word, "solid")) words.fail("expected 'solid'", word);
    words.skip_line();  // its name
    for (word = words.next(); !is(word, "endsolid"); word = words.next()) {
      if (!is(word, "facet")) words.fail("expected 'facet' or 'endsolid'", word);
      read_loop(words, welder);
    }
    words.skip_line();
  }
  return std::move(welder.out);
}

}  // namespace

Triangles read_stl(std::string_view bytes, const std::string& file) {
  // the header of a binary file may begin with "solid", too: its length and zeros tell
  const bool has_number = bytes.size() >= kBefore;
  const bool fits =
      has_number &&
      bytes.size() == kBefore + std::size_t{kTriangle} * number_at<std::uint32_t>(bytes, kHeader);
  const bool is_text = bytes.find('\0') == std::string_view::npos;
  const std::string_view text = without_byte_order_mark(bytes);
  if (!fits && is_text && begins_like_text(text)) return read_ascii(text, file);
  if (!has_number) {
    throw InputError({file}, fmt::format("not STL: {} bytes, neither 'solid' nor the {} bytes of a "
                                         "binary header",
                                         bytes.size(), kBefore));
  }
  return read_binary(bytes, file);
}

std::string binary_stl(const Triangles& triangles) {
  std::string out = "binary STL, mm";
  out.resize(kHeader, ' ');
  const auto add = [&out](const auto& value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  add(static_cast<std::uint32_t>(triangles.triangles.size()));
  for (const auto& t : triangles.triangles) {
    const auto corner = [&](int k) { return triangles.corners[t[k]]; };
    const Vector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
    for (const Vector3d& v :
         {normal, Vector3d(corner(0) / mm), Vector3d(corner(1) / mm), Vector3d(corner(2) / mm)}) {
      for (const double x : v) add(static_cast<float>(x));
    }
    add(std::uint16_t{0});
  }
  return out;
}

}  // namespace servomill::sim::metrology
