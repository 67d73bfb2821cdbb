#!/usr/bin/python3
"""Draws tests as their standards do, from what `servomill evaluate --json` prints, and `servomill run --json` of tests in a scenario.

    servomill evaluate axis.csv --standard iso230-2 --json > axis.json
    tools/standard_figures.py axis.json [-o FOLDER] [--force]

ISO 230-2: deviations over the targets, means of both directions with their 2 s, the ranges A, E, M beside them. ISO 230-4 and -7: polar
diagrams. ISO 230-6: parameters of the diagonals. ISO 10791-6: readings of each sensor over the angle, with their range. One PNG a test, named after it. Exit status: 0 written, 2 a file cannot be read or written.
"""
import argparse
import json
import os
import re
import sys

import numpy as np

from command_line import InputError, run
from figures import style
from figures.style import plt

TOOL = "standard_figures.py"
UP, DOWN, BOTH = style.BLUE, style.RED, style.BLACK
RANGES = (("A", BOTH), ("E", style.PURPLE), ("M", style.GREY))
RING = 0.55  # radius of the nominal circle in a polar diagram, of that of its frame


def numbers(values):
    return np.array([np.nan if value is None else value for value in values], dtype=float)


def table_of(report, name):
    """{column: numbers} of a table, or None."""
    for table in report["tables"]:
        if table["name"] == name:
            return {column["name"]: numbers(column["values"]) for column in table["columns"]}
    return None


def unit_of(values, is_angle):
    """Factor and name of the unit in which the largest of the values has one to three digits before the point."""
    largest = np.nanmax(np.abs(values), initial=0.0)
    small = largest < 1e-6
    if is_angle:
        return (1e-9, "nrad") if small else (1e-6, "urad")
    return (1e-9, "nm") if small else (1e-6, "um")


def parameters_of(report):
    return {one["parameter"]: one for one in report["parameters"]}


def number(value, scale, unit):
    return f"{value / scale:.1f} {unit}" if unit.startswith("n") else f"{value / scale:.2f} {unit}"


def draw_range(axes, place, low, high, text, colour):
    """A dimension line beside the diagram."""
    axes.annotate("", (place, low), (place, high), arrowprops={"arrowstyle": "<->", "color": colour, "shrinkA": 0, "shrinkB": 0})
    axes.text(place, high, text, ha="center", va="bottom", fontsize=8, color=colour)


def positioning(report):
    """Deviations over the targets, after figure 1 of ISO 230-2: means, 2 s, and the bi-directional ranges."""
    table = table_of(report, "target")
    found = parameters_of(report)
    is_angle = next(iter(found.values()))["unit"] == "rad"
    x = np.degrees(table["target"]) if is_angle else table["target"] / 1e-3
    bands = {name: (table[f"x_{name}"], 2.0 * np.nan_to_num(table[f"s_{name}"])) for name in ("up", "down")}
    edges = np.concatenate([mean + sign * half for mean, half in bands.values() for sign in (-1, 1)])
    scale, unit = unit_of(edges, is_angle)
    figure, axes = plt.subplots(figsize=(8.2, 4.6))
    for (name, (mean, half)), colour, line, marker in zip(bands.items(), (UP, DOWN), ("-", style.DASH), "^v"):
        if np.isnan(mean).all():
            continue
        arrow = "\N{UPWARDS ARROW}" if name == "up" else "\N{DOWNWARDS ARROW}"
        axes.plot(x, mean / scale, color=colour, linestyle=line, marker=marker, markersize=5, label=rf"mean {arrow}")
        for sign in (-1, 1):
            axes.plot(x, (mean + sign * half) / scale, color=colour, linestyle=style.DOT, linewidth=1.0,
                      label=rf"mean {arrow} $\pm$ 2 s" if sign > 0 else None)
        axes.fill_between(x, (mean - half) / scale, (mean + half) / scale, color=colour, alpha=0.08, linewidth=0)
    if not np.isnan(table["mean"]).all():
        axes.plot(x, table["mean"] / scale, color=BOTH, linestyle=style.DASH_DOT, linewidth=1.2, label="mean of both")
    draw_ranges(axes, x, table, bands, found, scale, unit)
    axes.axhline(0.0, color=style.GREY, linewidth=0.8, zorder=0)
    axes.set_xlabel("target, deg" if is_angle else "target, mm")
    axes.set_ylabel(f"deviation, {unit}")
    shown = [number_with_U(found[name], scale, unit) for name in ("B", "R", "M", "E", "A") if found[name]["value"] is not None]
    axes.set_title(f"{report['standard']}, {os.path.basename(report['name'])}\n" + "   ".join(shown), fontsize=9)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=5, fontsize=8, frameon=False)
    axes.margins(y=0.12)
    return figure


