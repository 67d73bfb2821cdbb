#!/usr/bin/python3
"""Draws stability lobes from the table that `servomill lobes -o` writes.

    tools/lobes_figure.py TABLE.csv [-o FIGURE.png] [--force]

Above: the limiting depth of cut over the speed of the spindle, flip lobes marked, dashed the closed form with mean directional
factors. Below: the chatter frequency at the limit. Exit status: 0 written, 2 a file cannot be read or written.
"""
import argparse
import csv
import math
import os
import sys

import matplotlib

from command_line import InputError, run

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

HEAD = ["speed_rpm", "limit_mm", "frequency_Hz", "kind", "zeroth_order_mm", "zeroth_order_frequency_Hz"]


def read_table(name):
    """Rows with numbers; where a cell is empty, there is no limit: nan."""
    try:
        with open(name, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    except OSError as error:
        raise InputError(f"lobes_figure.py: error: {name}: {error.strerror}") from error
    if not rows or list(rows[0]) != HEAD:
        raise InputError(f"lobes_figure.py: error: {name} is not a table of stability lobes; expected the columns {', '.join(HEAD)}")
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
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", metavar="TABLE.csv")
    parser.add_argument("-o", "--output", metavar="FIGURE.png")
    parser.add_argument("-f", "--force", action="store_true", help="replaces the figure if it exists")
    options = parser.parse_args(arguments)
    out = options.output or os.path.splitext(options.table)[0] + ".png"
    if os.path.exists(out) and not options.force:
        raise InputError(f"lobes_figure.py: error: {out} exists; use --force to overwrite")
    figure = draw(read_table(options.table))
    figure.savefig(out, dpi=110, metadata={"Software": None})
    print(f"written to {out}")


if __name__ == "__main__":
    sys.exit(run(main, sys.argv[1:]))
