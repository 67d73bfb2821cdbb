#!/usr/bin/python3
"""Draws figures from the result files (HDF5) of `servomill run`, `sweep`, `bode` and
`step`.

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


def draw_all(path, named):
    """Draws what one file holds: {figure name: figure}, {figure name: why it is not drawn}."""
    drawn, missing = {}, {}
    with open_result(path) as result:
        for case in result.cases.values() if result.kind == "run" else []:
            if not case.finished:
                print(f"case {case.name} stopped ({case.outcome}); it is drawn over time only",
                      file=sys.stderr)
        for figure in FIGURES:
            if named and figure.name not in named:
                continue
            if not named and figure.kind != result.kind:
                continue   # nobody expects motion in a frequency response, or a sweep in a run
            try:
                if figure.kind != result.kind:
                    raise NotInFile(f"the file holds a {result.kind}, not a {figure.kind}")
                drawn[figure.name] = figure.draw(result)
            except NotInFile as reason:
                missing[figure.name] = f"{reason}"
    return drawn, missing


def pages_of(files, named):
    """All figures of all files as (stem of the file name, figure). A figure that is asked for by
    name must be held by at least one file; others are explained where they are not drawn."""
    pages, found = [], set()
    for file in files:
        drawn, missing = draw_all(file, named)
        found |= drawn.keys()
        pages += [(f"{pathlib.Path(file).stem}-{name}", figure) for name, figure in drawn.items()]
        for name, reason in missing.items():
            if not named:
                where = f"{file}: " if len(files) > 1 else ""
                print(f"{where}{name}: not drawn, {reason}", file=sys.stderr)
        if not named and not drawn:
            raise InputError(f"{file}: error: holds nothing that can be drawn")
    for name in named or []:
        if name not in found:
            raise InputError(f"{file}: error: {name}: {missing[name]}")
    return pages


def main(arguments):
    reader = argparse.ArgumentParser(
        prog="plot.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    reader.add_argument("files", metavar="OUT.h5", nargs="*", help="result files")
    reader.add_argument("-o", metavar="DIR", default=".", help="folder to write to (default: here)")
    reader.add_argument("--format", metavar="png,svg,pdf", default="png", help="default: png")
    reader.add_argument("--figures", metavar="NAME,...", help="default: all that the files hold")
    reader.add_argument("--list", action="store_true", help="print the names of all figures")
    reader.add_argument("--force", action="store_true", help="overwrite existing figures")
    options = reader.parse_args(arguments)

    if options.list:
        for figure in FIGURES:
            print(f"{figure.name:<12}{figure.kind:<7}{figure.help}")
        return 0
    if not options.files:
        raise InputError("plot.py: error: no result file is named; see plot.py --help")
    stems = [pathlib.Path(file).stem for file in options.files]
    for stem in stems:
        if stems.count(stem) > 1:
            raise InputError(f"plot.py: error: two files are named {stem}; draw them apart")
    formats = chosen(options.format, FORMATS, "format")
    named = options.figures and chosen(options.figures, [f.name for f in FIGURES], "figure")

    # everything is drawn before anything is written
    style.set_up()
    folder = pathlib.Path(options.o)
    pages = [(folder / f"{name}.{ending}", figure, ending)
             for name, figure in pages_of(options.files, named) for ending in formats]
    for path, _, _ in pages:
        if path.exists() and not options.force:
            raise InputError(f"{path}: error: exists; use --force to overwrite")
    folder.mkdir(parents=True, exist_ok=True)
    for path, figure, ending in pages:
        save(figure, path, ending)
        print(path)
    style.plt.close("all")
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
