"""Wrong experiments of servomill identify, and wrong calls of servomill response."""
import math

from edits import typed

EXPERIMENT = """machine = "machine.toml"
[loop]
period_ms = 2.0
position_gain = "60 1/s"
velocity_gain = "3e5 N s/m"
[[recording]]
file = "record.csv"
axis.Y.command = "q"
axis.Y.feedback = "y"
axis.Y.force = "F"
[[estimate]]
key = "axis.Y.moving_mass"
"""


def rows(feedback=lambda q: q, force=lambda k: 400.0 * math.cos(k / 8), time=lambda k: k, count=64):
    lines = []
    for k in range(count):
        q = 10.0 * math.sin(k / 8)
        lines.append(f"{time(k)},{q:.6f},{feedback(q):.6f},{force(k):.3f}")
    return "time [ms],q [mm],y [mm],F [N]\n" + "\n".join(lines) + "\n"


def fitted(title, old="", new="", about="", record=None):
    """The same, where a fit is found and warned of; its numbers are left out, as they depend on the machine that computes them."""
    numbers = r"s/-?[0-9]+(\.[0-9]+)?(e[-+]?[0-9]+)?/#/g"
    said = "clipped|bound|times its start value|unexplained"
    command = f"servomill identify experiment.toml 2>&1 | grep -E '{said}' | sed -E '{numbers}' >&2"
    return experiment(title, old, new, about, record or rows(feedback=lambda q: 0.98 * q, time=lambda k: 2 * k, count=400), (command,))


def experiment(title, old="", new="", about="", record=None, commands=("servomill identify experiment.toml",)):
    """experiment.toml with one thing changed, or another recording."""
    assert old in EXPERIMENT, old
    text = EXPERIMENT.replace(old, new, 1) if old else EXPERIMENT
    return typed(title, *commands, write={"experiment.toml": text, "record.csv": record or rows(time=lambda k: 2 * k)},
                 about=about or f"with {new!r} in place of {old!r}")


