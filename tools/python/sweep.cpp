#include "tools/python/sweep.h"

#include <pybind11/stl.h>

#include <string>
#include <utility>
#include <vector>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/user_file.h"
#include "sim/sweep/run_sweep.h"
#include "sim/sweep/sweep.h"
#include "sim/sweep/table.h"
#include "sim/sweep/table_csv.h"
#include "tools/python/computing.h"
#include "tools/python/scenario.h"

namespace servomill::python {
namespace {

namespace py = pybind11;

struct SweepTarget {
  std::string path, points, shard;
  bool force = false;
};

std::vector<bool> points_done(const sim::sweep::SweepTable& table) {
  std::vector<bool> done;
  for (const sim::run::PointStatus status : table.statuses()) {
    done.push_back(status != sim::run::PointStatus::not_run);
  }
  return done;
}

std::string run_sweep(const LoadedScenario& loaded, const SweepTarget& target, unsigned threads) {
  if (!loaded.text) remember_input(loaded.path);
  const sim::sweep::Sweep sweep(loaded.path, loaded.changes, loaded.text);
  const sim::sweep::Selection selection =
      sim::sweep::read_selection(sweep.design().size(), target.points, target.shard);
  std::string path = sim::sweep::writable_table(target.path, selection, target.shard, target.force);
  sweep.refuse_hopeless();
  sim::sweep::SweepTable table(path, target.force, sweep.base(),
                               sim::sweep::columns_of(sweep.base()), selection);
  if (table.is_complete()) return path;
  sim::sweep::SweepControl control;
  control.threads = threads;
  control.stop = &interrupt_wanted;
  control.batch_done = [&](std::vector<sim::sweep::SweepPoint>&& points) { table.write(points); };
  sim::sweep::run_sweep(sweep, selection, points_done(table), control);
  throw_if_interrupted();
  table.commit();
  return path;
}

std::string sweep(const LoadedScenario& loaded, const std::string& path, bool force,
                  const std::string& points, const std::string& shard, unsigned threads,
                  const py::object& progress) {
  return computed(progress, [&] {
    return run_sweep(loaded, {path, points, shard, force}, threads);
  });
}

}  // namespace

void bind_sweep(py::module_& module) {
  module.def("sweep", &sweep, py::arg("scenario"), py::arg("output"), py::arg("force") = false,
             py::arg("points") = "", py::arg("shard") = "", py::arg("threads") = 0,
             py::arg("progress") = py::none());
}

}  // namespace servomill::python
