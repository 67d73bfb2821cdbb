#include "sim/system/read_file.h"

#include <fmt/format.h>

#include "plant/vocabulary/byte_order_mark.h"

namespace servomill::sim::system {

std::string read_file(const std::string& path, const Place& at, std::string_view what,
                      std::uintmax_t most) {
  const auto fail = [&](std::string_view why) {
    if (at.file.empty()) throw InputError({path}, fmt::format("cannot be read: {}", why));
    throw InputError(at, fmt::format("{} '{}' cannot be read: {}", what, path, why));
  };
  std::string why;
  std::string text = read_input(path, most, why);
  if (!why.empty()) fail(why);
  // a part may be binary
  if (what != "part" && text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  return text;
}

}  // namespace servomill::sim::system
