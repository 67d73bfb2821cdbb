#include "sim/fmu/library/fmu_files.h"

#include <charconv>
#include <fstream>
#include <iterator>

#include "plant/vocabulary/input_error.h"

namespace servomill::sim::fmu {

MachineConstants machine_in(const std::string& resources, const std::string& token) {
  const std::string name =
      resources + (resources.ends_with('/') ? "" : "/") + std::string(kConstantsFile);
  std::ifstream file(name, std::ios::binary);
  if (!file) throw InputError({name}, "cannot be read");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  MachineConstants machine = read_machine_constants(text, name);
  if (token_of(text) != token) {
    throw InputError({name}, "belongs to another model description than " + token);
  }
  if (machine.axes.empty()) throw InputError({name}, "has no axis");
  return machine;
}

std::string path_of(const std::string& uri) {
  constexpr std::string_view kScheme = "file:", kHost = "//", kLocal = "localhost";
  std::string_view rest = uri;
  if (!rest.starts_with(kScheme)) return uri;
  rest.remove_prefix(kScheme.size());
  if (rest.starts_with(kHost)) rest.remove_prefix(kHost.size());
  if (rest.starts_with(kLocal)) rest.remove_prefix(kLocal.size());
  std::string path;
  for (std::size_t n = 0; n < rest.size(); ++n) {
    unsigned char byte = 0;
    const bool coded =
        rest[n] == '%' && n + 2 < rest.size() &&
        std::from_chars(&rest[n + 1], &rest[n + 1] + 2, byte, 16).ptr == &rest[n + 1] + 2;
    path += coded ? static_cast<char>(byte) : rest[n];
    if (coded) n += 2;
  }
  return path;
}

}  // namespace servomill::sim::fmu
