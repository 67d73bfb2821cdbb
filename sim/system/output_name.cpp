#include "sim/system/output_name.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <set>
#include <string_view>
#include <system_error>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/user_file.h"
#include "sim/system/system_error.h"
#include "sim/system/write_lock.h"

namespace servomill::sim::system {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxLinks = 40;  // as Linux follows

// The end of a chain of symbolic links, which need not exist.
fs::path behind_links(const std::string& path) {
  std::error_code ignored;
  fs::path target(path);
  for (int links = 0; fs::is_symlink(fs::symlink_status(target, ignored)); ++links) {
    if (links == kMaxLinks) {
      throw InputError({path}, "is a symbolic link loop; choose another file");
    }
    const fs::path next = fs::read_symlink(target, ignored);
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  return target;
}

void refuse_missing_folder(const std::string& path, const fs::path& target) {
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (error == std::errc::too_many_symbolic_link_levels) {
    throw InputError({path},
                     fmt::format("the folder '{}' is a symbolic link loop", folder.string()));
  }
  if (status.type() == fs::file_type::not_found) {
    throw InputError({path}, fmt::format("folder '{}' does not exist", folder.string()));
  }
  if (fs::exists(status) && !fs::is_directory(status)) {
    throw InputError({path}, fmt::format("'{}' is not a folder", folder.string()));
  }
}

void refuse_input(const std::string& path, const std::string& file, const char* what = "") {
  if (!is_input(file)) return;
  throw InputError(
      {path},
      fmt::format("{}is an input of this command and is never overwritten; choose another file",
                  what));
}

// Names of the temporary files that there are.
struct TemporaryNames {
  std::mutex mutex;
  std::multiset<std::string> names;
};

TemporaryNames& temporary() {
  static TemporaryNames all;
  return all;
}

// False for what no writer of HDF5 leaves. One that was killed leaves the signature, or zeros or
// nothing in its place; a special file is not read.
bool may_be_result_file(const std::string& path) {
  constexpr std::string_view kSignature = "\x89HDF\r\n\x1a\n";
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return false;
  std::ifstream file(path, std::ios::binary);
  if (!file) return true;  // cannot be known
  std::string begin(kSignature.size(), '\0');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(file.gcount()));
  return begin == kSignature || begin.find_first_not_of('\0') == std::string::npos;
}

// False if the file system cannot tell.
bool rename_to_free_name(const char* from, const char* to) {
  if (::renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE) == 0) return true;
  return errno != EINVAL && errno != ENOSYS;
}

}  // namespace

TemporaryFile::TemporaryFile(const std::string& target)
    : TemporaryFile(fmt::format("{}.{}.partial", target, ::getpid()), 0) {}

TemporaryFile::TemporaryFile(std::string name, int) : name_(std::move(name)) {
  const std::scoped_lock lock(temporary().mutex);
  temporary().names.insert(name_);
}

TemporaryFile::~TemporaryFile() {
  if (name_.empty()) return;
  ::unlink(name_.c_str());
  release();
}

void TemporaryFile::release() {
  const std::scoped_lock lock(temporary().mutex);
  temporary().names.erase(temporary().names.find(name_));
  name_.clear();
}

void TemporaryFile::remove_all() {
  const std::scoped_lock lock(temporary().mutex);
  for (const std::string& name : temporary().names) ::unlink(name.c_str());
}

std::string output_target(const std::string& path, Existing existing) {
  const fs::path target = behind_links(path);
  const bool is_link = target != fs::path(path);
  std::error_code ignored;
  if (!target.has_filename() || fs::is_directory(target, ignored)) {
    throw InputError({path}, "is a folder; specify a file");
  }
  refuse_missing_folder(path, target);
  if (const std::string kind = not_a_regular_file(target.string()); !kind.empty()) {
    throw InputError(
        {path}, kind + "; a result file gets its name only when complete: specify a regular file");
  }
  refuse_input(path, target.string());
  refuse_input(path, target.string() + ".partial", "its partial file ");
  const bool is_there = fs::exists(target, ignored);
  if (existing == Existing::refused && is_there) {
    throw InputError({path}, "exists; use --force to overwrite");
  }
  if (existing != Existing::replaced && is_link && !is_there) {
    throw InputError(
        {path},
        fmt::format("is a symbolic link to '{}', which does not exist; use --force to write it",
                    target.string()));
  }
  return target.string();
}

void refuse_same_output(const std::string& path, const std::string& other, const std::string& what,
                        const std::string& other_what) {
  const fs::path a = behind_links(path), b = behind_links(other);
  std::error_code ignored;
  if (!fs::equivalent(a, b, ignored) && fs::weakly_canonical(fs::absolute(a), ignored) !=
                                            fs::weakly_canonical(fs::absolute(b), ignored)) {
    return;
  }
  throw InputError({what + " " + path},
                   fmt::format("is the same file as {} {}; choose another one", other_what, other));
}

void give_name(const std::string& complete, const std::string& target, Existing existing) {
  std::error_code ignored;
  const auto refuse_existing = [&] {
    if (existing != Existing::refused || !fs::exists(target, ignored)) return;
    throw InputError({target}, "exists; use --force to overwrite");
  };
  refuse_input(target, target);  // what was read since
  refuse_existing();
  if (existing == Existing::refused && rename_to_free_name(complete.c_str(), target.c_str())) {
    if (!fs::exists(complete, ignored)) return;
    refuse_existing();  // somebody was faster
  }
  if (std::rename(complete.c_str(), target.c_str()) == 0) return;
  throw SystemError(target, "cannot be created", std::strerror(errno));
}

void refuse_partial(const std::string& partial) {
  std::error_code ignored;
  if (!fs::exists(partial, ignored)) return;
  if (!may_be_result_file(partial)) {
    throw InputError(
        {partial},
        fmt::format("exists and is {}; incomplete results have this name: remove it, or choose "
                    "another result file",
                    fs::is_directory(partial, ignored) ? "a folder" : "not a result file"));
  }
  switch (writer_of(partial)) {
    case Writer::alive:
      throw SystemError(partial, "cannot be created", "another process writes it");
    case Writer::none:
      throw InputError({partial}, "exists, left by an unfinished run; use --force to overwrite");
    case Writer::unknown:
      throw InputError({partial},
                       "exists; whether a run still writes it is unknown; use "
                       "--force to overwrite");
  }
}

}  // namespace servomill::sim::system
