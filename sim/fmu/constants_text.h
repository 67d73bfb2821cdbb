/// The text in which an FMU carries constants: a headline with the version of its keys, one line
/// `key = value` for each constant, and the CRC-64 (ECMA-182) of all lines before it as
/// `checksum = 0123456789abcdef`. Numbers are decimal, with as many digits as give the same bits
/// again.
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace servomill::sim::fmu {

/// A number that counts, such as of the entries of a list, which follow it.
struct Count {
  std::size_t value = 0;
  std::size_t max = 1'000'000;  // that a text may give
};

/// Writes the lines of one text.
class ConstantsWriter {
 public:
  explicit ConstantsWriter(std::string headline) : text_(std::move(headline) + "\n") {}

  template <class T>
  void operator()(const std::string& key, const T& value) {
    if constexpr (std::is_same_v<T, std::string>) {
      put(key, value);
    } else if constexpr (std::is_same_v<T, Count>) {
      put(key, std::to_string(value.value));
    } else if constexpr (std::is_enum_v<T> || std::is_same_v<T, bool>) {
      put(key, std::to_string(static_cast<int>(value)));
    } else {
      char digits[64];
      const auto end = std::to_chars(std::begin(digits), std::end(digits), value);
      put(key, {std::begin(digits), end.ptr});
    }
  }

  /// The text with its checksum.
  std::string finished() const;

 private:
  void put(const std::string& key, std::string_view value);

  std::string text_;
};

/// Reads the lines of one text in their order.
/// @throws InputError for another headline, a line that is not as written, or a wrong checksum
class ConstantsReader {
 public:
  /// @param name  of the file, for messages
  ConstantsReader(std::string_view text, std::string name, std::string_view headline);

  template <class T>
  void operator()(const std::string& key, T& value) {
    const std::string_view text = value_of(key);
    if constexpr (std::is_same_v<T, std::string>) {
      value = text;
    } else if constexpr (std::is_same_v<T, Count>) {
      value.value = number<std::size_t>(key, text);
      if (value.value > value.max) fail("'" + key + "' is too large");
    } else if constexpr (std::is_enum_v<T>) {
      value = static_cast<T>(number<std::uint8_t>(key, text));
    } else if constexpr (std::is_same_v<T, bool>) {
      value = number<int>(key, text) != 0;
    } else {
      value = number<T>(key, text);
    }
  }

  /// After the last constant.
  void finish();
  [[noreturn]] void fail(const std::string& why) const;

 private:
  std::string_view next();
  std::string_view value_of(const std::string& key);
  [[noreturn]] void fail_at(const std::string& key, std::string_view text) const;

  template <class T>
  T number(const std::string& key, std::string_view text) const {
    T value{};
    const char* end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, value);
    if (read.ec != std::errc() || read.ptr != end) fail_at(key, text);
    return value;
  }

  std::string_view rest_;
  std::string name_;
  int line_ = 0;
};

/// The first of several texts one behind the other: all up to its checksum.
std::string_view first_text(std::string_view texts);

}  // namespace servomill::sim::fmu
