#include "sim/input/machine_document.h"

#include <fmt/format.h>

#include <utility>

#include "sim/input/based_on.h"
#include "sim/input/scenario_document.h"

namespace servomill::sim::input {
namespace {

constexpr DocumentKind kMachineFile = {"a machine file", "machine files"};

// Reads [identified] of one file against the values of that file, and takes it out.
std::optional<IdentifiedValues> take_identified(const config::Document& own, config::Value& root) {
  config::Reader reader(own);
  std::optional<IdentifiedValues> out = read_identified(reader);
  reader.finish();
  std::erase_if(root.children,
                [](const config::Value& child) { return child.key == "identified"; });
  return out;
}

void refuse_scenario(const config::Value& root, const Place& named_at) {
  if (root.find("structure") != nullptr || root.find("case") == nullptr) return;
  throw InputError(named_at, "based_on must be the name of a machine file; this is a scenario");
}

MachineDocument with_base(const config::Document& own, InputFiles& files, int bases_left) {
  config::Value above = own.root();
  const config::Value* named = above.find("based_on");
  const Place named_at = named == nullptr ? Place{} : named->place;
  MachineDocument out{config::Document::from_text("", own.name()), {}, {own.name()}};
  if (const auto base = take_base(above, kMachineFile, bases_left)) {
    const auto text = files.text(*base, named_at, "machine");
    MachineDocument below = with_base(*files.document(*base, *text), files, bases_left - 1);
    refuse_scenario(below.document.root(), named_at);
    out.document.merge(below.document.root());
    out.files.insert(out.files.end(), below.files.begin(), below.files.end());
  }
  out.identified = take_identified(own, above);
  out.document.merge(above);
  return out;
}

}  // namespace

MachineDocument machine_document(const std::string& path, InputFiles& files, const Place& at) {
  const auto own = files.document(path, *files.text(path, at, "machine"));
  const config::Value* machine = own->root().find("machine");
  if (own->root().find("structure") == nullptr && own->root().find("case") != nullptr) {
    const bool is_named = machine != nullptr && machine->type == config::Value::Type::text;
    throw InputError({path}, fmt::format("is a scenario; a machine file is needed{}",
                                         is_named ? ", such as its '" + machine->text + "'" : ""));
  }
  return with_base(*own, files, kMaxBases);
}

MachineDocument machine_document_of_text(const std::string& text, const std::string& path,
                                         InputFiles& files) {
  return with_base(config::Document::from_text(text, path), files, kMaxBases);
}

bool is_machine_file(const std::string& path) {
  InputFiles files;
  std::string at = path;
  try {
    for (int bases_left = kMaxBases; bases_left >= 0; --bases_left) {
      config::Value root = files.document(at)->root();
      if (root.find("structure") != nullptr || root.find("identified") != nullptr) return true;
      const auto base = take_base(root, kMachineFile, bases_left);
      if (!base) return false;
      at = *base;
    }
  } catch (const InputError&) {
    return false;  // the reader of scenarios says why
  }
  return false;
}

}  // namespace servomill::sim::input
