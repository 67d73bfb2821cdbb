"""Frequency responses of axes: magnitude and phase, exact as lines, measured as dots."""
import numpy as np

from figures import style
from figures.results import NotInFile

LOOKS = {
    "position_open": style.Look("open loop", style.BLUE),
    "position_closed": style.Look("closed loop", style.PURPLE, "-", "s"),
    "position_fed_forward": style.Look("closed loop with feed-forward", style.RED, style.DASH_DOT,
                                       "D"),
    "velocity_open": style.Look("open loop", style.BLUE),
    "velocity_closed": style.Look("closed loop", style.PURPLE, "-", "s"),
    "compliance": style.Look("slide per force", style.BLUE),
}
LOWEST_DB = -80.0     # below, readings are steps of the encoder
DECADES = 4.0         # of a compliance


def draw(responses, loop):
    """Columns are axes; rows magnitude and phase."""
    axes = [letter for letter in responses.axes if f"{loop}_loop" in responses.axes[letter]]
    if not axes:
        raise NotInFile(f"the file has no {loop} loop")
    figure, strip, grid = style.panels([1.15, 1.0], (max(6.6, 5.1 * len(axes)), 6.4),
                                       columns=len(axes))
    curves = [name for name in LOOKS if name.startswith(loop)]
    style.legend(strip, [LOOKS[name] for name in curves], points=True)
    for column, letter in enumerate(axes):
        group = responses.axes[letter]
        above, below = grid[0][column], grid[1][column]
        for name in curves:
            _curve(above, below, group[name], LOOKS[name], loop)
        if loop == "compliance":
            _compliance(above, group)
        else:
            _margins(above, below, group[f"{loop}_loop"].attrs, group[f"{loop}_open"])
        dots = any("measured_frequency" in group[name] for name in curves)
        above.set_title(f"Axis {letter}" + (" (line: exact, dots: measured)" if dots else ""))
        for ax in (above, below):
            ax.set_xscale("log")
            ax.set_xlim(*_range(group[curves[0]]))
        above.tick_params(labelbottom=False)
        below.set_xlabel("frequency, Hz")
        below.yaxis.set_major_locator(style.plt.MultipleLocator(90))
        if loop == "compliance":
            above.set_ylabel(f"compliance, {responses.unit(letter, 'compliance')}")
        elif column == 0:
            above.set_ylabel("magnitude, dB")
    grid[1][0].set_ylabel("phase, deg")
    style.headline(figure, _message(responses, axes, loop))
    return figure


def _range(curve):
    f = curve["frequency"][:]
    return f[0], f[-1]


def _shown(magnitude, loop):
    with np.errstate(divide="ignore"):
        return magnitude if loop == "compliance" else 20.0 * np.log10(magnitude)


def _curve(above, below, curve, look, loop):
    f, phase = curve["frequency"][:], curve["phase"][:]
    phase = phase - 360.0 * np.round(phase[0] / 360.0)
    magnitude = curve["magnitude"][:]
    seen = magnitude > _floor(magnitude, loop)
    style.line(above, f, _shown(magnitude, loop), look)
    style.line(below, np.where(seen, f, np.nan), phase, look)
    if loop == "compliance":
        above.set_yscale("log")
        above.set_ylim(bottom=_floor(magnitude, loop))
    else:
        above.set_ylim(bottom=max(LOWEST_DB, above.get_ylim()[0]))
    if "measured_frequency" not in curve:
        return
    f_dots, size, angle = (curve["measured_" + name][:]
                           for name in ("frequency", "magnitude", "phase"))
    # the same turn of the circle as the line
    angle = angle + 360.0 * np.round((np.interp(f_dots, f, phase) - angle) / 360.0)
    dots = {"linestyle": "none", "marker": look.marker, "markersize": 4.5, "color": look.colour}
    known = size > _floor(magnitude, loop)
    above.plot(f_dots[known], _shown(size[known], loop), **dots)
    below.plot(f_dots[known], angle[known], **dots)


def _floor(magnitude, loop):
    return magnitude.max() / 10.0 ** DECADES if loop == "compliance" else 10.0 ** (LOWEST_DB / 20.0)


def _margins(above, below, loop, open_curve):
    """Gain margin in the upper, phase margin in the lower panel, as arrows with their numbers."""
    f, phase = open_curve["frequency"][:], open_curve["phase"][:]
    phase = phase - 360.0 * np.round(phase[0] / 360.0)
    above.axhline(0.0, color=style.BLACK, linewidth=0.8)
    if not int(loop["stable"]):
        return
    arrow = {"arrowstyle": "<->", "color": style.BLACK, "linewidth": 1.2, "shrinkA": 0,
             "shrinkB": 0}
    text = {"fontsize": 10, "bbox": {"facecolor": "white", "edgecolor": "none", "alpha": 0.7,
                                     "pad": 1.0}}
    at, margin = float(loop["gain_margin_Hz"]), float(loop["gain_margin"])
    if np.isfinite(margin) and f[0] < at < f[-1]:
        dB = 20.0 * np.log10(margin)
        above.annotate("", (at, 0.0), (at, -dB), arrowprops=arrow)
        above.text(at * 1.1, -dB / 2.0, f"{dB:.1f} dB\nat {at:.3g} Hz", va="center", **text)
    at, margin = float(loop["crossover_Hz"]), float(loop["phase_margin_deg"])
    if np.isfinite(margin) and f[0] < at < f[-1]:
        here = np.interp(at, f, phase)
        foot = here - margin
        below.plot([at * 0.6, at * 1.6], [foot, foot], color=style.BLACK, linewidth=0.8)
        below.annotate("", (at, here), (at, foot), arrowprops=arrow)
        below.text(at, foot - 12.0, f"{margin:.1f}° at {at:.3g} Hz", ha="center", va="top", **text)


def _compliance(above, group):
    loop = group["compliance_loop"].attrs
    at, peak = float(loop["peak_Hz"]), float(loop["peak"])
    f = group["compliance"]["frequency"][:]
    if f[0] < at < f[-1]:
        above.annotate(f"{peak:.3g} at {at:.3g} Hz", (at, peak), (at * 2.2, peak * 1.05),
                       arrowprops={"arrowstyle": "-", "linewidth": 0.8}, fontsize=10, va="center")


def _message(responses, axes, loop):
    parts = []
    for letter in axes:
        found = responses.axes[letter][f"{loop}_loop"].attrs
        if not int(found["stable"]):
            parts.append(f"{letter} is unstable")
        elif loop == "compliance":
            unit = responses.unit(letter, "compliance")
            parts.append(f"{letter} gives way by {float(found['peak']):.3g} {unit} at most")
        else:
            parts.append(f"{letter} has {float(found['phase_margin_deg']):.0f}° and "
                         f"{20.0 * np.log10(float(found['gain_margin'])):.0f} dB of margin")
    what = {"position": "Position loop", "velocity": "Velocity loop", "compliance": "Compliance"}
    return f"{what[loop]}: " + ", ".join(parts)
