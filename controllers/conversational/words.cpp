#include "controllers/conversational/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace servomill::controllers::conversational {
namespace {

// Addresses that may be separated from their number by a blank.
constexpr auto kNumbered = std::to_array<std::string_view>(
    {"X",     "Y",  "Z",  "A",  "B",   "C",   "U",   "V",   "W",   "IX",  "IY",
     "IZ",    "IA", "IB", "IC", "PR",  "PA",  "IPR", "IPA", "F",   "S",   "M",
     "R",     "L",  "DL", "DR", "LEN", "CCA", "SPA", "SPB", "SPC", "MB",  "DIST",
     "MBMAX", "FT", "FU", "FZ", "REP", "ROT", "SCL", "T",   "TA",  "RND", "CHF",
     "NX",    "NY", "NZ", "TX", "TY",  "TZ",  "CCX", "CCY", "TIME"});

bool is_numbered(std::string_view address) {
  return std::find(kNumbered.begin(), kNumbered.end(), address) != kNumbered.end();
}

bool begins_number(std::string_view text) {
  if (text.empty()) return false;
  const char c = text.front();
  if (c == '+' || c == '-') return text.size() > 1;
  return (c >= '0' && c <= '9') || c == '.' || c == ',' ||
         (c == 'Q' && text.size() > 1 && text[1] != '=' && text.find('=') == text.npos);
}

// "FQ5" is F and Q5, "ZQL1" is Z and QL1.
HeidenhainWord with_parameter_apart(HeidenhainWord word) {
  for (const std::string_view q : {"QL", "QR", "Q"}) {
    const bool ends = word.address.size() > q.size() && word.address.ends_with(q);
    if (!ends || word.rest.empty() || word.rest.front() < '0' || word.rest.front() > '9') continue;
    const std::string_view address(word.address.data(), word.address.size() - q.size());
    if (!is_numbered(address)) continue;
    word.rest = std::string(q) + word.rest;
    word.address = std::string(address);
    break;
  }
  return word;
}

}  // namespace

Operand operand_of(std::string_view text, const Place& place) {
  Operand out;
  out.place = place;
  std::string_view digits = text;
  if (!digits.empty() && (digits.front() == '+' || digits.front() == '-')) {
    out.sign = digits.front() == '-' ? -1.0 : 1.0;
    digits.remove_prefix(1);
  }
  std::size_t length = 0;
  if (const auto name = q_name_at(digits, length); name && length == digits.size()) {
    out.name = name;
    return out;
  }
  std::string plain(digits);
  std::replace(plain.begin(), plain.end(), ',', '.');
  const bool is_plain = !plain.empty() && plain.find_first_not_of("0123456789.") == plain.npos;
  double value = 0.0;
  const auto [end, error] = std::from_chars(plain.data(), plain.data() + plain.size(), value);
  if (!is_plain || error != std::errc() || end != plain.data() + plain.size() ||
      !std::isfinite(value)) {
    throw InputError(place, fmt::format("'{}' is neither a number nor a Q parameter", text));
  }
  out.number = out.sign * value;
  return out;
}

std::optional<long> integer_of(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  long value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

Words::Words(std::span<const HeidenhainWord> words) {
  words_.reserve(words.size());
  for (const HeidenhainWord& word : words) {
    if (!words_.empty()) {
      HeidenhainWord& last = words_.back();
      const bool is_open = last.rest.empty() && last.text == last.address;
      const bool is_feed = last.text == "F" && (word.text == "MAX" || word.text == "AUTO");
      if (is_feed || (is_open && is_numbered(last.address) && begins_number(word.text))) {
        last.text += word.text;
        (is_feed ? last.address : last.rest) += word.text;
        continue;
      }
    }
    words_.push_back(with_parameter_apart(word));
  }
  drop_skipped_entries();
  taken_.assign(words_.size(), false);
}

// "L X+10 R F M": the letters of entries that were skipped in the dialog, which stay in force. From
// memory, as TNC 400 controls show such blocks. An M without a number ends them.
void Words::drop_skipped_entries() {
  const auto is_last = [&](std::string_view text) {
    return words_.size() > 1 && words_.back().text == text;
  };
  if (!is_last("M")) return;
  words_.pop_back();
  if (is_last("F")) words_.pop_back();
  if (is_last("R")) words_.pop_back();
}

const HeidenhainWord* Words::take(std::string_view text) {
  for (std::size_t i = 0; i < words_.size(); ++i) {
    if (taken_[i] || words_[i].text != text) continue;
    taken_[i] = true;
    return &words_[i];
  }
  return nullptr;
}

std::optional<Operand> Words::take_number(std::string_view address) {
  for (std::size_t i = 0; i < words_.size(); ++i) {
    if (taken_[i] || words_[i].address != address) continue;
    if (words_[i].rest.empty()) {
      throw InputError(words_[i].place, fmt::format("'{}' requires a number", words_[i].text));
    }
    taken_[i] = true;
    return operand_of(words_[i].rest, words_[i].place);
  }
  return std::nullopt;
}

const HeidenhainWord* Words::take_next() {
  for (std::size_t i = 0; i < words_.size(); ++i) {
    if (taken_[i]) continue;
    taken_[i] = true;
    return &words_[i];
  }
  return nullptr;
}

const HeidenhainWord* Words::peek() const {
  for (std::size_t i = 0; i < words_.size(); ++i) {
    if (!taken_[i]) return &words_[i];
  }
  return nullptr;
}

void Words::refuse_rest(std::string_view block) const {
  if (const HeidenhainWord* word = peek()) {
    throw InputError(word->place, fmt::format("'{}' is not a word of {}", word->text, block));
  }
}

}  // namespace servomill::controllers::conversational