def number_with_U(one, scale, unit):
    text = f"{one['parameter']} {number(one['value'], scale, unit)}"
    return text if one["U"] is None else text + f" (U {number(one['U'], scale, unit)})"


def draw_ranges(axes, x, table, bands, found, scale, unit):
    """A, E and M as dimension lines at the right."""
    values = {
        "A": np.concatenate([mean + sign * half for mean, half in bands.values() for sign in (-1, 1)]),
        "E": np.concatenate([mean for mean, _ in bands.values()]),
        "M": table["mean"],
    }
    step = 0.06 * np.ptp(x)
    places = []
    for k, (name, colour) in enumerate(RANGES):
        if found[name]["value"] is None:
            continue
        places.append(x.max() + (len(places) + 1) * step)
        low, high = np.nanmin(values[name]) / scale, np.nanmax(values[name]) / scale
        draw_range(axes, places[-1], low, high, name, colour)
    if places:
        axes.set_xlim(x.min() - step, places[-1] + step)


def polar(report):
    """Radial errors, magnified, about the nominal circle: circular tests and error motions."""
    curves = [(table["name"].removeprefix("curve "), {column["name"]: numbers(column["values"]) for column in table["columns"]},
               table["columns"][1]["unit"]) for table in report["tables"] if table["name"].startswith("curve ")]
    if report["standard"] == "ISO 230-4":
        return polar_figure(report, [(curves, "")])
    return polar_figure(report, [([curve], curve[0]) for curve in curves])


