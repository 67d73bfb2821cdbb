#!/usr/bin/python3
"""Draws the errors of a calibration along the travel with their uncertainty, from the table that `servomill calibrate --table` writes.

    tools/errors_figure.py TABLE.csv [-o FIGURE.png] [--force]

A row of panels for each axis; the band is the expanded uncertainty (k = 2). Errors that the readings hold only in combination are
drawn in grey. Location errors stand in the title of their axis. Exit status: 0 written, 2 a file cannot be read or written.
"""
import sys

import matplotlib.pyplot as plt

from command_line import run
from table_figure import draw_table, read_rows

TOOL = "errors_figure.py"
HEAD = ["error", "position", "position_unit", "value", "standard_uncertainty", "unit", "in_combination"]
DIRECTIONS = "XYZABC"


def read_table(name):
    """Functions as lists of rows by name, location errors as one row each."""
    rows = read_rows(TOOL, name, HEAD, "errors")
    functions, locations = {}, {}
    for row in rows:
        if row["position"]:
            functions.setdefault(row["error"], []).append(row)
        else:
            locations[row["error"]] = row
    return functions, locations


def draw_function(panel, name, rows):
    s, value, sigma = ([float(row[key]) for row in rows] for key in ("position", "value", "standard_uncertainty"))
    colour = "#7f7f7f" if rows[0]["in_combination"] == "1" else "#1f77b4"
    panel.fill_between(s, [v - 2 * u for v, u in zip(value, sigma)], [v + 2 * u for v, u in zip(value, sigma)], color=colour, alpha=0.25, lw=0)
    panel.plot(s, value, color=colour)
    panel.axhline(0.0, color="#cccccc", lw=0.8, zorder=0)
    panel.set_title(f"{name} [{rows[0]['unit']}]", fontsize=9)
    panel.tick_params(labelsize=7)


def location_text(axis, locations):
    """"EC0Y 180 +- 7 urad", those of one axis."""
    return ", ".join(f"{name} {float(row['value']):.3g} ± {2 * float(row['standard_uncertainty']):.2g} {row['unit']}"
                     for name, row in locations.items() if name.endswith(axis))


def draw(functions, locations):
    axes = [axis for axis in DIRECTIONS if any(name.endswith(axis) for name in (*functions, *locations))]
    figure, panels = plt.subplots(len(axes), 6, figsize=(15, 2.4 * len(axes)), squeeze=False, constrained_layout={"h_pad": 0.12})
    for line, axis in zip(panels, axes):
        for panel, direction in zip(line, DIRECTIONS):
            rows = functions.get(f"E{direction}{axis}")
            if rows:
                draw_function(panel, f"E{direction}{axis}", rows)
                panel.set_xlabel(f"{axis} [{rows[0]['position_unit']}]", fontsize=8)
            else:
                panel.set_axis_off()
        text = location_text(axis, locations)
        if text:
            line[0].annotate(text, (0.0, 1.25), xycoords="axes fraction", fontsize=9, fontweight="bold").set_in_layout(False)
    return figure


def main(arguments):
    draw_table(arguments, TOOL, __doc__, lambda name: draw(*read_table(name)))


if __name__ == "__main__":
    sys.exit(run(main, sys.argv[1:]))
