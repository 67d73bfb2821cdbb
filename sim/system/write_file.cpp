#include "sim/system/write_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/user_file.h"
#include "sim/system/output_name.h"
#include "sim/system/system_error.h"

namespace servomill::sim::system {
namespace {

void write_all(const std::string& partial, std::string_view text, const std::string& path) {
  const OpenFile file(std::fopen(partial.c_str(), "wbx"));
  if (file == nullptr || std::fwrite(text.data(), 1, text.size(), file.get()) != text.size() ||
      std::fflush(file.get()) != 0 || ::fsync(::fileno(file.get())) != 0) {
    throw SystemError(path, "cannot be written", std::strerror(errno));
  }
}

}  // namespace

void refuse_unwritable_text(const std::string& path, bool force) {
  if (path.empty()) throw InputError({"--output"}, "the name of the file is empty");
  output_target(path, existing_of(force));
}

void write_text_file(const std::string& path, std::string_view text, bool force) {
  refuse_unwritable_text(path, force);
  const Existing existing = existing_of(force);
  const std::string target = output_target(path, existing);
  const TemporaryFile partial(target);
  write_all(partial.name(), text, path);
  give_name(partial.name(), target, existing);
}

}  // namespace servomill::sim::system
