#include "sim/system/read_file.h"

#include <fmt/format.h>

#include "plant/vocabulary/byte_order_mark.h"
#include "plant/vocabulary/stored_text.h"

namespace servomill::sim::system {
namespace {

[[noreturn]] void fail(const std::string& path, const Place& at, std::string_view what,
                       std::string_view why) {
  if (at.file.empty()) throw InputError({path}, fmt::format("cannot be read: {}", why));
  throw InputError(at, fmt::format("{} '{}' cannot be read: {}", what, path, why));
}

}  // namespace

std::string read_file(const std::string& path, const Place& at, std::string_view what,
                      std::uintmax_t most) {
  std::string why;
  std::string text = read_input(path, most, why);
  if (!why.empty()) fail(path, at, what, why);
  // a part may be binary
  if (what != "part" && text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  return text;
}

StoredText stored_file(const std::string& path, const Place& at, std::string_view what) {
  InputPieces pieces(path, kMaxBytesOfFile);
  StoredText text;
  text.reserve(pieces.size());
  std::string_view piece = pieces.next();
  if (piece.starts_with(kByteOrderMark)) piece.remove_prefix(kByteOrderMark.size());
  while (!piece.empty()) {
    text.append(piece);
    piece = pieces.next();
  }
  if (!pieces.why().empty()) fail(path, at, what, pieces.why());
  return text;
}

}  // namespace servomill::sim::system
