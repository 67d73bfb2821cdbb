#include <pybind11/pybind11.h>

#include "sim/version.h"
#include "tools/python/bode.h"
#include "tools/python/comparison.h"
#include "tools/python/exceptions.h"
#include "tools/python/identification.h"
#include "tools/python/programs.h"
#include "tools/python/run.h"
#include "tools/python/scenario.h"
#include "tools/python/series_arrays.h"
#include "tools/python/strategy.h"
#include "tools/python/sweep.h"

PYBIND11_MODULE(_core, module) {
  using namespace servomill::python;
  module.attr("version") = servomill::sim::kVersion;
  register_exceptions();
  bind_signals(module);
  bind_scenario(module);
  bind_comparison(module);
  bind_run(module);
  bind_sweep(module);
  bind_bode(module);
  bind_programs(module);
  bind_identification(module);
  bind_calibration(module);
  bind_strategies(module);
}
