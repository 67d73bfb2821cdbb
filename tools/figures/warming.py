"""A day of a machine that warms up: temperatures, drift of the tip, what heat does to each part."""
import numpy as np

from figures import style
from figures.results import NotInFile

SHOWN = 7   # bodies that are drawn: those whose temperature changes most
COLOURS = (style.BLUE, style.PURPLE, "#b2502f", "#2f7d55", "#8a6d1f", "#5a5a5a", "#b23a72")
SIDES = {"X": "-", "Y": "--", "Z": "-."}


def day_of(run):
    """Group of the first case that has a day, and its name."""
    for name, group in run.h5["cases"].items():
        if "day" in group:
            return name, group["day"]
    raise NotInFile("no case of the file has a day")


def draw(run):
    name, day = day_of(run)
    has_cycles = "cycles" in day
    heights = [1.2, 1.0] + ([0.7] if has_cycles else [])
    figure, strip, grid = style.panels(heights, (10.2, 2.2 + 2.5 * len(heights)))
    strip.axis("off")
    _temperatures(grid[0][0], day)
    drift = _drift(grid[1][0], day)
    if has_cycles:
        _cycles(grid[2][0], run)
    hours = day["time"][:]
    for row in grid:
        row[0].set_xlim(hours[0], hours[-1] * 1.14)   # room for the names at the ends of the curves
    grid[-1][0].set_xlabel("time, h")
    style.headline(figure, _message(day, drift))
    return figure


def _named_ends(ax, x, ends):
    """Writes the name of each curve at its end; names that would lie on each other are moved apart."""
    low, high = ax.get_ylim()
    gap, ends = 0.075 * (high - low), sorted(ends)
    places = []
    for y, _, _ in ends:
        places.append(max(y, places[-1] + gap) if places else y)
    above = high
    for n in reversed(range(len(places))):   # back below the upper edge
        places[n] = min(places[n], above)
        above = places[n] - gap
    for place, (_, text, colour) in zip(places, ends):
        ax.annotate(text, (x, place), xytext=(4, 0), textcoords="offset points", va="center", fontsize=9, color=colour)


def _temperatures(ax, day):
    hours = day["time"][:]
    courses = {key.removeprefix("temperature_"): day[key][:] for key in day if key.startswith("temperature_")}
    shown = sorted(courses, key=lambda body: -np.ptp(courses[body]))[:SHOWN]
    ends = []
    for body, colour in zip(shown, COLOURS):
        ax.plot(hours, courses[body], color=colour, linewidth=1.6)
        ends.append((courses[body][-1], body.replace("_", " "), colour))
    _named_ends(ax, hours[-1], ends)
    ax.set_ylabel("temperature, °C")
    rest = len(courses) - len(shown)
    ax.set_title("Temperatures" + (f" ({rest} bodies that change less are not shown)" if rest else ""))


def _drift(ax, day):
    """Draws all directions that drift; {place: {direction: drift}}."""
    hours, ends, found = day["time"][:], [], {}
    for (place, group), colour in zip(day["drift"].items(), COLOURS):
        for side, dashes in SIDES.items():
            drift = group[side][:]
            found.setdefault(place, {})[side] = drift
            if np.ptp(drift) < 0.05 or any(np.allclose(drift, other[side], atol=0.02)
                                           for before, other in found.items() if before != place):
                continue   # at rest, or as at a place before
            ax.plot(hours, drift, dashes, color=colour, linewidth=1.6)
            ends.append((drift[-1], f"{side} {place}", colour))
    ax.axhline(0.0, color=style.BLACK, linewidth=0.8)
    _named_ends(ax, hours[-1], ends)
    ax.set_ylabel("drift, µm")
    ax.set_title("Drift of the tip since the start (a direction that drifts as at a place before is left out)")
    return found


def _cycles(ax, run):
    """Each part of each case; datums of the first one are marked."""
    days = {name: group["day"] for name, group in run.h5["cases"].items() if "day" in group and "cycles" in group["day"]}
    ends = []
    for (name, day), colour in zip(days.items(), COLOURS):
        begin, largest = day["cycles/begin"][:], day["cycles/largest"][:]
        ax.plot(begin, largest, "o", color=colour, markersize=4)
        ends.append((largest[-1], name, colour))
    ax.set_ylim(bottom=0.0)
    first = next(iter(days.values()))
    if "datums" in first:
        ax.plot(first["datums/time"][:], np.zeros(len(first["datums/time"])), "|", color=style.BLACK, markersize=14, clip_on=False)
    if len(days) > 1:
        _named_ends(ax, first["time"][-1], ends)
    ax.set_ylabel("µm")
    ax.set_title("Each part: largest displacement by heat along its path, datum (|) taken off")


def _message(day, drift):
    place, side = max(((place, side) for place, sides in drift.items() for side in sides),
                      key=lambda at: np.ptp(drift[at[0]][at[1]]))
    return (f"Heat moves the tip by up to {np.ptp(drift[place][side]):.1f} µm in {side} "
            f"within {day['time'][-1]:.1f} h")
