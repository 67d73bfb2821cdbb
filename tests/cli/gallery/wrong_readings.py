"""Wrong readings of a machine, from which calibrate finds its errors."""
import math

from edits import typed

MACHINE = 'structure = "[w b X Y Z (C1) t]"\n' + "".join(f"[axis.{axis}]\ntravel_mm = [0, 500]\n" for axis in "XYZ")
TARGETS = (50, 150, 250, 350, 450)
SCALE = 100e-6   # of X, too long
LEANING = 50e-6  # rad, of Y: EC0Y


def ripple(i):
    """Some noise, the same each time; um."""
    return 0.25 * math.sin(7.3 * i)


def line(axis, scale):
    """Two runs, both ways, with a lost motion of 4 um."""
    rows = [f"{axis}_mm,direction,run,deviation_um"]
    for run in (1, 2):
        for way, targets in (("forward", TARGETS), ("backward", TARGETS[::-1])):
            for target in targets:
                deviation = scale * target * 1e3 + (2 if way == "forward" else -2) + ripple(target + run + len(way))
                rows.append(f"{target},{way},{run},{deviation:.2f}")
    return "\n".join(rows) + "\n"


def circle():
    rows = ["angle_deg,direction,deviation_um"]
    for way, step in (("ccw", 15), ("cw", -15)):
        for k in range(24):
            a = math.radians(step * k)
            x, y = (-math.sin(a), math.cos(a)) if way == "ccw" else (math.sin(a), -math.cos(a))
            sign = lambda v: 0 if abs(v) < 1e-9 else math.copysign(2, v)
            deviation = 100e3 * (SCALE * math.cos(a) ** 2 - LEANING * math.sin(a) * math.cos(a)) + sign(x) * math.cos(a) + sign(y) * math.sin(a)
            rows.append(f"{step * k % 360},{way},{deviation + ripple(k):.2f}")
    return "\n".join(rows) + "\n"


def group(name, kind, file, keys):
    return f'[[group]]\nname = "{name}"\nkind = "{kind}"\nreadings = "{file}"\n{keys}\npoint_mm = [0, 0, -100]\nuncertainty_um = 0.3\n\n'


GROUPS = 'machine = "router.toml"\n\n' \
    + group("laser X", "positioning", "x.csv", 'axis = "X"\nat = { Y_mm = 100, Z_mm = 250 }') \
    + group("laser X, behind", "positioning", "x2.csv", 'axis = "X"\nat = { Y_mm = 400, Z_mm = 250 }') \
    + group("laser Y", "positioning", "y.csv", 'axis = "Y"\nat = { X_mm = 250, Z_mm = 250 }') \
    + group("ball bar", "circle", "bar.csv", 'plane = "XY"\nradius_mm = 100\nradius_uncertainty_um = 1\nat = { X_mm = 250, Y_mm = 250, Z_mm = 250 }') \
    + '[adjustment]\nerrors = ["EXX", "EYY", "EC0Y"]\n\n[adjustment.form]\nlinear = { polynomial = 1 }\n'
GOOD = {"router.toml": MACHINE, "readings.toml": GROUPS, "x.csv": line("X", SCALE), "x2.csv": line("X", SCALE), "y.csv": line("Y", 0.0),
        "bar.csv": circle()}
COMMAND = "servomill calibrate readings.toml -q"


def values(text, change):
    """The last column, changed."""
    head, *rows = text.splitlines()
    return "\n".join([head] + [f"{row.rpartition(',')[0]},{change(float(row.rpartition(',')[2])):.4f}" for row in rows]) + "\n"


def column(text, name, value):
    head, *rows = text.splitlines()
    return "\n".join([f"{head},{name}"] + [f"{row},{value}" for row in rows]) + "\n"


def one(text, number, change):
    rows = text.splitlines(keepends=True)
    return "".join(rows[:number - 1]) + change(rows[number - 1]) + "".join(rows[number:])


def wrong(title, about, files):
    """The files of GOOD, some of them changed."""
    assert all(files[name] != GOOD[name] for name in files), title
    return typed(title, COMMAND, write=GOOD | files, right=set(GOOD) - set(files), about=about)


def edited(old, new, text=GROUPS):
    assert old in text, old
    return text.replace(old, new, 1)