EXPERIMENTS = [
    experiment("identify: a recording that is not there", "record.csv", "gone.csv"),
    experiment("identify: a channel that is not there", '"y"', '"yy"'),
    experiment("identify: a role that there is not", "axis.Y.feedback", "axis.Y.feedbck"),
    experiment("identify: an axis that there is not", "axis.Y.command", "axis.V.command"),
    experiment("identify: two axes in one recording", "axis.Y.force", "axis.Z.force"),
    experiment("identify: no feedback", 'axis.Y.feedback = "y"\n', ""),
    experiment("identify: a unit of another quantity", '"y"', '{ channel = "y", unit = "A" }'),
    experiment("identify: a key that is nowhere", "axis.Y.moving_mass", "axis.Y.moving_mas"),
    experiment("identify: a start beyond its bound", 'key = "axis.Y.moving_mass"', 'key = "axis.Y.moving_mass"\nmin = "700 kg"'),
    experiment("identify: a bound in another unit", 'key = "axis.Y.moving_mass"', 'key = "axis.Y.moving_mass"\nmin = 0.5'),
    experiment("identify: nothing to estimate", '[[estimate]]\nkey = "axis.Y.moving_mass"\n', ""),
    experiment("identify: nothing to estimate from", 'file = "record.csv"', 'file = "record.csv"\nuse = "validation"'),
    experiment("identify: no gain of the velocity loop", 'velocity_gain = "3e5 N s/m"\n', ""),
    experiment("identify: overrides", "[loop]", '[machine_override.axis.Y]\nmoving_mass = "500 kg"\n[loop]'),
    experiment("identify: no common part in time", 'file = "record.csv"', 'file = "record.csv"\nfrom_s = 5.0'),
    experiment("identify: a recording without motion", about="all of y is 0.5 mm", record=rows(feedback=lambda q: 0.5, time=lambda k: 2 * k)),
    experiment("identify: a feedback of the wrong sign", about="y is -q", record=rows(feedback=lambda q: -q, time=lambda k: 2 * k)),
    experiment("identify: a feedback in another unit", about="y is 1000 q", record=rows(feedback=lambda q: 1000 * q, time=lambda k: 2 * k)),
    experiment("identify: time that runs backwards", about="from the 40th sample on", record=rows(time=lambda k: 2 * k if k < 40 else 2 * (80 - k))),
    experiment("identify: a recording of two seconds' pace", about="a sample every 2 s", record=rows(time=lambda k: 2000 * k, count=8)),
    experiment("identify: a recording that is cut off", about="in the middle of its last row", record=rows(time=lambda k: 2 * k)[:-20]),
    experiment("identify: a recording of another kind", about="a page of HTML", record="<!DOCTYPE html><html><p>no recording</p></html>\n"),
    experiment("response: a recording without excitation", about="all of y is 0.5 mm", record=rows(feedback=lambda q: 0.5, time=lambda k: 2 * k),
               commands=("servomill response record.csv --input y --output q --period 0.02",)),
    experiment("identify: a row that is shorter", about="the 21st row lacks its force", record="\n".join(
        line.rsplit(",", 1)[0] if k == 21 else line for k, line in enumerate(rows(time=lambda k: 2 * k).split("\n")))),
    experiment("identify: a channel without a sample", about="all of y is empty", record="\n".join(
        line if k == 0 or not line else ",".join((line.split(",")[0], line.split(",")[1], "", line.split(",")[3]))
        for k, line in enumerate(rows(time=lambda k: 2 * k).split("\n")))),
    experiment("identify: an unknown loop", "[loop]", '[loop]\nkind = "cascaded"'),
    experiment("identify: a period that our NC has not", "[loop]\nperiod_ms = 2.0\nposition_gain = \"60 1/s\"\nvelocity_gain = \"3e5 N s/m\"",
               '[loop]\nkind = "nc"\nperiod_ms = 0.33'),
    experiment("identify: a filter that there is not", "[[recording]]", '[[loop.filter]]\ntype = "notsch"\n[[recording]]'),
    experiment("identify: more recordings than the experiment has", "", "", "named beside it",
               commands=("servomill identify experiment.toml --recording record.csv --recording record.csv",
                         "servomill identify experiment.toml --recording gone.csv", "servomill identify experiment.toml --validation gone.csv")),
    experiment("response: a gap", about="rows 20 to 29 are missing", record="\n".join(
        line for k, line in enumerate(rows(time=lambda k: 2 * k).split("\n")) if not 20 <= k < 30),
               commands=("servomill response record.csv --input q --output y",)),
    experiment("response: a sample that is missing", about="y is empty in the 30th row", record="\n".join(
        ",".join((*line.split(",")[:2], "", line.split(",")[3])) if k == 30 else line
        for k, line in enumerate(rows(time=lambda k: 2 * k).split("\n"))),
               commands=("servomill response record.csv --input q --output y --period 0.02",)),
    experiment("response: one that no control has computed", "", "", "a recording of a sine",
               commands=("servomill response record.csv --of-control --input 61 --output 62",)),
    typed("recording: damaged files of other kinds", "servomill recording cut.mat", "servomill recording cut.h5", "servomill recording zip.csv",
          "servomill recording empty.csv", "servomill recording cut.xml", "servomill recording cut.sco",
          write={"cut.mat": "MATLAB 5.0 MAT-file" + " " * 107 + "IM", "cut.h5": "\x89HDF\r\n", "zip.csv": "PK\x03\x04 a spreadsheet",
                 "empty.csv": "", "cut.xml": "<traceData><dataFrame>", "cut.sco": "%[GLOBAL]\n%[CURVE1]\n%COUNT=3\n%[DATA]\n0;1\n"},
          about="each is a few bytes"),
    fitted("identify: a force that is clipped", about="at 200 N", record=rows(
        force=lambda k: max(-200.0, min(200.0, 400.0 * math.cos(k / 8))), time=lambda k: 2 * k, count=400)),
    fitted("identify: a value at its bound", 'key = "axis.Y.moving_mass"', 'key = "axis.Y.moving_mass"\nmin = "590 kg"\nmax = "610 kg"'),
    fitted("identify: a mass of tons", '[loop]\nperiod_ms = 2.0\nposition_gain = "60 1/s"\nvelocity_gain = "3e5 N s/m"',
           '[loop]\nkind = "open"\nperiod_ms = 2.0', "the force is in N, its channel says kN", rows(
               feedback=lambda q: 0.98 * q, time=lambda k: 2 * k, count=400).replace("F [N]", "F [kN]")),
    fitted("identify: a loop that is not the recording's", '"60 1/s"', '"5 1/s"'),
    experiment("identify: outputs", "", "", "the outputs are refused before anything is read",
               commands=("servomill identify experiment.toml -o machine.txt", "servomill identify experiment.toml -o machine.toml",
                         "servomill identify experiment.toml --signals out.csv", "servomill identify")),
    experiment("identify: intervals", "", "", "of estimates that there are not, from too few replicas",
               commands=("servomill identify experiment.toml --bootstrap 20", "servomill identify experiment.toml --profile axis.Y.moving_mas")),
    experiment("response: channels, periods, fits", "", "", "a recording of a sine, 64 samples of 2 ms",
               commands=("servomill response record.csv --input q --output yy --period 0.02",
                         "servomill response record.csv --input q --period 0.02", "servomill response record.csv --input q --output y --period 0.0213",
                         "servomill response record.csv --input q --output y --period 0.1",
                         "servomill response record.csv --input q --output y --period 0.02 --fit three-mass",
                         "servomill response record.csv --input q --output y --period 0.02 --fit 4/2")),
]
