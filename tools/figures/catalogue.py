"""All figures, by name."""
import dataclasses
from typing import Callable

from figures import (balls, bode, budget, circular, compensated, deviations, error_functions, experiment2, five_axis, inertia, lag,
                     nonlinear, notches, parts, step, straightness, sweeps, volumetric, warming)


@dataclasses.dataclass(frozen=True)
class Figure:
    name: str
    kind: str          # of the file: one of results.KINDS
    help: str
    draw: Callable     # draw(what results.open_result gives) -> matplotlib figure; NotInFile where it cannot


FIGURES = (
    Figure("figure6", "run", "imposed error functions of X",
           lambda run: error_functions.draw(run, "X")),
    Figure("figure9", "run", "Y along X (section flank): trajectory, residual, enlarged",
           lambda run: straightness.draw(run, "Y", "flank")),
    Figure("figure10", "run", "Z along X (section plane): trajectory, residual, enlarged",
           lambda run: straightness.draw(run, "Z", "plane")),
    Figure("figure11", "run", "X of the notches (section notch): position, residual, enlarged",
           notches.draw),
    Figure("figure12", "run", "imposed error functions of Z",
           lambda run: error_functions.draw(run, "Z")),
    Figure("figure14", "run", "contours of nominal, generated, compensated; differences",
           volumetric.draw_contours),
    Figure("figure15", "run", "top plane of nominal, generated, compensated; differences",
           volumetric.draw_plane),
    Figure("figure16", "run", "Z of the circle in air and while cutting, at the scale and at the tool",
           experiment2.draw_air_and_cutting),
    Figure("figure17", "run", "top plane: trajectory, probed points, least-squares planes", experiment2.draw_top_plane),
    Figure("figure18", "run", "three parts from above: distances to the nominal one after best fit", experiment2.draw_quivers),
    Figure("figure19", "run", "three parts superposed, distances magnified", experiment2.draw_superposed),
    Figure("probed", "run", "probed features: deviations along them with bars, against the imposed curve", parts.draw_deviations),
    Figure("part", "run", "probed part from above: deviations magnified", parts.draw_plan),
    Figure("planes", "run", "probed planes: maps of the deviations", parts.draw_planes),
    Figure("lag", "sweep", "residual and response time against feed", lag.draw),
    Figure("curves", "sweep", "quantities over one parameter, a line for each case", sweeps.draw_curves),
    Figure("maps", "sweep", "quantities over two parameters, in colours", sweeps.draw_maps),
    Figure("samples", "sweep", "quantities over sampled parameters and how they are distributed", sweeps.draw_samples),
    Figure("circular", "run", "circular test: radial deviation as a ball bar shows it", circular.draw),
    Figure("reversals", "run", "circular test: where the axes reverse", circular.draw_reversals),
    Figure("nest", "run", "R-test: displacement of the ball in the sensor nest", balls.draw_nest),
    Figure("ball_bar", "run", "BK4: length of a ball bar around a five-axis circle", balls.draw_bar),
    Figure("li_3_2", "run", "one segment: how the nonlinear error of rotary axes is distributed",
           nonlinear.draw_distribution),
    Figure("li_3_3", "run", "one segment: path in the machine, error before and after", nonlinear.draw_segment),
    Figure("li_4_1", "run", "several segments: path in the machine, enlarged, errors along it",
           nonlinear.draw_way),
    Figure("five_axis", "run", "five axes: plan view with deviations, tip and tool axis along the path",
           five_axis.draw),
    Figure("deviations", "run", "following error, tool deviation and contour error over time",
           deviations.draw),
    Figure("inertia", "run", "circle or corner: what the structure does under acceleration and no scale shows", inertia.draw),
    Figure("day", "run", "a day of a machine that warms up: temperatures, drift, each part", warming.draw),
    Figure("position", "bode", "position loop over frequency: open, closed, with feed-forward",
           lambda responses: bode.draw(responses, "position")),
    Figure("velocity", "bode", "velocity loop over frequency: open, closed",
           lambda responses: bode.draw(responses, "velocity")),
    Figure("compliance", "bode", "slide per force over frequency",
           lambda responses: bode.draw(responses, "compliance")),
    Figure("compensated", "compensate", "compensated program: path and correction magnified, correction along it",
           compensated.draw),
    Figure("budget", "budget", "error budgets: what each cause has of the residuals", budget.draw),
    Figure("step", "step", "step responses of position, velocity and load", step.draw),
)
