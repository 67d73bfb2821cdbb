#include "sim/input/scenario_source.h"

#include <algorithm>
#include <filesystem>

#include "sim/input/machine_document.h"
#include "sim/input/read_scenario.h"
#include "sim/input/scenario_document.h"
#include "sim/model/scenario.h"

namespace servomill::sim::input {

struct ScenarioSource::Parts {
  std::string path, name;
  std::vector<std::string> changes;
  std::unique_ptr<InputFiles> files;
  config::Document as_written;
  ScenarioDocument base;  // with the machine and the changes in it

  ScenarioDocument document(const std::vector<std::string>& more) const {
    if (std::none_of(more.begin(), more.end(), comes_before_machine)) {
      ScenarioDocument changed = base;
      for (const std::string& change : more) changed.document.set(change);
      return changed;
    }
    std::vector<std::string> all = changes;
    all.insert(all.end(), more.begin(), more.end());
    return with_machine(as_written, all, *files);
  }
};

ScenarioSource::ScenarioSource(const std::string& path, std::vector<std::string> changes,
                               std::optional<std::string> text) {
  auto files = std::make_unique<InputFiles>();
  if (text) files->provide(path, *std::move(text));
  config::Document as_written = scenario_document(path, *files);
  ScenarioDocument base = with_machine(as_written, changes, *files);
  parts_.reset(new Parts{path, std::filesystem::path(path).stem().string(), std::move(changes),
                         std::move(files), std::move(as_written), std::move(base)});
}

ScenarioSource::~ScenarioSource() = default;
ScenarioSource::ScenarioSource(ScenarioSource&&) noexcept = default;

model::Scenario ScenarioSource::at(const std::vector<std::string>& more) const {
  const Parts& p = *parts_;
  model::Scenario scenario = read_document(p.document(more), p.name, *p.files);
  scenario.text = *p.files->text(p.path, {}, "scenario");
  return scenario;
}

std::optional<std::uint64_t> ScenarioSource::checksum(const std::string& path) const {
  try {
    return parts_->files->checksum(path, {}, "file");
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::vector<std::string> ScenarioSource::bases_of_machine(const std::string& path) const {
  try {
    std::vector<std::string> files = machine_document(path, *parts_->files).files;
    files.erase(files.begin());
    return files;
  } catch (const InputError&) {
    return {};
  }
}

}  // namespace servomill::sim::input
