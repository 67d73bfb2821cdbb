"""What the tools share that draw one figure from one table in CSV."""
import argparse
import csv
import os
import pathlib

import matplotlib

from command_line import InputError

matplotlib.use("Agg")


def read_rows(tool, name, head, kind):
    """Rows of a table with exactly the columns of head; kind is what messages call it."""
    try:
        with open(name, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    except OSError as error:
        raise InputError(f"{tool}: error: {name}: {error.strerror}") from error
    if not rows or list(rows[0]) != head:
        raise InputError(f"{tool}: error: {name} is not a table of {kind}; expected the columns {', '.join(head)}")
    return rows


def draw_table(arguments, tool, description, figure_of):
    """Command line TABLE.csv [-o FIGURE.png] [--force]: figure_of(name of the table), saved."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table", metavar="TABLE.csv")
    parser.add_argument("-o", "--output", metavar="FIGURE.png")
    parser.add_argument("-f", "--force", action="store_true", help="replaces the figure if it exists")
    options = parser.parse_args(arguments)
    out = pathlib.Path(options.output or os.path.splitext(options.table)[0] + ".png")
    if out.exists() and not options.force:
        raise InputError(f"{tool}: error: {out} exists; use --force to overwrite")
    figure_of(options.table).savefig(out, dpi=110, metadata={"Software": None})
    print(f"written to {out}")