EXPANSION = 'axis = "X"\nexpansion = { temperature_uncertainty_K = 0.2 }'
READINGS = [
    wrong("calibrate: good readings", "nothing wrong in it", {}),
    wrong("calibrate: the wrong sign of one group", "all numbers with the other sign", {"x.csv": values(GOOD["x.csv"], lambda v: -v)}),
    wrong("calibrate: the wrong sign of an axis in both of its groups", "all numbers with the other sign",
          {"x.csv": values(GOOD["x.csv"], lambda v: -v), "x2.csv": values(GOOD["x2.csv"], lambda v: -v)}),
    wrong("calibrate: millimetres in a column of micrometres", "all numbers over 1000", {"x.csv": values(GOOD["x.csv"], lambda v: v / 1000)}),
    wrong("calibrate: micrometres in a column of millimetres", "deviation_mm in x.csv", {"x.csv": "X_mm,direction,run,deviation_mm\n50,forward,1,7.11\n450,forward,1,46.9\n"}),
    wrong("calibrate: a column of an angle", "deviation_urad in x.csv", {"x.csv": edited("deviation_um", "deviation_urad", GOOD["x.csv"])}),
    wrong("calibrate: a target out of travel", "550 in place of 450 in x.csv", {"x.csv": edited("450,forward,1", "550,forward,1", GOOD["x.csv"])}),
    wrong("calibrate: a run missing at a target", "one row less in x.csv", {"x.csv": one(GOOD["x.csv"], 14, lambda row: "")}),
    wrong("calibrate: a run missing in columns of runs", "runs as columns in x.csv",
          {"x.csv": "target_mm,direction,p1,p2\n50,forward,50.007,50.007\n250,forward,250.027,\n450,forward,450.047,450.047\n"}),
    wrong("calibrate: positions of Y in one direction only", "half of y.csv", {"y.csv": "".join(r for r in GOOD["y.csv"].splitlines(True) if "backward" not in r),
                                                                            "readings.toml": edited("radius_mm = 100", "radius_mm = 100\n# no direction"),
                                                                            "bar.csv": "\n".join(r.replace(",ccw", "").replace(",cw", "").replace(",direction", "")
                                                                                                 for r in GOOD["bar.csv"].splitlines()) + "\n"}),
    wrong("calibrate: a target twice", "a row twice in x.csv", {"x.csv": one(GOOD["x.csv"], 4, lambda row: row + row)}),
    wrong("calibrate: a ball bar whose radius is wrong by a millimetre", "1000 um added in bar.csv", {"bar.csv": values(GOOD["bar.csv"], lambda v: v + 1000)}),
    wrong("calibrate: the same, of a ball bar that is not calibrated", "1000 um added in bar.csv, no radius_uncertainty_um",
          {"bar.csv": values(GOOD["bar.csv"], lambda v: v + 1000), "readings.toml": edited("radius_uncertainty_um = 1\n", "")}),
    wrong("calibrate: an outlier of 0.1 mm", "100 um added in line 5 of x2.csv", {"x2.csv": one(GOOD["x2.csv"], 5, lambda row: values("head\n" + row, lambda v: v + 100)[5:])}),
    wrong("calibrate: temperatures in Fahrenheit", "temperature_degC = 70.2 in x.csv, an expansion",
          {"x.csv": "X_mm,direction,run,deviation_um,temperature_degC\n50,forward,1,7.1,70.2\n450,forward,1,46.9,70.2\n", "readings.toml": edited('axis = "X"', EXPANSION)}),
    wrong("calibrate: a column of temperatures in Fahrenheit", "temperature_degF in x.csv", {"x.csv": column(GOOD["x.csv"], "temperature_degF", 70.2)}),
    wrong("calibrate: temperatures that nothing uses", "temperature_degC in x.csv", {"x.csv": column(GOOD["x.csv"], "temperature_degC", 21.3)}),
    wrong("calibrate: an expansion without temperatures", "an expansion", {"readings.toml": edited('axis = "X"', EXPANSION)}),
    wrong("calibrate: an axis of which nothing says where it stood", "no Z_mm", {"readings.toml": edited("at = { Y_mm = 100, Z_mm = 250 }", "at = { Y_mm = 100 }")}),
    wrong("calibrate: readings that are not there yet", "no number in line 3 of x.csv", {"x.csv": one(GOOD["x.csv"], 3, lambda row: row.rpartition(",")[0] + ",\n")}),
]
