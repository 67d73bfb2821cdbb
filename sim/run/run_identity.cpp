#include "sim/run/run_identity.h"

#include <algorithm>
#include <array>

#include "sim/engine/simulate.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/prepared_case.h"

namespace servomill::sim::run {
namespace {

// "case" of "[[case.strategy]]"
std::string_view first_key(std::string_view header) {
  header.remove_prefix(std::min(header.find_first_not_of('['), header.size()));
  return header.substr(0, header.find_first_of(".]"));
}

bool is_left_out(std::string_view key) {
  constexpr std::array<std::string_view, 3> kOthers = {"errors", "quantity", "sweep"};
  return std::find(kOthers.begin(), kOthers.end(), key) != kOthers.end();
}

void add_outputs(const engine::RunOutputs& outputs, std::string& text) {
  text += outputs.demands ? "\ndemands" : "\n";
  text += outputs.last_ticks ? "\nlast ticks" : "\n";
  if (!outputs.signals) return;
  for (const std::string& signal : *outputs.signals) text += "\n" + signal;
}

}  // namespace

std::string document_of_run(std::string_view toml, std::size_t number, std::size_t cases) {
  for (const std::string_view quotes : {"\"\"\"", "'''"}) {
    if (toml.find(quotes) != std::string_view::npos) return {};
  }
  std::string out;
  std::size_t case_count = 0;
  bool is_kept = true;
  while (!toml.empty()) {
    const std::size_t length = std::min(toml.find('\n'), toml.size() - 1) + 1;
    const std::string_view line = toml.substr(0, length);
    toml.remove_prefix(length);
    if (line.starts_with('[')) {
      const std::string_view key = first_key(line);
      if (line.starts_with("[[case]]")) ++case_count;
      is_kept = key == "case" ? case_count == number + 1 : !is_left_out(key);
    }
    if (is_kept) out += line;
  }
  return case_count == cases ? out : std::string();
}

RunIdentity::RunIdentity(const preparation::PreparedCase& prepared,
                         const engine::CaseInputs& inputs, std::size_t number) {
  const preparation::PreparedParts p = prepared.parts();
  const bool learns = !p.lessons.empty();
  if (inputs.machine.heat || inputs.keeping.thinning || learns || !inputs.stops_with.empty())
    return;
  document_ = document_of_run(p.scenario.resolved, number, p.scenario.cases.size());
  is_comparable_ = !document_.empty();
  add_outputs(inputs.outputs, document_);
  prepared_ = {&p.program, &p.motion, p.rewritten, p.cutting, p.imposed, &inputs.machine_errors};
  for (const auto& strategy : p.strategies) prepared_.push_back(strategy.get());
}

bool RunIdentity::is_same_as(const RunIdentity& other) const {
  return is_comparable_ && other.is_comparable_ && prepared_ == other.prepared_ &&
         document_ == other.document_;
}

}  // namespace servomill::sim::run
