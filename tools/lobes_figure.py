#!/usr/bin/python3
"""Draws stability lobes from the table that `servomill lobes -o` writes.

    tools/lobes_figure.py TABLE.csv [-o FIGURE.png] [--force]

Above: the limiting depth of cut over the speed of the spindle, flip lobes marked, dashed the closed form with mean directional
factors. Below: the chatter frequency at the limit. Exit status: 0 written, 2 a file cannot be read or written.
"""
import math
import sys

import matplotlib.pyplot as plt

from command_line import run
from table_figure import draw_table, read_rows

TOOL = "lobes_figure.py"
HEAD = ["speed_rpm", "limit_mm", "frequency_Hz", "kind", "zeroth_order_mm", "zeroth_order_frequency_Hz"]


def read_table(name):
    """Rows with numbers; where a cell is empty, there is no limit: nan."""
    rows = read_rows(TOOL, name, HEAD, "stability lobes")
    return [{key: text if key == "kind" else float(text) if text else math.nan for key, text in row.items()} for row in rows]


def draw(rows):
    speed = [row["speed_rpm"] for row in rows]
    limit = [row["limit_mm"] for row in rows]
    finite = [depth for depth in limit if not math.isnan(depth)]
    top = 1.1 * max(finite) if finite else 1.0
    figure, (depths, tones) = plt.subplots(2, 1, figsize=(8, 6), sharex=True, height_ratios=[2, 1], constrained_layout=True)
    unstable = [top if math.isnan(depth) else depth for depth in limit]
    depths.fill_between(speed, unstable, top, color="#d62728", alpha=0.15, lw=0)
    depths.plot(speed, limit, color="#1f77b4", label="limit")
    depths.plot(speed, [row["zeroth_order_mm"] for row in rows], color="#7f7f7f", ls="--", lw=1, label="mean directional factors")
    flips = [row for row in rows if row["kind"] == "flip"]
    if flips:
        depths.plot([row["speed_rpm"] for row in flips], [row["limit_mm"] for row in flips], "o", ms=4, color="#d62728", label="flip")
    depths.set_ylim(0.0, top)
    depths.set_ylabel("depth of cut [mm]")
    depths.text(0.99, 0.97, "chatter", transform=depths.transAxes, ha="right", va="top", color="#d62728")
    depths.text(0.99, 0.03, "stable", transform=depths.transAxes, ha="right", va="bottom")
    depths.legend(fontsize=8, loc="upper left")
    tones.plot(speed, [row["frequency_Hz"] for row in rows], ".", color="#1f77b4")
    tones.set_ylabel("chatter [Hz]")
    tones.set_xlabel("speed of the spindle [rpm]")
    return figure


def main(arguments):
    draw_table(arguments, TOOL, __doc__, lambda name: draw(read_table(name)))


if __name__ == "__main__":
    sys.exit(run(main, sys.argv[1:]))
