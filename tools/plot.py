#!/usr/bin/python3
"""Draws figures from the result files (HDF5) of `servomill run` and `servomill sweep`.

Figures are named after those of Guevel et al. 2025 that they answer to; `--list` prints all.
Exit status: 0 drawn, 2 the input is wrong, 3 the system failed.
"""
import argparse
import difflib
import pathlib
import sys

import numpy as np
from PIL import Image

from figures import style
from figures.catalogue import FIGURES
from figures.results import InputError, NotInFile, open_result

FORMATS = ("png", "svg", "pdf")
# no dates: the same results give the same bytes
METADATA = {"svg": {"Date": None}, "pdf": {"CreationDate": None, "ModDate": None}}
PALETTE = 64   # colours of a PNG


def chosen(text, allowed, what):
    """Splits "a,b" and refuses names that do not exist, with the nearest that does."""
    names = [name for name in text.split(",") if name]
    for name in names:
        if name not in allowed:
            near = difflib.get_close_matches(name, allowed, 1)
            hint = f"; did you mean {near[0]}?" if near else "; there are " + ", ".join(allowed)
            raise InputError(f"plot.py: error: no {what} is named {name}{hint}")
    if not names:
        raise InputError(f"plot.py: error: no {what} is named")
    return list(dict.fromkeys(names))


def save(drawn, path, ending):
    """Writes one figure; a PNG with a palette, a third of the size for the same picture."""
    if ending != "png":
        drawn.savefig(path, metadata=METADATA[ending])
        return
    drawn.canvas.draw()
    picture = Image.fromarray(np.asarray(drawn.canvas.buffer_rgba())[:, :, :3])
    picture = picture.quantize(PALETTE, dither=Image.Dither.NONE)
    picture.save(path, compress_level=9, dpi=(drawn.dpi, drawn.dpi))


def draw_all(result, named, formats, folder, force):
    """Draws what the file holds; returns the paths written."""
    wanted = [figure for figure in FIGURES if not named or figure.name in named]
    pages = []      # drawn first, written when nothing is wrong with any of them
    for case in result.cases.values() if result.kind == "run" else []:
        if not case.finished:
            print(f"case {case.name} stopped ({case.outcome}); it is drawn over time only",
                  file=sys.stderr)
    for figure in wanted:
        try:
            if figure.kind != result.kind:
                raise NotInFile(f"the file holds a {result.kind}, not a {figure.kind}")
            drawn = figure.draw(result)
        except NotInFile as missing:
            if named:
                raise InputError(f"{result.path}: error: {figure.name}: {missing}") from None
            print(f"{figure.name}: not drawn, {missing}", file=sys.stderr)
            continue
        for ending in formats:
            pages.append((folder / f"{result.path.stem}-{figure.name}.{ending}", drawn, ending))

    for path, _, _ in pages:
        if path.exists() and not force:
            raise InputError(f"{path}: error: exists; use --force to overwrite")
    for path, drawn, ending in pages:
        path.parent.mkdir(parents=True, exist_ok=True)
        save(drawn, path, ending)
    style.plt.close("all")
    return [path for path, _, _ in pages]


def main(arguments):
    reader = argparse.ArgumentParser(
        prog="plot.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    reader.add_argument("file", metavar="OUT.h5", nargs="?", help="result file")
    reader.add_argument("-o", metavar="DIR", default=".", help="folder to write to (default: here)")
    reader.add_argument("--format", metavar="png,svg,pdf", default="png", help="default: png")
    reader.add_argument("--figures", metavar="NAME,...", help="default: all that the file holds")
    reader.add_argument("--list", action="store_true", help="print the names of all figures")
    reader.add_argument("--force", action="store_true", help="overwrite existing figures")
    options = reader.parse_args(arguments)

    if options.list:
        for figure in FIGURES:
            print(f"{figure.name:<12}{figure.kind:<7}{figure.help}")
        return 0
    if options.file is None:
        raise InputError("plot.py: error: no result file is named; see plot.py --help")
    formats = chosen(options.format, FORMATS, "format")
    named = options.figures and chosen(options.figures, [f.name for f in FIGURES], "figure")
    style.set_up()
    with open_result(options.file) as result:
        written = draw_all(result, named, formats, pathlib.Path(options.o), options.force)
    for path in written:
        print(path)
    if not written:
        raise InputError(f"{options.file}: error: holds nothing that can be drawn")
    return 0


def run(arguments):
    """main with faults turned into one line on standard error and an exit status."""
    try:
        return main(arguments)
    except InputError as fault:
        print(fault, file=sys.stderr)
        return 2
    except OSError as fault:
        print(f"plot.py: error: {fault}", file=sys.stderr)
        return 3


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:]))
