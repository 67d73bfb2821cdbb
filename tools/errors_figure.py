#!/usr/bin/python3
"""Draws the errors of a calibration along the travel with their uncertainty, from the table that `servomill calibrate --table` writes.

    tools/errors_figure.py TABLE.csv [-o FIGURE.png] [--force]

A row of panels for each axis; the band is the expanded uncertainty (k = 2). Errors that the readings hold only in combination are
drawn in grey. Location errors stand in the title of their axis. Exit status: 0 written, 2 a file cannot be read or written.
"""
import argparse
import csv
import os
import sys

import matplotlib

from command_line import InputError, run

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

HEAD = ["error", "position", "position_unit", "value", "standard_uncertainty", "unit", "in_combination"]
DIRECTIONS = "XYZABC"


def read_table(name):
    """Functions as lists of rows by name, location errors as one row each."""
    try:
        with open(name, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    except OSError as error:
        raise InputError(f"errors_figure.py: error: {name}: {error.strerror}") from error
    if not rows or list(rows[0]) != HEAD:
        raise InputError(f"errors_figure.py: error: {name} is not a table of errors; expected the columns {', '.join(HEAD)}")
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
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", metavar="TABLE.csv")
    parser.add_argument("-o", "--output", metavar="FIGURE.png")
    parser.add_argument("-f", "--force", action="store_true", help="replaces the figure if it exists")
    options = parser.parse_args(arguments)
    out = options.output or os.path.splitext(options.table)[0] + ".png"
    if os.path.exists(out) and not options.force:
        raise InputError(f"errors_figure.py: error: {out} exists; use --force to overwrite")
    functions, locations = read_table(options.table)
    figure = draw(functions, locations)
    figure.savefig(out, dpi=110, metadata={"Software": None})
    print(f"written to {out}")


if __name__ == "__main__":
    sys.exit(run(main, sys.argv[1:]))
