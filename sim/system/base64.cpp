#include "sim/system/base64.h"

#include <algorithm>
#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/binary_from_base64.hpp>
#include <boost/archive/iterators/transform_width.hpp>

namespace servomill::sim::system {
namespace {

using namespace boost::archive::iterators;

using Encode = base64_from_binary<transform_width<const char*, 6, 8>>;
using Decode = transform_width<binary_from_base64<const char*>, 8, 6>;

constexpr std::string_view kLetters =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

}  // namespace

std::string base64(std::string_view bytes) {
  const char* end = bytes.data() + bytes.size();
  std::string out(Encode(bytes.data()), Encode(end));
  out.append((3 - bytes.size() % 3) % 3, '=');
  return out;
}

std::optional<std::string> from_base64(std::string_view text) {
  if (text.size() % 4 != 0) return std::nullopt;
  const std::size_t last = text.find_last_not_of('=');
  const std::string_view letters = text.substr(0, last == text.npos ? 0 : last + 1);
  const std::size_t padding = text.size() - letters.size();
  if (padding > 2 || letters.find_first_not_of(kLetters) != letters.npos) return std::nullopt;
  // Boost reads on to the end of the group
  std::string padded(letters);
  padded.append(padding, 'A');
  std::string out(Decode(padded.data()), Decode(padded.data() + padded.size()));
  out.resize(out.size() - padding);
  if (base64(out) != text) return std::nullopt;
  return out;
}

}  // namespace servomill::sim::system
