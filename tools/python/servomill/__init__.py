"""servomill: a five-axis milling machine and its servo loops, simulated.

    import servomill
    result = servomill.run("scenarios/guevel2025/experiment1.toml")
    print(result.comparison)
    y = result["feedback"].servo.axis("true_linear", "Y")      # mm

Numbers that come back are in the units of the result file (mm, um, deg, s, A, Nm; `signals.units(NAME)`); strategies get and
return SI (m, rad, s). The functions do what the commands of the same names do.
"""
from ._core import Program, Setup, load_plugin, version as __version__
from .commands import (Calibration, Compensated, Curve, Estimate, Fit, Function, Identification, Location, Loop, Moves,
                       PostProcessed, bode, calibrate, canon, compare, compensate, identify, post, run, sweep)
from .errors import Fault, InputError, SystemFailed
from .files import StoredRun, Sweep, open
from .results import Case, Comparison, Row, Run
from .scenario import Scenario, load, scenario_folder, scenarios
from .signals import Description, Signals
from .strategies import Blocks, Parameter, split, strategy

__all__ = [
    "Blocks", "Calibration", "Case", "Comparison", "Compensated", "Curve", "Description", "Estimate", "Fault", "Fit", "Function",
    "Identification", "InputError", "Location", "Loop", "Moves", "Parameter", "PostProcessed", "Program", "Row", "Run",
    "Scenario", "Setup", "Signals", "StoredRun", "Sweep", "SystemFailed", "__version__", "bode", "calibrate", "canon", "compare",
    "compensate", "identify", "load", "load_plugin", "open", "post", "run", "scenario_folder", "scenarios", "split", "strategy", "sweep",
]
