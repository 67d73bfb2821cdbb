#include "plant/vocabulary/user_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <set>
#include <utility>

#include "plant/vocabulary/interrupt.h"

namespace servomill {
namespace {

using Identity = std::pair<dev_t, ino_t>;

struct Record {
  std::mutex mutex;
  bool on = false;
  std::set<Identity> files;
};

Record& record() {
  static Record one;
  return one;
}

void remember(const struct stat& file) {
  const std::scoped_lock lock(record().mutex);
  if (record().on) record().files.emplace(file.st_dev, file.st_ino);
}

std::string kind_of(mode_t mode) {
  if (S_ISREG(mode)) return {};
  if (S_ISDIR(mode)) return "is a folder";
  if (S_ISFIFO(mode)) return "is a pipe, not a regular file";
  if (S_ISSOCK(mode)) return "is a socket, not a regular file";
  return "is a device, not a regular file";
}

std::string size_text(std::uintmax_t bytes) {
  constexpr double kMega = 1e6, kGiga = 1e9;
  const auto size = static_cast<double>(bytes);
  return size < kGiga ? fmt::format("{:.4g} MB", size / kMega)
                      : fmt::format("{:.4g} GB", size / kGiga);
}

// A pipe that nobody writes must not keep the process.
OpenFile open_regular(const std::string& path, struct stat& about, std::string& why) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) {
    why =
        path == "-" && errno == ENOENT
            ? "standard input is not supported, because files are read more than once; name a file"
            : std::strerror(errno);
    return nullptr;
  }
  why = ::fstat(descriptor, &about) != 0 ? std::strerror(errno) : kind_of(about.st_mode);
  std::FILE* file = why.empty() ? ::fdopen(descriptor, "rb") : nullptr;
  if (file == nullptr) {
    if (why.empty()) why = std::strerror(errno);
    ::close(descriptor);
    return nullptr;
  }
  return OpenFile(file);
}

}  // namespace

InputRecord::InputRecord() {
  const std::scoped_lock lock(record().mutex);
  assert(!record().on);
  record().on = true;
}

InputRecord::~InputRecord() {
  const std::scoped_lock lock(record().mutex);
  record().on = false;
  record().files.clear();
}

void remember_input(const std::string& path) {
  struct stat about {};
  if (::stat(path.c_str(), &about) == 0 && S_ISREG(about.st_mode)) remember(about);
}

bool is_input(const std::string& path) {
  struct stat about {};
  if (::stat(path.c_str(), &about) != 0) return false;
  const std::scoped_lock lock(record().mutex);
  return record().files.count({about.st_dev, about.st_ino}) > 0;
}

OpenFile open_input(const std::string& path, std::string& why) {
  struct stat about {};
  OpenFile file = open_regular(path, about, why);
  if (file) remember(about);
  return file;
}

std::string why_unreadable(const std::string& path) {
  struct stat about {};
  std::string why;
  open_regular(path, about, why);
  return why;
}

InputPieces::InputPieces(const std::string& path, std::uintmax_t most) : most_(most) {
  constexpr std::size_t kMaxPiece = 1U << 20, kMinPiece = 1U << 12;
  struct stat about {};
  file_ = open_regular(path, about, why_);
  if (!file_) return;
  remember(about);
  const auto size = static_cast<std::uintmax_t>(about.st_size);
  if (size > most) {
    why_ = fmt::format("is {}, larger than the limit of {}", size_text(size), size_text(most));
    return;
  }
  size_ = static_cast<std::size_t>(size);
  piece_.resize(std::clamp(size_, kMinPiece, kMaxPiece));
}

std::string_view InputPieces::next() {
  if (!why_.empty()) return {};
  throw_if_interrupted();
  const std::size_t count = std::fread(piece_.data(), 1, piece_.size(), file_.get());
  read_ += count;
  if (std::ferror(file_.get()) != 0) {
    why_ = std::strerror(errno);
  } else if (read_ > most_) {  // it may grow while it is read
    why_ = fmt::format("is larger than the limit of {}", size_text(most_));
  }
  return why_.empty() ? std::string_view(piece_).substr(0, count) : std::string_view();
}

std::string read_input(const std::string& path, std::uintmax_t most, std::string& why) {
  InputPieces pieces(path, most);
  std::string text;
  text.reserve(pieces.size());
  for (auto piece = pieces.next(); !piece.empty(); piece = pieces.next()) text += piece;
  why = pieces.why();
  return why.empty() ? text : std::string();
}

std::string not_a_regular_file(const std::string& path) {
  struct stat about {};
  if (::stat(path.c_str(), &about) != 0) return {};
  const std::string kind = kind_of(about.st_mode);
  return kind.substr(0, kind.find(','));  // of an output no size counts
}

}  // namespace servomill
