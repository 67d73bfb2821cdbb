"""Wrong readings of tests that standards evaluate."""
import pathlib

from edits import typed

GOOD = """# laser along X
direction,target_mm,p1,p2,p3
forward,0,0.001,0.002,0.0015
forward,100,100.003,100.004,100.003
forward,200,200.001,200.002,200.001
backward,0,0,0.001,0
backward,100,100.002,100.001,100.002
backward,200,200,200.001,200
"""
LASER = "scale_uncertainty_um_per_m = 0.25\nresolution_um = 0.01\nvariation_um = 0.3\n"
COMMAND = "servomill evaluate axis.csv --standard iso230-2"


def readings(title, *edits, commands=(COMMAND,), **more):
    """axis.csv with some things changed."""
    text = GOOD
    for old, new in edits:
        assert old in text, old
        text = text.replace(old, new, 1)
    about = ", ".join(f"{new!r} in place of {old!r}" for old, new in edits) or "nothing wrong in it"
    return typed(title, *commands, write={"axis.csv": text}, about="with " + about if edits else about) | more


def table(title, name, text, command):
    return typed(title, command, write={name: text})


def rows(direction, angles, more=""):
    return "".join(f"{direction},{angle},0{more}\n" for angle in angles)


TRUNNION = (pathlib.Path(__file__).parents[3] / "scenarios/machines/generic_trunnion_ac.toml").read_text()
SIMULATED = """title = "a test"
machine = "machine.toml"
[[test]]
name = "X"
standard = "iso230-2"
axis = "X"
from_mm = 0
to_mm = 100
feed = "1 m/min"
[test.device]
resolution_um = 0.01
[[case]]
name = "nominal"
"""


def simulated(title, old, new, good=SIMULATED):
    """A scenario with a test of the machine, one thing of it changed."""
    assert old in good, old
    machine = {"trunnion.toml": TRUNNION} if "trunnion.toml" in good else {}
    return typed(title, "servomill check test.toml", write={"test.toml": good.replace(old, new, 1)} | machine,
                 about={"test.toml": f"with {new!r} in place of {old!r}", "trunnion.toml": "scenarios/machines/generic_trunnion_ac.toml"})


DIAGONALS = SIMULATED.replace('"iso230-2"\naxis = "X"\nfrom_mm = 0\nto_mm = 100', '"iso230-6"\nfrom = { X_mm = 0, Y_mm = 0 }\nto = { X_mm = 100, Y_mm = 80 }')
CIRCLES = SIMULATED.replace('"iso230-2"\naxis = "X"\nfrom_mm = 0\nto_mm = 100', '"iso230-4"\nplane = "XY"\nradius_mm = 50\nat = { X_mm = 0, Y_mm = 0 }')
ON_TRUNNION = SIMULATED.replace("machine.toml", "trunnion.toml")
ROTARY = ON_TRUNNION.replace('"X"\nfrom_mm = 0\nto_mm = 100\nfeed = "1 m/min"', '"C"\nfrom_deg = 0\nto_deg = 330\nrotary_feed = "10 rpm"').replace("_um", "_urad")
TABLE = ON_TRUNNION.replace('"iso230-2"\naxis = "X"\nfrom_mm = 0\nto_mm = 100\nfeed = "1 m/min"',
                          '"iso230-7"\naxis = "C"\nrotary_feed = "10 rpm"\nat = { X_mm = 0, Y_mm = 0, Z_mm = 50 }')
BALL = ON_TRUNNION.replace('"iso230-2"\naxis = "X"\nfrom_mm = 0\nto_mm = 100\nfeed = "1 m/min"',
                         '"iso10791-6"\naxis = "C"\nfrom_deg = 0\nto_deg = 360\nrotary_feed = "5 rpm"\ntool = 1\nat = { X_mm = 90, Y_mm = 0, Z_mm = 50 }')


