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
    experiment("identify: outputs", "", "", "the outputs are refused before anything is read",
               commands=("servomill identify experiment.toml -o machine.txt", "servomill identify experiment.toml -o machine.toml",
                         "servomill identify experiment.toml --signals out.csv", "servomill identify")),
    experiment("identify: intervals", "", "", "of estimates that there are not, from too few replicas",
               commands=("servomill identify experiment.toml --bootstrap 20", "servomill identify experiment.toml --profile axis.Y.moving_mas")),
    experiment("response: channels, periods, fits", "", "", "a recording of a sine, 64 samples of 2 ms",
               commands=("servomill response record.csv --input q --output y", "servomill response record.csv --input q --output yy --period 0.02",
                         "servomill response record.csv --input q --period 0.02", "servomill response record.csv --input q --output y --period 0.0213",
                         "servomill response record.csv --input q --output y --period 0.1",
                         "servomill response record.csv --input q --output y --period 0.02 --fit three-mass")),
]
