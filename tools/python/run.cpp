#include "tools/python/run.h"

#include <pybind11/stl.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/user_file.h"
#include "sim/engine/case_result.h"
#include "sim/preparation/estimate.h"
#include "sim/run/run.h"
#include "sim/run/run_case.h"
#include "sim/run/run_output.h"
#include "sim/run/store.h"
#include "tools/python/comparison.h"
#include "tools/python/computing.h"
#include "tools/python/scenario.h"
#include "tools/python/series_arrays.h"

namespace servomill::python {
namespace {

namespace py = pybind11;

using Output = std::shared_ptr<const sim::run::RunOutput>;

struct Target {
  std::string path;  // empty: nothing is written
  bool force = false;
};

// The folder in which recordings lie until they are compared; empty: that of temporary files.
std::string scratch_folder(const std::string& path) {
  if (path.empty()) return {};
  return std::filesystem::absolute(path).parent_path().string();
}

sim::run::RunOutput run_scenario(const LoadedScenario& loaded, const Target& target,
                                 unsigned threads) {
  if (!loaded.text) remember_input(loaded.path);
  const std::string path =
      target.path.empty() ? "" : sim::run::writable_name(target.path, target.force);
  std::optional<sim::run::RunStore> store;
  sim::run::RunControl control;
  control.threads = threads;
  control.stop = &interrupt_wanted;
  control.scratch_folder = scratch_folder(path);
  control.stores_signals = !path.empty();
  control.prepared = [&](const sim::preparation::RunEstimate& takes) {
    if (path.empty()) return;
    sim::preparation::refuse_full_disk(loaded.scenario, takes, control.scratch_folder);
    store.emplace(path, target.force, loaded.scenario, threads);
  };
  control.case_done = [&](const sim::run::CaseOutput& one) {
    if (store) store->add(one);
  };
  sim::run::RunOutput output = sim::run::run_scenario(loaded.scenario, control);
  throw_if_interrupted();
  if (store) store->commit(output.comparison);
  return output;
}

py::dict description_of(const sim::run::CaseOutput& one) {
  const sim::engine::CaseResult& result = one.result;
  py::dict out;
  out["name"] = one.name;
  out["finished"] = result.outcome.finished;
  out["outcome"] = result.outcome.finished ? "finished" : result.outcome.reason;
  out["duration_s"] = one.duration;
  out["simulated_s"] = result.simulated_time;
  out["computing_s"] = result.wall_time;
  out["blocks"] = one.blocks;
  out["sections"] = one.sections;
  out["program"] = one.program != nullptr ? one.program->all() : "";
  out["notes"] = one.notes;
  return out;
}

// The signals of a case, which keep the whole output alive.
py::object signals_of(const Output& output, const sim::records::Series& series) {
  return py::cast(Signals(std::shared_ptr<const sim::records::Series>(output, &series)));
}

py::tuple run(const LoadedScenario& loaded, const std::string& path, bool force, unsigned threads,
              const py::object& progress) {
  const Output output = computed(progress, [&] {
    return std::make_shared<const sim::run::RunOutput>(
        run_scenario(loaded, {path, force}, threads));
  });
  py::list cases;
  for (const sim::run::CaseOutput& one : output->cases) {
    cases.append(py::make_tuple(description_of(one), signals_of(output, one.result.servo),
                                signals_of(output, one.result.last_ticks)));
  }
  return py::make_tuple(cases, rows_of(output->comparison),
                        sim::evaluation::format_table(output->comparison), output->wall_time);
}

}  // namespace

void bind_run(py::module_& module) {
  module.def("run", &run, py::arg("scenario"), py::arg("output") = "", py::arg("force") = false,
             py::arg("threads") = 0, py::arg("progress") = py::none());
}

}  // namespace servomill::python
