#!/usr/bin/python3
"""Draws figures from the result files (HDF5) of `servomill run`, `sweep`, `bode`,
`step` and `budget`, and the records of `compensate`.

Figures are named after those of Guevel et al. 2025 that they answer to; `--list` prints all.
What a file holds is drawn; why a figure is not is said of those in `--figures`, of all with `--why`. Exit status:
0 drawn, 2 a file cannot be read or nothing can be drawn, 3 the system failed.
"""
import argparse
import contextlib
import dataclasses
import difflib
import mmap
import os
import pathlib
import signal
import sys

if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.SIG_DFL)   # without a traceback, as soon as the imports below

import numpy as np
from PIL import Image

from command_line import InputError, run
from figures import names as naming
from figures import style
from figures.catalogue import FIGURES
from figures.results import NotInFile, open_result

FORMATS = ("png", "svg", "pdf")
PICTURES = ("jpg", "jpeg", "gif", "tif", "tiff", "bmp", "webp", "eps", "ps")   # endings of pictures that are not drawn
# no dates: the same results give the same bytes
METADATA = {"svg": {"Date": None}, "pdf": {"CreationDate": None, "ModDate": None}}
PALETTE = 256  # colours of a PNG


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
    # by coverage rare colours, as of a few marks or of a bar of colours, stay what they are; refined, common ones, too
    picture = picture.quantize(PALETTE, method=Image.Quantize.MAXCOVERAGE, kmeans=1, dither=Image.Dither.NONE)
    picture.save(path, compress_level=9, dpi=(drawn.dpi, drawn.dpi))


@dataclasses.dataclass(frozen=True)
class NotDrawn:
    figure: object          # of FIGURES
    reason: str
    failed: bool = False    # the file holds what it needs, and yet


def draw_all(result, named):
    """Draws what one file holds: {figure: drawn}, [NotDrawn]."""
    drawn, missing = {}, []
    for case in result.cases.values() if result.kind == "run" else []:
        if not case.finished:
            print(f"case {case.name} stopped ({case.outcome}); it is drawn over time only", file=sys.stderr)
    for figure in FIGURES:
        if named and figure.name not in named:
            continue
        if not named and figure.kind != result.kind:
            continue   # nobody expects motion in a frequency response, or a sweep in a run
        try:
            if figure.kind != result.kind:
                raise NotInFile(f"the file contains a {result.kind}, not a {figure.kind}")
            drawn[figure] = figure.draw(result)
        except NotInFile as reason:
            missing.append(NotDrawn(figure, f"{reason}"))
        except Exception as fault:   # one that fails must not cost the others
            missing.append(NotDrawn(figure, failure(fault), failed=True))
    return drawn, missing


def failure(fault):
    return f"drawing it failed ({type(fault).__name__}: {' '.join(str(fault).split())})"


reading = mmap.mmap(-1, mmap.PAGESIZE)   # name of the file that is being read; shared with the process that waits


def begin_reading(file):
    name = os.fsencode(str(file))[:len(reading) - 1]
    reading[:len(name) + 1] = name + b"\0"


def pages_of(files, named, why, names):
    """All figures of all files as (stem of the file name, figure), and whether a file could not be read. What is not
    drawn is reported, unless another kind of file was meant. InputError: nothing can be drawn."""
    pages, found, missing, unread = [], set(), [], []
    for file in files:
        begin_reading(file)
        try:
            with open_result(file) as result:
                result.names = names
                drawn, lost = draw_all(result, named)
                missing.append((file, result.kind, lost))
        except InputError as fault:
            unread.append(str(fault))
            continue
        found |= drawn.keys()
        pages += [(f"{pathlib.Path(file).stem}-{figure.name}", picture) for figure, picture in drawn.items()]
        if not named and not drawn:
            unread.append(f"{file}: error: contains nothing that can be drawn")
    if named and not pages:
        unread += [f"{file}: error: {one.figure.name}: {one.reason}" for file, _, lost in missing for one in lost]
    else:
        for file, kind, lost in missing:
            lost = [one for one in lost if one.figure.kind == kind or one.figure not in found]
            tell_not_drawn(f"{file}: " if len(files) > 1 else "", lost, bool(named) or why)
    if not pages:
        raise InputError("\n".join(unread))
    for line in unread:
        print(line, file=sys.stderr)
    return pages, bool(unread)


def tell_not_drawn(where, lost, why):
    """Says why each is not drawn; else only how many there are, and why of those that failed."""
    for one in lost:
        if why or one.failed:
            print(f"{where}{one.figure.name}: not drawn, {one.reason}", file=sys.stderr)
    others = sum(not one.failed for one in lost)
    if others and not why:
        print(f"{where}{others} figure{'s' if others > 1 else ''} skipped: the file lacks {'their' if others > 1 else 'its'} data (--why)",
              file=sys.stderr)


def ending_of(path):
    """"png" of "a/b.PNG"; "" of a folder."""
    return "" if path.is_dir() else path.suffix.lower().removeprefix(".")


