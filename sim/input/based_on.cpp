#include "sim/input/based_on.h"

#include <fmt/format.h>

#include <filesystem>

#include "sim/input/scenario_document.h"

namespace servomill::sim::input {

std::optional<std::string> take_base(config::Value& root, const DocumentKind& kind,
                                     int bases_left) {
  const config::Value* base = root.find("based_on");
  if (base == nullptr) return std::nullopt;
  if (base->type != config::Value::Type::text || base->text.empty()) {
    throw InputError(base->place, fmt::format("based_on must be the name of {}", kind.one));
  }
  if (bases_left == 0) {
    throw InputError(
        base->place,
        fmt::format("based_on nested deeper than {}; one of the {} may be based on itself",
                    kMaxBases, kind.several));
  }
  std::string path = beside(base->place, base->text);
  if (!std::filesystem::exists(path)) {
    throw InputError(base->place, fmt::format("based_on = \"{}\"; no such file", base->text));
  }
  // done: what comes out needs no other file
  std::erase_if(root.children, [](const config::Value& child) { return child.key == "based_on"; });
  return path;
}

}  // namespace servomill::sim::input