TESTS = [
    readings("evaluate: a run is missing at one target", ("100.004", "")),
    readings("evaluate: one direction only", (GOOD[GOOD.index("backward"):], ""), stdout=True),
    readings("evaluate: a target that is approached in one direction", ("backward,200,200,200.001,200\n", "")),
    readings("evaluate: a target twice", ("forward,200", "forward,100"), ("200.001,200.002,200.001", "100.001,100.002,100.001")),
    readings("evaluate: targets out of order", ("forward,0,0.001,0.002,0.0015\n", ""),
             ("forward,200,200.001,200.002,200.001\n", "forward,200,200.001,200.002,200.001\nforward,0,0.001,0.002,0.0015\n")),
    readings("evaluate: positions in um under a target in mm", ("100.003,100.004,100.003", "100003,100004,100003")),
    readings("evaluate: targets in inches", ("target_mm", "target_in"), commands=(COMMAND,), stdout=True),
    readings("evaluate: an outlier of 0.1 mm counts and is named", ("200.001,200.002,200.001", "200.001,200.102,200.001"), stdout=True),
    readings("evaluate: a word in place of a number", ("100.004", "off")),
    readings("evaluate: a direction that is none", ("backward,100", "left,100")),
    readings("evaluate: an unknown column", ("p3", "q3")),
    readings("evaluate: two runs of one name", ("p3", "p2")),
    readings("evaluate: a row that is too short", ("forward,100,100.003,100.004,100.003", "forward,100,100.003")),
    readings("evaluate: no column of readings", ("p1,p2,p3", "a,b,c")),
    readings("evaluate: runs in different units", ("p3", "p3_um")),
    readings("evaluate: one target", (GOOD[GOOD.index("forward,100"):], "")),
    table("evaluate: a run that is not numbered from 1", "axis.csv",
          "run,direction,target_mm,position_mm\n0,forward,0,0\n1.5,forward,10,10\n1,forward,20,20\n", COMMAND),
    table("evaluate: a deviation without its unit", "axis.csv", "direction,target_mm,deviation\nforward,0,1\nforward,10,2\n", COMMAND),
    table("evaluate: an empty file", "axis.csv", "", COMMAND),
    readings("evaluate: standards", commands=(
        "servomill evaluate axis.csv", "servomill evaluate axis.csv --standard iso230-3", "servomill evaluate --standard 2",
        "servomill evaluate gone.csv --standard 2", "servomill evaluate axis.csv --standard iso230-4",
        "servomill evaluate axis.csv --standard iso230-4 --radius 100", "servomill evaluate axis.csv --standard iso230-4 --radius -1",
        "servomill evaluate axis.csv --standard iso230-7", "servomill evaluate axis.csv --standard iso10791-6",
        "servomill evaluate axis.csv --standard 2 --period 100", "servomill evaluate axis.csv --standard 2 --period 5",
        "servomill evaluate axis.csv --standard 2 --table axis.csv --force", "servomill evaluate axis.csv --standard 2 --table gone/out.csv")),
    typed("evaluate: contributions to the uncertainty", COMMAND + " --uncertainty laser.toml", COMMAND + " --uncertainty gone.toml",
          "servomill evaluate axis.csv --standard 6 --uncertainty laser.toml",
          write={"axis.csv": GOOD, "laser.toml": LASER.replace("0.01", "-0.01") + "temperature_degC = 68\nalignment_mrad = 1\n"}),
    typed("evaluate: U cannot be stated", COMMAND + " --uncertainty laser.toml", write={"axis.csv": GOOD, "laser.toml": LASER}) | {"stdout": True},
    table("evaluate: an arc in place of a circle", "circle.csv", "direction,angle_deg,deviation_um\n" + rows("ccw", range(0, 180, 3)),
          "servomill evaluate circle.csv --standard 4 --radius 100"),
    table("evaluate: a circle that goes the other way", "circle.csv", "direction,angle_deg,deviation_um\n" + rows("cw", range(0, 360, 5)),
          "servomill evaluate circle.csv --standard 4 --radius 100"),
    table("evaluate: a radius in place of its deviation", "circle.csv", "direction,angle_deg,deviation_mm\nccw,0,100.003\nccw,3,100.004\n",
          "servomill evaluate circle.csv --standard 4 --radius 100"),
    table("evaluate: a radius that is wrong by 40 mm", "circle.csv",
          "direction,x_mm,y_mm\nccw,100,0\nccw,99,1\n", "servomill evaluate circle.csv --standard 4 --radius 60"),
    table("evaluate: a ball bar whose radius is wrong by a millimetre", "circle.csv", "direction,angle_deg,deviation_um\n"
          + "".join(f"ccw,{angle},1003\n" for angle in range(0, 360, 5)), "servomill evaluate circle.csv --standard 4 --radius 100")
    | {"stdout": True},
    table("evaluate: revolutions of different angles", "spindle.csv",
          "revolution,angle_deg,x_um\n" + "".join(f"{n},{45 * k + n},0.1\n" for n in (1, 2) for k in range(8)),
          "servomill evaluate spindle.csv --standard 7"),
    table("evaluate: tilt without its lever", "spindle.csv", "angle_deg,x_um,x2_um\n0,1,2\n", "servomill evaluate spindle.csv --standard 7"),
    table("evaluate: a sensor without its unit", "ball.csv", "direction,C_deg,radial\nccw,0,1\n",
          "servomill evaluate ball.csv --standard 10791-6"),
    simulated("a test of an axis that there is not", 'axis = "X"', 'axis = "W"'),
    simulated("a test of a rotary axis with targets in mm", 'axis = "X"', 'axis = "C"', ON_TRUNNION),
    simulated("a feed that the axis does not reach", "1 m/min", "100 m/min"),
    simulated("a standard that is not simulated", "iso230-2", "iso230-1"),
    simulated("a circle without its centre", "at = { X_mm = 0, Y_mm = 0 }", "", CIRCLES),
    simulated("positions of a rotary axis with the errors of a beam", "resolution_urad = 0.01", "misalignment_mrad = 0.5", ROTARY),
    simulated("a rotary axis with a linear feed", 'rotary_feed = "10 rpm"', 'rotary_feed = "10 mm/min"', ROTARY),
    simulated("an artefact off the axis of the table", "X_mm = 0", "X_mm = 12", TABLE),
    simulated("an error motion of a linear axis", 'axis = "C"', 'axis = "X"', TABLE),
    simulated("a ball on the axis of the table", "X_mm = 90", "X_mm = 0", BALL),
    simulated("a ball without its place", "X_mm = 90, ", "", BALL),
    simulated("a ball without a tool", "tool = 1\n", "", BALL),
    simulated("a test beyond the travel", "to_mm = 100", "to_mm = 10000"),
    simulated("targets that fall", "to_mm = 100", "to_mm = -100"),
    simulated("targets spread over each other", "to_mm = 100", "to_mm = 100\ntarget_spread_mm = 15"),
    simulated("two ways of naming targets", "to_mm = 100", "to_mm = 100\ntargets_mm = [0, 50]"),
    simulated("a rotary table with the keys of a line", "iso230-2", "iso230-7"),
    simulated("a circle with the keys of a line", "iso230-2", "iso230-4"),
    simulated("a test at a place that no axis reaches", "to_mm = 100", "to_mm = 100\nat = { Y_mm = 5000 }"),
    simulated("diagonals of a line", ", Y_mm = 0", "", DIAGONALS),
    simulated("diagonals between corners of the same height", "Y_mm = 80", "Y_mm = 0", DIAGONALS),
    simulated("a circle larger than the travel", "radius_mm = 50", "radius_mm = 5000", CIRCLES),
    simulated("a ball bar with the contributions of a laser", "resolution_um = 0.01", "misalignment_mrad = 0.5", CIRCLES),
    simulated("a test beside the text of a program", "[[case]]", "[program]\ntext = \"M2\"\n[[case]]"),
    simulated("a test beside a program", "[[case]]", "[program]\nfile = \"part.ngc\"\n[[case]]"),
    simulated("a misspelt contribution of the device", "resolution_um", "resolutoin_um"),
]
