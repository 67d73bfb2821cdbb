"""Step responses of axes: setpoint, velocity command, load."""
import numpy as np

from figures import style

KINDS = ("position", "velocity", "load")
LOOK = style.Look("slide", style.BLUE)
MOTOR = style.Look("motor, as slide velocity", style.PURPLE)
UM = {"mm": ("µm", 1e3), "deg": ("µrad", np.pi / 180.0 * 1e6)}


def draw(responses):
    """Rows are axes, columns kinds of steps."""
    letters = list(responses.axes)
    kinds = [kind for kind in KINDS if any(kind in group for group in responses.axes.values())]
    figure, strip, grid = style.panels([1.0] * len(letters),
                                       (max(6.0, 4.2 * len(kinds)), 0.9 + 3.4 * len(letters)),
                                       columns=len(kinds))
    style.legend(strip, [LOOK, MOTOR] if "velocity" in kinds else [LOOK])
    for row, letter in enumerate(letters):
        for column, kind in enumerate(kinds):
            ax = grid[row][column]
            if kind not in responses.axes[letter]:
                ax.axis("off")
                continue
            _panel(ax, letter, kind, responses.axes[letter][kind],
                   responses.transmission(letter))
            if row == len(letters) - 1:
                ax.set_xlabel("time, ms")
    style.headline(figure, _message(responses, letters))
    return figure


def _panel(ax, letter, kind, step, transmission):
    found = step.attrs
    t = step["time"][:] * 1e3
    length = str(step["position"].attrs["units"])
    amplitude, band = float(found["amplitude"]), float(found["band"])
    if kind == "velocity":
        y, unit = step["velocity"][:], f"{length}/s"
        if transmission is not None:
            ax.plot(t, step["motor_speed"][:] * transmission, color=MOTOR.colour,
                    linewidth=MOTOR.width)
    else:
        unit, factor = UM[length]
        y = step["position"][:] * factor
    ax.plot(t, y, color=LOOK.colour, linewidth=LOOK.width)
    if kind == "load":
        peak = float(found["peak"]) * UM[length][1]
        _note(ax, float(found["peak_time_s"]) * 1e3, peak, f"{peak:.3g} {unit}")
        ax.set_title(f"{letter}: load of {amplitude:g} {found['amplitude_units']}")
    else:
        target = amplitude * (UM[length][1] if kind == "position" else 1.0)
        ax.axhspan(target * (1.0 - band), target * (1.0 + band), color=style.PALE, zorder=0)
        ax.axhline(target, color=style.BLACK, linewidth=0.8)
        over = 100.0 * float(found["overshoot"])
        if over > 0.05:
            _note(ax, float(found["peak_time_s"]) * 1e3, target * (1.0 + over / 100.0),
                  f"{over:.1f} % over")
        units = str(found["amplitude_units"]).replace(" s-1", "/s")
        ax.set_title(f"{letter}: {kind} step of {amplitude:g} {units}")
    settled = float(found["settling_time_s"]) * 1e3
    if np.isfinite(settled) and settled > 0.0:
        ax.axvline(settled, color=style.GREY, linewidth=0.9, linestyle=style.DOT)
        ax.text(settled, ax.get_ylim()[0], f" settled {settled:.0f} ms", color=style.GREY,
                fontsize=9.5, va="bottom")
        ax.set_xlim(0.0, min(t[-1], 1.9 * settled))
    ax.set_ylabel(unit)


def _note(ax, x, y, text):
    ax.plot([x], [y], "o", color=style.BLACK, markersize=4)
    ax.annotate(text, (x, y), (6, 4), textcoords="offset points", fontsize=10)
    low, high = ax.get_ylim()
    ax.set_ylim(low, max(high, y + 0.1 * (high - low)))


def _message(responses, letters):
    parts = []
    for letter in letters:
        group = responses.axes[letter]
        said = []
        if "position" in group:
            over = 100.0 * float(group["position"].attrs["overshoot"])
            said.append(f"{over:.1f} % over" if over > 0.05 else "no overshoot")
        if "load" in group:
            length = str(group["load"]["position"].attrs["units"])
            unit, factor = UM[length]
            peak = float(group["load"].attrs["peak"]) * factor
            said.append(f"{peak:.3g} {unit} under load" if peak else "holds the load")
        parts.append(f"{letter} " + ", ".join(said))
    return "Step responses: " + "; ".join(parts)