def formats_of(text, target):
    """Formats to write, from --format and what -o ends in. InputError: they differ, or -o is no place for figures."""
    ending = ending_of(target)
    formats = chosen(text, FORMATS, "format") if text else [ending if ending in FORMATS else "png"]
    if ending in FORMATS and formats != [ending]:
        raise InputError(f"{target}: error: ends in .{ending}, but --format is {','.join(formats)}")
    if ending in PICTURES:
        raise InputError(f"{target}: error: figures are written as " + ", ".join(FORMATS))
    if ending and ending not in FORMATS and not target.exists():
        raise InputError(f"{target}: error: .{ending} is not a figure format; must be one of " + ", ".join(FORMATS) +
                         "; make a folder of that name first")
    if ending not in FORMATS and target.exists() and not target.is_dir():
        raise InputError(f"{target}: error: is a file; figures go into a folder, or into a file that ends in ." +
                         ", .".join(FORMATS))
    return formats


def paths_of(drawn, target, formats):
    """[(path, figure, format)]: files of a folder, or the one that -o names. InputError: that is to hold several."""
    if ending_of(target) not in FORMATS:
        return [(target / f"{name}.{ending}", figure, ending) for name, figure in drawn for ending in formats]
    if len(drawn) > 1:
        raise InputError(f"{target}: error: takes one figure, not {len(drawn)} ({', '.join(name for name, _ in drawn)}); "
                         "name one with --figures, or a folder with -o")
    return [(target, figure, formats[0]) for _, figure in drawn]


def refuse_unwritable(path, inputs, force):
    """InputError: a folder, a file that is read, or one that exists without --force."""
    if path.is_dir():
        raise InputError(f"{path}: error: is a folder")
    if path.exists() and any(pathlib.Path(file).exists() and path.samefile(file) for file in inputs):
        raise InputError(f"{path}: error: is an input of this command")
    if path.exists() and not force:
        raise InputError(f"{path}: error: exists; use --force to overwrite")


def main(arguments):
    reader = argparse.ArgumentParser(
        prog="plot.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    reader.add_argument("files", metavar="OUT.h5", nargs="*", help="result files")
    reader.add_argument("-o", metavar="OUT", default=".",
                        help="folder to write to (default: here), or for one figure a file .png, .svg or .pdf")
    reader.add_argument("--format", metavar="png,svg,pdf", help="default: png, or as the file of -o ends")
    reader.add_argument("--figures", metavar="NAME,...", help="default: all that the files hold")
    reader.add_argument("--section", metavar="NAME=YOURS", action="append",
                        help="section or probed feature to draw for that of the paper's figures: " + ", ".join(naming.SECTIONS))
    reader.add_argument("--case", metavar="NAME=YOURS", action="append",
                        help="case to draw for that of the paper's figures: " + ", ".join(naming.CASES))
    reader.add_argument("--why", action="store_true", help="give the reason for every skipped figure")
    reader.add_argument("--list", action="store_true", help="print the names of all figures")
    reader.add_argument("--force", action="store_true", help="overwrite existing figures")
    options = reader.parse_args(arguments)

    if options.list:
        for figure in FIGURES:
            print(f"{figure.name:<12}{figure.kind:<11}{figure.help}")
        return 0
    if not options.files:
        raise InputError("plot.py: error: expected at least one result file; see plot.py --help")
    stems = [pathlib.Path(file).stem for file in options.files]
    for stem in stems:
        if stems.count(stem) > 1:
            raise InputError(f"plot.py: error: two files are named {stem}; draw them separately")
    target = pathlib.Path(options.o)
    formats = formats_of(options.format, target)
    names = naming.Names(naming.parse(options.case, naming.CASES, "case"),
                         naming.parse(options.section, naming.SECTIONS, "section"))
    named = options.figures and chosen(options.figures, [f.name for f in FIGURES], "figure")

    # everything is drawn before anything is written
    style.set_up()
    drawn, unread = pages_of(options.files, named, options.why, names)
    pages = paths_of(drawn, target, formats)
    for path, _, _ in pages:
        refuse_unwritable(path, options.files, options.force)
    for path, _, _ in pages:
        path.parent.mkdir(parents=True, exist_ok=True)
    for path, figure, ending in pages:
        try:
            save(figure, path, ending)
            print(path)
        except OSError:
            raise
        except Exception as fault:   # matplotlib finds some faults only when it lays out
            print(f"{path}: not drawn, {failure(fault)}", file=sys.stderr)
    style.plt.close("all")
    return 2 if unread else 0


CRASHES = (signal.SIGSEGV, signal.SIGBUS, signal.SIGABRT, signal.SIGFPE, signal.SIGILL)


def run_apart(arguments):
    """Exit status of main in a process of its own: the HDF5 library crashes on some damaged files."""
    child = os.fork()
    if child == 0:
        sys.exit(run(main, arguments))

    def pass_on(number, _):
        with contextlib.suppress(ProcessLookupError):   # an interrupt from a terminal has ended it already
            os.kill(child, number)

    for passed_on in (signal.SIGINT, signal.SIGTERM):
        signal.signal(passed_on, pass_on)
    _, status = os.waitpid(child, 0)
    if not os.WIFSIGNALED(status):
        return os.waitstatus_to_exitcode(status)
    number = os.WTERMSIG(status)
    if number not in CRASHES:
        return 128 + number
    file = os.fsdecode(reading[:].split(b"\0", 1)[0])
    print(f"{file}: error: is damaged (reading it ended with {signal.Signals(number).name})", file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(run_apart(sys.argv[1:]))
