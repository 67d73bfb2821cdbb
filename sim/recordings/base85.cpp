#include "sim/recordings/base85.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <limits>

namespace servomill::sim::recordings {
namespace {

constexpr std::string_view kDigits =
    "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ!#$`()*+-/:;=?@[]^_{|}~";
static_assert(kDigits.size() == 85);
constexpr int kDigitsOfWord = 5;

}  // namespace

// Five digits, most significant first, are one 32-bit word (85^5 > 2^32), '.' is the word 0, and
// two words, high one first, are an IEEE 754 double.
std::vector<double> base85_doubles(std::string_view text, std::string& why) {
  std::vector<std::uint32_t> words;
  std::uint64_t word = 0;
  int digits = 0;
  for (const char c : text) {
    if (c == ' ' || c == '\t' || c == '\n' || c == '\r') continue;
    if (c == '.' && digits == 0) {
      words.push_back(0);
      continue;
    }
    const auto digit = kDigits.find(c);
    if (digit == std::string_view::npos) {
      why = fmt::format("byte {} is not a base-85 digit",
                        static_cast<int>(static_cast<unsigned char>(c)));
      return {};
    }
    word = word * kDigits.size() + digit;
    if (++digits < kDigitsOfWord) continue;
    if (word > std::numeric_limits<std::uint32_t>::max()) {
      why = "five digits of base 85 exceed four bytes";
      return {};
    }
    words.push_back(static_cast<std::uint32_t>(word));
    word = 0;
    digits = 0;
  }
  if (digits != 0 || words.size() % 2 != 0) {
    why = "ends within a number";
    return {};
  }
  std::vector<double> out;
  for (std::size_t i = 0; i < words.size(); i += 2) {
    out.push_back(std::bit_cast<double>((std::uint64_t{words[i]} << 32) | words[i + 1]));
  }
  return out;
}

}  // namespace servomill::sim::recordings