def polar_figure(report, panels):
    columns = min(len(panels), 3)
    rows = -(-len(panels) // columns)
    figure, grid = plt.subplots(rows, columns, figsize=(5.0 * columns, 5.2 * rows), subplot_kw={"projection": "polar"}, squeeze=False)
    for axes in grid.flat[len(panels):]:
        axes.remove()
    for axes, (curves, title) in zip(grid.flat, panels):
        every = np.concatenate([list(table.values())[1] for _, table, _ in curves])
        scale, unit = unit_of(every, curves[0][2] == "rad")
        division = nice(np.abs(every).max() / scale / 2.0)
        magnified = (1.0 - RING) / max(np.abs(every).max() / scale, 1e-12) * 0.9
        for k, (name, table, _) in enumerate(curves):
            angle, dr = list(table.values())[:2]
            order = np.argsort(np.mod(angle, 2.0 * np.pi))
            theta, r = np.mod(angle, 2.0 * np.pi)[order], RING + dr[order] / scale * magnified
            axes.plot(np.append(theta, theta[0] + 2.0 * np.pi), np.append(r, r[0]), color=(UP, DOWN)[k % 2],
                      linestyle=("-", style.DASH)[k % 2], linewidth=1.3, label=name)
        for level in np.arange(-2, 3):
            radius = RING + level * division * magnified
            if 0.0 < radius <= 1.0:
                axes.plot(np.linspace(0.0, 2.0 * np.pi, 361), np.full(361, radius), color=style.BLACK if level == 0 else style.GREY,
                          linewidth=0.9 if level == 0 else 0.5, zorder=0)
        axes.set_ylim(0.0, 1.0)
        axes.set_yticks([])
        axes.grid(True, axis="x", linewidth=0.4)
        axes.set_title(f"{title}   {division:g} {unit} a division".strip(), fontsize=9)
        if len(curves) > 1:
            axes.legend(loc="lower center", bbox_to_anchor=(0.5, -0.16), ncols=2, fontsize=8, frameon=False)
    figure.suptitle(f"{report['standard']}, {os.path.basename(report['name'])}\n{results_line(report)}", fontsize=10)
    figure.tight_layout()
    return figure


def nice(value):
    """1, 2 or 5 times a power of ten, at most the value."""
    power = 10.0 ** np.floor(np.log10(max(value, 1e-12)))
    return max(step for step in (1.0, 2.0, 5.0) if step <= value / power + 1e-9) * power


def results_line(report):
    found = parameters_of(report)
    names = [name for name in ("G_ccw", "G_cw", "G_b", "D", "squareness") if name in found and found[name]["value"] is not None]
    shown = []
    for name in names:
        scale, unit = unit_of(np.array([found[name]["value"]]), found[name]["unit"] == "rad")
        shown.append(f"{name} {number(found[name]['value'], scale, unit)}")
    return "   ".join(shown)


def diagonals(report):
    """E, R, B, A of each diagonal."""
    table = next(one for one in report["tables"] if one["name"] == "diagonal")
    every = np.concatenate([numbers(column["values"]) for column in table["columns"]])
    scale, unit = unit_of(every, False)
    figure, axes = plt.subplots(figsize=(8.2, 4.2))
    shades = (style.PURPLE, style.BLUE, style.RED, style.BLACK, style.GREY)
    width = 0.8 / len(table["columns"])
    for k, (column, colour) in enumerate(zip(table["columns"], shades)):
        axes.bar(np.arange(len(table["rows"])) + (k - 2) * width, numbers(column["values"]) / scale, width, label=column["name"], color=colour)
    axes.set_xticks(range(len(table["rows"])), [os.path.basename(name) for name in table["rows"]], fontsize=8)
    axes.set_ylabel(unit)
    axes.set_title(f"{report['standard']}, {report['name']}", fontsize=9)
    axes.legend(ncols=5, fontsize=8, frameon=False)
    return figure


def sensors(report):
    """Readings of each sensor over the angle of the rotary axis, both directions, and their range."""
    curves = [(table["name"].removeprefix("curve "), table["columns"]) for table in report["tables"] if table["name"].startswith("curve ")]
    names = [column["name"] for column in curves[0][1][1:]]
    figure, grid = plt.subplots(len(names), 1, figsize=(7.6, 1.2 + 2.2 * len(names)), sharex=True, squeeze=False)
    found = parameters_of(report)
    for k, (name, axes) in enumerate(zip(names, grid.flat), 1):
        every = np.concatenate([numbers(columns[k]["values"]) for _, columns in curves])
        scale, unit = unit_of(every, False)
        for (direction, columns), colour, dash in zip(curves, (UP, DOWN), ("-", style.DASH)):
            place = numbers(columns[0]["values"])
            place = np.degrees(place) if columns[0]["unit"] == "rad" else place
            order = np.argsort(place, kind="stable")
            axes.plot(place[order], numbers(columns[k]["values"])[order] / scale, color=colour, linestyle=dash, linewidth=1.2, marker=".", markersize=4,
                      label=direction)
        axes.set_ylabel(f"{name}, {unit}")
        axes.set_title(f"range {number(found[name]['value'], scale, unit)}", fontsize=9, loc="right")
        axes.grid(True, linewidth=0.4)
    first = curves[0][1][0]
    grid.flat[-1].set_xlabel("angle, deg" if first["unit"] == "rad" else "reading")
    if len(curves) > 1:
        grid.flat[0].legend(ncols=2, fontsize=8, frameon=False)
    figure.suptitle(f"{report['standard']}, {os.path.basename(report['name'])}", fontsize=10)
    figure.tight_layout()
    return figure


DRAWN = {"ISO 10791-6": sensors, "ISO 230-2": positioning, "ISO 230-4": polar, "ISO 230-6": diagonals, "ISO 230-7": polar}


def read_reports(path):
    try:
        with open(path, encoding="utf-8") as file:
            reports = json.load(file)
        if not isinstance(reports, list):
            raise ValueError("is not a list of reports, as servomill evaluate --json prints it")
        for report in reports:
            if not isinstance(report, dict) or not {"standard", "name", "parameters", "tables"} <= set(report):
                raise ValueError("is not a report of servomill evaluate --json")
    except ValueError as error:
        raise InputError(f"{path}: error: {error}") from error
    if not reports:
        raise InputError(f"{path}: error: is empty; servomill evaluate --json prints one object per test")
    return reports


def file_name(report, taken):
    """A name of the test that no other test has."""
    stem = re.sub(r"[^A-Za-z0-9.-]+", "-", os.path.splitext(os.path.basename(report["name"]))[0]).strip("-") or "test"
    stem = f"{stem}-{report['standard'].lower().replace(' ', '')}"
    number_of_twin, name = 2, stem
    while name in taken:
        name, number_of_twin = f"{stem}-{number_of_twin}", number_of_twin + 1
    taken.add(name)
    return name + ".png"


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", metavar="REPORTS.json")
    parser.add_argument("-o", "--output", metavar="FOLDER", default=".", help="default: the current folder")
    parser.add_argument("-f", "--force", action="store_true", help="replaces figures that exist")
    options = parser.parse_args(arguments)
    reports = read_reports(options.file)
    os.makedirs(options.output, exist_ok=True)
    taken = set()
    for report in reports:
        if report["standard"] not in DRAWN:
            print(f"{TOOL}: {report['name']}: {report['standard']} has no figure", file=sys.stderr)
            continue
        path = os.path.join(options.output, file_name(report, taken))
        if os.path.exists(path) and not options.force:
            raise InputError(f"{TOOL}: error: {path} exists; use --force to overwrite")
        figure = DRAWN[report["standard"]](report)
        figure.savefig(path, dpi=style.DPI, bbox_inches="tight", metadata={"Software": None})
        plt.close(figure)
        print(f"written to {path}")
    return 0


if __name__ == "__main__":
    sys.exit(run(main, sys.argv[1:]))
