"""The wrong inputs of the gallery: a title, what is changed, what is typed.

edit: (file, old text, new text); write: {file: content}; folders: made before; stdout: shown, too.
"""

CHECK = ["servomill check scenario.toml"]
RUN = ["servomill run scenario.toml -o out.h5"]


def line(title, old, new, file="scenario.toml", commands=None):
    return {"title": title, "edit": [(file, old, new)], "commands": commands or CHECK}


def typed(title, *commands, **more):
    return {"title": title, "commands": list(commands), **more}


def machine(title, old, new, commands=None):
    return line(title, old, new, "machine.toml", commands)


def program(title, old, new, commands=None):
    return line(title, old, new, "part.ngc", commands)


ERRORS = "[errors.measured]\nEC0Y = { um_per_m = 120.0 }\n"
COMPENSATE_IT = "servomill compensate cut.ngc --machine machine.toml --errors errors.toml -o out.ngc"
AT_ZERO = COMPENSATE_IT + " --work-offset X=0,Y=0,Z=0"
FOR_FANUC = AT_ZERO + " --dialect fanuc --retract Z=0 --program-number 12"
CUT = "G21 G90\nG0 X0 Y0 Z5\nG1 X10 F100\nM2\n"


def compensated(title, cut, *commands, **more):
    """A program that cannot be compensated."""
    return typed(title, *(commands or [COMPENSATE_IT]), write={"cut.ngc": cut, "errors.toml": ERRORS, **more})


COMPENSATE = [
    compensated("compensate without its inputs", CUT, "servomill compensate", "servomill compensate cut.ngc",
                "servomill compensate cut.ngc --machine machin.toml", "servomill compensate cut.ngc --machine machine.toml",
                COMPENSATE_IT + " --model mesured", COMPENSATE_IT.replace("errors.toml", "cut.ngc")),
    compensated("options of compensate that cannot be", CUT, COMPENSATE_IT + " --tolerance -1", COMPENSATE_IT + " --tolerance '0 um'",
                COMPENSATE_IT + " --max-block '1 s'", COMPENSATE_IT + " --dialect fanuk", COMPENSATE_IT + " --axes rotary",
                COMPENSATE_IT + " --work-offset X10", COMPENSATE_IT + " --work-offset G60:X=10",
                COMPENSATE_IT + " --work-offset A=10", COMPENSATE_IT + " --start X=one", COMPENSATE_IT + " --parameter '#101'"),
    compensated("a program that is there", CUT, "servomill compensate cut.ngc --machine machine.toml --errors errors.toml -o cut.ngc"),
    compensated("a feed from nobody knows where", CUT.replace(" Y0", ""), AT_ZERO),
    compensated("an axis that the machine lacks", CUT.replace("X10", "A10"), AT_ZERO),
    compensated("a work system that nobody said the place of", CUT.replace("G1", "G55 G1"), COMPENSATE_IT,
                COMPENSATE_IT + " --work-offset X=10", AT_ZERO + " --work-offset X=10"),
    compensated("moves under tool-centre-point control", CUT.replace("G1", "G43.4 H1\nG1"),
                AT_ZERO + " --tools tools.tbl", **{"tools.tbl": "T1 P1 Z+40\n"}),
    compensated("parameter files of compensate", CUT, COMPENSATE_IT + " --parameter-file none.var",
                COMPENSATE_IT + " --parameter-file wrong.var",
                **{"wrong.var": "5221 1.5\n5222\n12 1\n5220 10\n5210 1\n"}),
    compensated("what a dialect cannot express", CUT.replace("G1", "G59.1\nG1"), FOR_FANUC + " --work-offset G59.1:X=0"),
    compensated("options of other dialects that are missing or cannot be", CUT, AT_ZERO + " --dialect fanuc",
                AT_ZERO + " --dialect fanuc --retract Z=0", FOR_FANUC + "345", FOR_FANUC + " --resolution '3 um'",
                FOR_FANUC + " --correct-rapids", AT_ZERO + " --retract 5", AT_ZERO + " --preset -1",
                FOR_FANUC + " --without mirorr", AT_ZERO + " --dialect siemens --retract Z=0 --without mirror",
                AT_ZERO + " --tool-length 50", COMPENSATE_IT.replace("out.ngc", "my-part.h") + " --dialect heidenhain"),
    compensated("unknown positions for another control", "G21 G90\nG91 G0 Z5\nM2\n", FOR_FANUC),
    compensated("a feed behind a stop", CUT.replace("G1", "M0\nG1"), FOR_FANUC),
    compensated("a tool change that the operator may leave out", CUT.replace("G1", "/ T1 M6\nG1"), FOR_FANUC),
    compensated("a program in two units for a control that changes its offsets with the unit",
                CUT.replace("G1", "G20\nG1"), FOR_FANUC),
]

COMMAND_LINE = [
    typed("an unknown command", "servomill rnu scenario.toml", "servomill frobnicate"),
    typed("an unknown option", "servomill run scenario.toml --forse", "servomill --quiet", "servomill check -x",
          "servomill list --json strategies"),
    typed("an option without its value", "servomill run scenario.toml -o", "servomill run scenario.toml --set"),
    typed("a value of the wrong type", "servomill run scenario.toml --threads many",
          "servomill run scenario.toml --threads -1", "servomill run scenario.toml --force=yes"),
    typed("an empty name", "servomill run ''", "servomill run scenario.toml -o ''", "servomill check ''"),
    typed("no file, or too many", "servomill run", "servomill run scenario.toml machine.toml", "servomill check",
          "servomill compare", "servomill canon", "servomill sweep", "servomill list"),
    typed("instructions that there are not", "SERVOMILL_SIMD=avx servomill run scenario.toml", "SERVOMILL_SIMD=fast servomill list machines"),
    typed("something that cannot be listed", "servomill list strategy", "servomill list machines --folder nowhere"),
    typed("standard output is full", "servomill canon moves.ngc > /dev/full", "servomill list strategies > /dev/full",
          "servomill --help > /dev/full", write={"moves.ngc": "G1 X10 F100\nM2\n"}, about="a right program"),
]

FILES = [
    typed("a file that is not there", "servomill run scenarioo.toml", "servomill check scenarioo.toml nothing.ngc",
          "servomill canon nothing.ngc", "servomill canon part.ngc --tools nothing.tbl", "servomill compare out.h5",
          "servomill sweep scenarioo.toml"),
    typed("a folder instead of a file", "servomill run folder.toml", "servomill check folder.toml folder.ngc",
          "servomill canon folder.ngc", "servomill compare folder.ngc", folders=["folder.toml", "folder.ngc"]),
    typed("an empty file", "servomill run empty.toml", "servomill check empty.toml", "servomill canon empty.ngc",
          "servomill compare empty.h5", write={"empty.toml": "", "empty.ngc": "", "empty.h5": ""}),
    typed("a machine where a scenario is wanted", "servomill run machine.toml"),
    line("the machine file is not there", '"machine.toml"', '"machin.toml"'),
    line("the machine is a number", 'machine = "machine.toml"', "machine = 7"),
    line("the program file is not there", '"part.ngc"', '"prat.ngc"'),
    line("the program file is a folder", '"part.ngc"', '"."'),
    line("not TOML: a text that does not end", 'title   = "A table over X"', 'title   = "A table over X'),
    line("not TOML: a key twice", "feed_override = 1.0", "feed_override = 1.0\nfeed_override = 2.0"),
    line("not TOML: a decimal comma", "length_mm = 110.0", "length_mm = 110,0"),
]

SCENARIO = [
    line("an unknown key", "feed_override", "feed_overide"),
    line("an unknown table", "[record]", "[recorder]"),
    line("a missing key", 'name = "nominal"', ""),
    line("a word for a number", "feed_override = 1.0", 'feed_override = "fast"'),
    line("a number for a text", 'name = "nominal"', "name = 1"),
    line("a table for a list", "[[program.tool]]", "[program.tool]"),
    line("out of range", "feed_override = 1.0", "feed_override = 0.0"),
    line("not finite", "feed_override = 1.0", "feed_override = nan"),
    line("a unit of another kind", 'Kv = "60 1/s"', 'Kv = "60 mm"'),
    line("a unit that there is not", 'Kv = "60 1/s"', 'Kv = "60 1/fortnight"'),
    line("a number without its unit", 'Kv = "60 1/s"', 'Kv = "60"'),
    {"title": "two faults at once, in two files",
     "edit": [("scenario.toml", "feed_override = 1.0", "feed_override = -1.0"),
              ("machine.toml", "lead_mm = 20.0", "lead_mm = 0.0")], "commands": CHECK},
    line("a program parameter without #", '"#101" = 1394.0', '"101" = 1394.0'),
    line("a program parameter that no program has", '"#101" = 1394.0', '"#101" = 1394.0, "#1e9" = 2'),
    line("a tool twice", "length_mm = 110.0", "length_mm = 110.0\n[[program.tool]]\nnumber = 1\nlength_mm = 90.0"),
    line("an unknown strategy", 'type = "table"', 'type = "tabel"'),
    line("an unknown error model", 'model = "imposed"', 'model = "imposd"'),
    line("no error models at all", '[errors.imposed]\nEYX = { harmonic = { amplitude_um = 150.0, period_mm = 62.0 } }', ""),
    line("an unknown error", "EYX", "EYQ"),
    line("an error of an axis that the machine does not have", "EYX", "EYC"),
    line("an error that names itself", "EYX = { harmonic = { amplitude_um = 150.0, period_mm = 62.0 } }", 'EYX = "EYX"'),
    line("a table of errors that does not rise", "harmonic = { amplitude_um = 150.0, period_mm = 62.0 }",
         "table = { at_mm = [0.0, 10.0, 5.0], value_um = [1.0, 2.0, 3.0] }"),
    line("a case twice", 'name = "table"', 'name = "nominal"'),
    line("a case whose name is a path", 'name = "table"', 'name = "../table"'),
    line("a case without a name", 'name = "table"', 'name = ""'),
    line("an unknown case in a quantity", 'cases = ["table"]', 'cases = ["tabel"]'),
    line("an unknown quantity", 'name = "imposed_error_residual"', 'name = "imposed_error_residuals"'),
    line("an axis that the quantity does not have", 'axis = "Y"\nbase', 'axis = "C"\nbase'),
    machine("an axis that the machine does not have", '"[w X b Y Z t]"', '"[w X b Z t]"'),
    line("a section that is no circle", 'name = "imposed_error_residual"\naxis = "Y"\nbaseline = "nominal"',
         'name = "circular_error"'),
    line("one direction of a circle where both are needed", 'name = "imposed_error_residual"\naxis = "Y"\nbaseline = "nominal"',
         'name = "bidirectional_circular_error"'),
    line("a machine of a case that is none", 'name = "nominal"',
         'name = "nominal"\n[case.machine_override.nc]\nKv = 0.0\nKvv = 60.0'),
    line("a case that changes what all cases share", 'name = "nominal"',
         'name = "nominal"\n[case.machine_override.nc]\npreset = "CC422"'),
    line("a section that the program does not have", 'sections = ["flank"]', 'sections = ["flnak"]'),
    line("a reference that is no text", 'reference = "20 um"', "reference = 20"),
    line("the imposed model is not named", 'imposed = "imposed"\n', ""),
    line("a sign that there is not", 'action = "impose"', 'action = "imposed"'),
    line("a key of another strategy", "spacing_mm = 1.6384", "spacing_mm = 1.6384\nextrapolation_time_ms = 3.0"),
    line("a word that is not allowed beside numbers", "from_mm = -200.0", 'from_mm = "travl"'),
    line("a strategy's number out of range", "spacing_mm = 1.6384", "spacing_mm = 0.0"),
    line("two sets of feedback hardware", 'type = "table"', 'type = "feedback"\nmodel = "imposed"\n[[case.strategy]]\ntype = "feedback"\nmodel = "imposed"\n[[case.strategy]]\ntype = "table"'),
    line("feedback without its hardware", '[[case.strategy]]\ntype = "table"', 'feedback_hardware = false\n[[case.strategy]]\ntype = "feedback"\nmodel = "imposed"\n[[case.strategy]]\ntype = "table"'),
    line("a recorder period that is no multiple", "period_ms = 1.0", "period_ms = 1.005"),
    line("a recorder period of the wrong type", "period_ms = 1.0", "period_ms = true"),
    line("a recorder period of nothing", "period_ms = 1.0", "period_ms = 0"),
    line("a recorder period that seldom meets the loops", "period_ms = 1.0", "period_ms = 7919.01"),
    line("an ideal servo recorded between its position periods", 'name = "nominal"', 'name = "nominal"\nservo = "ideal"', "scenario.toml",
         ["servomill check scenario.toml --set record.period_ms=0.13"]),
    line("a run that no memory holds", "feed_override = 1.0", "feed_override = 1e-9", "scenario.toml",
         ["servomill check scenario.toml"]),
    line("a delay that is no multiple", "signal_delay_us = 10.0", "signal_delay_us = 12.0"),
]

MACHINE = [
    machine("machine: an unknown key", "following_error_limit_mm", "following_error_mm"),
    machine("machine: an axis is missing", "[axis.Y]", "[axis.V]"),
    machine("machine: an unknown preset", '"CC424"', '"CC426"'),
    machine("machine: a structure that is none", '"[w X b Y Z t]"', '"[w X Y Z t]"'),
    machine("machine: a period that is no multiple", "base_period_us = 10", "base_period_us = 10\nposition_period_us = 205"),
    machine("machine: a base period that does not divide the preset's", "base_period_us = 10", "base_period_us = 30"),
    machine("machine: a period of the wrong type", "base_period_us = 10", "base_period_us = 10\nposition_period_us = \"slow\""),
    machine("machine: periods that meet too seldom", "base_period_us = 10",
         "base_period_us = 1\nposition_period_us = 9973\nvelocity_period_us = 9967"),
    machine("machine: a base period that no run could count", "base_period_us = 10", "base_period_us = 1e-9"),
    machine("machine: limits far from any machine", 'j_max = "100 m/s^3"', "j_max = 1e300"),
    machine("machine: travel the wrong way round", "travel_mm = [-400.0, 400.0]", "travel_mm = [400.0, -400.0]"),
    machine("machine: travel of one number", "travel_mm = [-400.0, 400.0]", "travel_mm = [400.0]"),
    machine("machine: the same, checked alone", "lead_mm = 20.0", "lead_mm = -20.0",
         ["servomill check machine.toml"]),
    machine("a machine key: from the machine file", 'i_max_A = 50.0', 'i_max_A = -1.0'),
    line("a machine key: from machine_override", 'Kv = "60 1/s"', 'Kv = "-60 1/s"'),
    typed("a machine key: from --set", "servomill run scenario.toml --set machine.nc.Kv=-60",
          "servomill run scenario.toml --set machine_override.nc.Kv=-60",
          "servomill run scenario.toml --set 'machine.axis.X.moving_mass=750 kgs'",
          "servomill run scenario.toml --set machine.nc.kv=60"),
    line("an unknown key in machine_override", 'Kv = "60 1/s"', 'KV = "60 1/s"'),
    line("machine_override is a number", '[machine_override.nc]\nKv = "60 1/s"', "machine_override = 3"),
    line("machine_override of a whole table by a number", '[machine_override.nc]\nKv = "60 1/s"', "[machine_override]\nnc = 3"),
]

FRICTION = '[axis.X.friction]\nmodel = "lugre"\ncoulomb = "450 N"\nbreakaway = "560 N"\nstribeck_velocity = "2 mm/s"\n' \
    'bristle_stiffness = "5e7 N/m"\nbristle_damping = "3e4 N s/m"\n'


def axis(title, key):
    """One more key of the axis X."""
    return machine(title, 'velocity_bandwidth = "200 rad/s"', 'velocity_bandwidth = "200 rad/s"\n' + key)


def table_of_axis(title, text):
    """One more table of the axis X."""
    return machine(title, "[axis.Y]", text + "\n[axis.Y]")


AXIS = [
    table_of_axis("friction: breakaway below Coulomb", FRICTION.replace('"560 N"', '"400 N"')),
    table_of_axis("friction: breakaway below Coulomb in one direction",
                  FRICTION + 'coulomb_negative = "500 N"\nbreakaway_negative = "450 N"\n'),
    table_of_axis("friction: an unknown model", FRICTION.replace("lugre", "luger")),
    table_of_axis("friction: what a model needs is missing", FRICTION.replace('bristle_stiffness = "5e7 N/m"\n', "")
                  .replace('stribeck_velocity = "2 mm/s"\n', "")),
    table_of_axis("friction: units of a rotary axis", FRICTION.replace('"450 N"', '"450 Nm"')),
    table_of_axis("friction: LuGre without Coulomb", FRICTION.replace('"450 N"', '"0 N"')),
    table_of_axis("friction: stiffer than the exact step can be", FRICTION.replace('"3e4 N s/m"', '"1e13 N s/m"')),
    machine("friction: a model for all axes, tables for none", 'name      = "Three-axis mill"',
         'name      = "Three-axis mill"\nfriction_model = "lugre"'),
    machine("an inertia below nothing", 'motor_inertia = "9.6e-3 kg m^2"', 'motor_inertia = "-9.6e-3 kg m^2"'),
    axis("backlash of a rigid drive", 'backlash = "3 um"'),
    axis("a discrete current loop without a winding", 'current_loop = "pi"'),
    table_of_axis("a winding without its current loop's bandwidth",
                  '[axis.X.winding]\ninductance = "4 mH"\nresistance = "0.6 ohm"\n'),
    axis("an inclined linear axis", "direction = [1, 1, 0]"),
    table_of_axis("cogging of a ball screw", '[axis.X.cogging]\namplitude = "3 N"\nperiod = "10 mm"\n'),
    table_of_axis("a filter beyond half the rate", '[[axis.X.filter]]\ntype = "notch"\nfrequency_Hz = 2500\nwidth_Hz = 50\n'),
    table_of_axis("a filter of no type", '[[axis.X.filter]]\ntype = "nothc"\nfrequency_Hz = 120\n'),
    table_of_axis("five filters", '[[axis.X.filter]]\ntype = "low_pass"\nfrequency_Hz = 500\n' * 5),
    axis("a crossover without its frequency", 'position_feedback = "crossover"'),
    axis("a feedback that there is not", 'position_feedback = "scales"'),
    table_of_axis("a spike that does not fade", '[axis.X.friction_compensation]\ncoulomb = "450 N"\nreversal_pulse = "100 N"\n'),
    table_of_axis("an encoder without its period", "[axis.X.scale]\nsubdivision = 1024\n"),
    table_of_axis("an encoder whose signals vanish", '[axis.X.scale]\nperiod = "20 um"\nsine_offset = 1.2\n'),
    table_of_axis("marks on a scale of unknown period", "[axis.X.marks]\nincrement = 1000\n"),
    table_of_axis("marks of an odd increment", '[axis.X.scale]\nperiod = "20 um"\n[axis.X.marks]\nincrement = 999\n'),
    table_of_axis("a current loop faster than its period",
                  '[axis.X.winding]\ninductance = "4 mH"\nresistance = "0.6 ohm"\nbandwidth = "30000 rad/s"\n') | {
        "edit": [("machine.toml", 'velocity_bandwidth = "200 rad/s"', 'current_loop = "pi"\nvelocity_bandwidth = "200 rad/s"'),
                 ("machine.toml", "[axis.Y]", '[axis.X.winding]\ninductance = "4 mH"\nresistance = "0.6 ohm"\n'
                  'bandwidth = "30000 rad/s"\n\n[axis.Y]')]},
    table_of_axis("a filter that the velocity loop cannot bear", '[[axis.X.filter]]\ntype = "low_pass"\nfrequency_Hz = 5\n'),
    axis("a load that no current can hold", 'gravity_load = "30 kN"'),
    line("feedback of a scale that nobody reads", 'type = "table"', 'type = "feedback"\nmodel = "imposed"\n[[case.strategy]]\ntype = "table"')
    | {"commands": ["servomill check scenario.toml --set 'machine_override.nc.position_feedback=\"motor\"'"]},
    machine("an integrator that there is not", 'name      = "Three-axis mill"',
         'name      = "Three-axis mill"\nintegrator = "cvodes"'),
]

SET = [
    typed("--set: no key, no value, no such place", "servomill run scenario.toml --set feed",
          "servomill run scenario.toml --set =3", "servomill run scenario.toml --set program.feed_override=",
          "servomill run scenario.toml --set 'case[7].name=x'", "servomill run scenario.toml --set 'case[one].name=x'",
          "servomill run scenario.toml --set case=3", "servomill run scenario.toml --set title.sub=3",
          "servomill run scenario.toml --set programm.feed_override=2",
          "servomill run scenario.toml --set program.feed_override=fast",
          "servomill run scenario.toml --set machine=nowhere.toml",
          "servomill run scenario.toml --set 'case[1].strategy[0].type=tabel'",
          "servomill run scenario.toml --set 'program.parameters.101=3'"),
]

MACHINE_REFUSES = [
    program("travel limits", "G1 X10", "G1 X1000"),
    {"title": "travel limits in one case only",
     "edit": [("scenario.toml", 'name = "table"', 'name = "table"\nwork_offset = { X_mm = 395.0 }')], "commands": CHECK},
    line("the start is outside the travel", "feed_override = 1.0", "start = { X_mm = -500.0 }"),
    program("an axis word that the machine does not have", "G1 X10", "G1 X10 C90"),
    line("a work offset of an axis that the machine does not have", "feed_override = 1.0", "work_offset = { C_deg = 3.0 }"),
    line("gains that make the loop unstable", 'Kv = "60 1/s"', 'Kv = "5000 1/s"'),
    line("a table too steep for the NC", "amplitude_um = 150.0", "amplitude_um = 300.0"),
    line("a table too long for the NC", "spacing_mm = 1.6384", "spacing_mm = 0.8192"),
    line("a spacing that is not 2^n", "spacing_mm = 1.6384", "spacing_mm = 2.0"),
    line("a table that ends before it begins", "to_mm = 200.0", "to_mm = -300.0"),
    {"title": "a table over an axis that the machine does not have",
     "edit": [("machine.toml", '"[w X b Y Z t]"', '"[w X b Y t]"'), ("scenario.toml", 'axis = "X"', 'axis = "Z"')],
     "commands": CHECK},
    line("a table that the NC looks into at times before now", "to_mm = 200.0", "to_mm = 200.0\nupdate_period_ms = -1.0"),
]

PROGRAM = [
    program("a tool offset that no tool has", "G43 H1", "G43.1 Z10"),
    program("a program that ends in the middle of a block", "G1 Y5\nM30\n", "G1 Y"),
    program("a comment that does not end", "G1 X10", "G1 X10 (to the corner"),
    program("a G-code that there is not", "G1 X10", "G1.5 X10"),
    program("two codes of one modal group", "G1 X10", "G0 G1 X10"),
    program("a feed of nothing", "F#101", ""),
    program("an unknown tool", "T1 M6\nG43 H1", "T7 M6\nG43 H7"),
    program("a parameter that was never set", "F#101", "F#<feed>"),
    program("an arc that misses its end", "G1 Y5", "G2 X20 Y5 I3 J0"),
    program("several faults", "G1 X10\nG1 Y5", "G1 X10 Q\nG1 Y[5 / ]\nG99\nG1 X1O", ["servomill check part.ngc"]),
    program("the same, run", "G1 X10\nG1 Y5", "G1 X10 Q\nG1 Y[5 / ]\nG99\nG1 X1O",
            ["servomill check scenario.toml", "servomill canon part.ngc > moves.json"]),
    program("a program that moves nothing", "G1 X10\nG1 Y5\n", ""),
    typed("a program that is not UTF-8", "servomill check scenario.toml", "servomill run scenario.toml -o out.h5",
          write={"part.ngc": b"(pi\xe8ce)\nG1 X10 F100\nM30\n"}, about="(pi\\xe8ce) in Latin-1"),
    typed("a program that holds a NUL", "servomill check scenario.toml", write={"part.ngc": b"G1 X10 F100\n\0\nM30\n"},
          about="G1 X10 F100 and a byte of 0"),
]

OUTPUT = [
    typed("the result file exists", "servomill run scenario.toml -o out.h5",
          "servomill sweep scenario.toml -o out.h5 --set 'sweep={title=[\"a\"]}'",
          "servomill run scenario.toml -o out.h5 --force",
          write={"out.h5": "precious"}),
    typed("the partial file of another run exists", "servomill run scenario.toml -o out.h5", write={"out.h5.partial": "precious"}),
    typed("--force on a file that is no result", "servomill run scenario.toml -o scenario.toml --force",
          "servomill run scenario.toml -o part.ngc --force"),
    typed("the result is a folder", "servomill run scenario.toml -o folder", "servomill run scenario.toml -o folder --force",
          folders=["folder"]),
    typed("the folder of the result is not there", "servomill run scenario.toml -o nowhere/out.h5"),
    typed("a program checked with and without its tools", "servomill check part.ngc", "servomill check part.ngc --tools tools.tbl",
          write={"tools.tbl": "T1 P1 Z110 D8\n"}),
    machine("a machine that is unstable, checked alone", 'Kv = "60 1/s"', 'Kv = "5000 1/s"',
         ["servomill check machine.toml"]),
    typed("a sweep's file compared", "servomill sweep scenario.toml -q -o out.h5 --set 'sweep={title=[\"a\"]}'", "servomill compare out.h5"),
    typed("a result file that is none", "servomill compare scenario.toml", "servomill compare part.ngc"),
]

SWEEP_IT = "servomill sweep scenario.toml -o out.h5"


def cut(title, text, tool="diameter_mm = 8.0", case="", program=(), commands=None):
    """A scenario with what it says of stock and cutting, the rest of its tool and of its first case, and changes of its program."""
    return {"title": title, "commands": commands or CHECK,
            "edit": [("scenario.toml", "length_mm = 110.0", "length_mm = 110.0\n" + tool),
                     ("scenario.toml", "[record]", text + "\n[record]"),
                     ("scenario.toml", 'name = "nominal"', 'name = "nominal"' + case)]
            + [("part.ngc", old, new) for old, new in program]}


BLOCK = "[[part.stock]]\nbox = { from_mm = [-50.0, -50.0, -130.0], to_mm = [50.0, 50.0, -100.0] }\n"
STEEL = '[cutting]\nmaterial = "42CrMo4"\n'
CUTTING = [
    cut("cutting without a raw part", STEEL),
    cut("a material that is not known", BLOCK + '[cutting]\nmaterial = "42CrMo"'),
    cut("some coefficients of a material are missing", BLOCK + '[cutting]\nKtc = "2300 N/mm^2"\nKrc = "900 N/mm"'),
    cut("raw parts that are none", "[[part.stock]]\nbox = { from_mm = [0.0, 0.0, 0.0], to_mm = [1.0, 1.0, -1.0] }\n[[part.stock]]\n"
        "cylinder = { centre_mm = [0.0], radius_mm = 0.0, from_mm = 0.0, to_mm = 1.0 }\n[[part.stock]]\n" + STEEL),
    cut("wear of a case in air", BLOCK + STEEL, case="\ncutting = false\nwear = 2.0"),
    cut("a case that cuts without cutting", "", case="\ncutting = true"),
    cut("a raw part that is never touched", BLOCK.replace("-50.0, -50.0", "-900.0, -900.0").replace("[50.0, 50.0", "[-800.0, -800.0") + STEEL),
    cut("a cut with the spindle standing", BLOCK + STEEL),
    cut("a tool without diameter in the stock", BLOCK + STEEL, tool=""),
    cut("cuts and coordinates that are odd, and run all the same", BLOCK + STEEL, tool="diameter_mm = 8.0\nflute_length_mm = 5.0",
        program=[("G43 H1", "G43 H1\nS4775 M3"), ("G1 Y5", "G52 X1\nG1 Y5\nG0 Y10")], commands=["servomill run scenario.toml -q -o out.h5"]),
    axis("a structure that gives way to nothing", "structural_stiffness = 0.0"),
]

FACE = "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex {} 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
PROBE = '[[probe]]\nname = "top"\npoints_mm = [[5.0, 5.0, 0.0, 0.0, 0.0, 1.0]]\n'


def cuboid(x, y, z):
    """ASCII STL from the origin to x, y, z."""
    corner = [((i & 1) * x, (i >> 1 & 1) * y, (i >> 2) * z) for i in range(8)]
    faces = ((0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2),
             (1, 3, 7), (1, 7, 5))
    return "solid\n" + "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join("vertex %g %g %g\n" % corner[i] for i in face) + "endloop\nendfacet\n"
        for face in faces) + "endsolid\n"


def stl(title, content, probe="", about=None):
    """A scenario with an STL of the nominal part."""
    shown = {"about": about} if about else {}
    return {**cut(title, '[part]\nstl = "part.stl"\n' + probe), "write": {"part.stl": content} if content is not None else {}, **shown}


PART = [
    stl("an STL that is not there", None),
    stl("an STL without triangles", "solid part\nendsolid part\n"),
    stl("an STL with holes", "solid\n" + FACE.format(1) + "endsolid\n"),
    stl("a triangle without area", "solid\n" + FACE.format(0) + "endsolid\n"),
    stl("an STL that breaks off", "solid\n" + FACE.format(1)[:60]),
    stl("a STEP file for an STL", "ISO-10303-21;\nHEADER;\n"),
    stl("a binary STL that breaks off", bytes(80) + b"\x02\0\0\0" + bytes(50), about="80 bytes, the number 2, one triangle"),
    stl("a probe that faces into the part, and one that misses it", cuboid(10, 10, 10),
        PROBE + PROBE.replace("top", "middle").replace("0.0, 0.0, 0.0", "5.0, 0.0, 0.0"), about="a cuboid of 10 mm"),
    line("an STL that is no name", "[record]", "[part]\nstl = 1\n[record]"),
    line("a raw part in STL", "[record]", '[[part.stock]]\nstl = "raw.stl"\n[record]'),
]


def sweep(title, text, *commands):
    """A table [sweep] in the scenario."""
    return line(title, "[record]", f"[sweep]\n{text}\n[record]", commands=list(commands) or [SWEEP_IT])


SWEEP = [
    typed("a sweep without a [sweep] table", SWEEP_IT),
    sweep("a sweep over a key that there is not", '"program.feed_overide" = [0.5, 1.0]', *CHECK, SWEEP_IT),
    sweep("a sweep whose last point is wrong", '"program.feed_override" = [1.0, -1.0]', *CHECK, SWEEP_IT),
    sweep("a sweep to where the loop is unstable", '"machine.nc.Kv" = ["60 1/s", "5000 1/s"]', *CHECK, SWEEP_IT),
    sweep("a sweep over nothing", '"program.feed_override" = []'),
    sweep("a sweep over no list", '"program.feed_override" = 1.0'),
    sweep("a sweep over a case that there is not", '"case.tabel.strategy.time_constant_ms" = [0.0, 10.0]'),
    sweep("a sweep over what is compared", '"quantity[0].axis" = ["X", "Y"]'),
    sweep("a sweep over too many points",
          'program.feed_override = { log = [0.1, 2.0], count = 5000 }\n'
          'machine.nc.Kv = { linear = ["40 1/s", "80 1/s"], count = 5000 }'),
    sweep("ranges and lists that are none",
          '"program.feed_override" = { linear = [0.5, 0.5], count = 3 }\n'
          '"machine.nc.Kv" = { log = ["40 1/s", "2 m/min/mm"], count = 3 }\n'
          '[[sweep.zip]]\n"machine.axis.X.v_max" = [1.0, 2.0]\n"machine.axis.Y.v_max" = [1.0, 2.0, 3.0]'),
    sweep("distributions that are none, and no samples",
          '"errors.imposed.EYX.harmonic.amplitude_um" = { normal = [150.0, -3.0] }\n'
          '"program.feed_override" = { uniform = [2.0, 1.0], conut = 3 }'),
    sweep("samples of nothing", 'samples = { design = "sobel", count = 0 }\n"program.feed_override" = [1.0]'),
    sweep("a distribution without samples", '"program.feed_override" = { uniform = [1.0, 2.0] }'),
    sweep("points and shards that there are not",
          '"program.feed_override" = [1.0, 2.0]',
          SWEEP_IT + " --points 2-3",
          SWEEP_IT + " --points 0-1",
          SWEEP_IT + " --points 2",
          SWEEP_IT + " --shard 3/2",
          SWEEP_IT + " --shard 1/3",
          SWEEP_IT + " --shard one"),
    sweep("shards merged that do not make a whole",
          '"program.feed_override" = [1.0, 2.0, 3.0]',
          "servomill sweep scenario.toml -q -o out.h5 --shard 1/3",
          "servomill merge",
          "servomill merge out.1-of-3.h5",
          "servomill merge out.1-of-3.h5 -o out.h5",
          "servomill merge out.1-of-3.h5 out.1-of-3.h5 -o out.h5",
          "servomill merge out.1-of-3.h5 scenario.toml -o out.h5",
          "servomill sweep scenario.toml -q -o other.h5 --shard 2/3 --set record.period_ms=0.5",
          "servomill merge out.1-of-3.h5 other.2-of-3.h5 -o out.h5",
          "servomill merge out.1-of-3.h5 -o out.h5 --partial -q",
          "servomill sweep scenario.toml -o out.h5",
          SWEEP_IT + " --shard 1/3 --set record.period_ms=0.5"),
    sweep("a value for a key that the sweep varies", '"program.feed_override" = [1.0, 2.0]', SWEEP_IT + " --set program.feed_override=0.3"),
    typed("the CSV file of a sweep exists", "servomill sweep scenario.toml -o out.h5 --set 'sweep={title=[\"a\"]}'",
          "servomill sweep scenario.toml -o out.h5 --force --set 'sweep={title=[\"a\"]}'", write={"out.csv": "precious"}),
]

BODE, STEP, TUNE = (f"servomill {command} scenario.toml --axis Y" for command in ("bode", "step", "tune"))

SERVO = [
    typed("an axis that the machine lacks", "servomill bode scenario.toml", "servomill bode scenario.toml --axis y,Q",
          "servomill step scenario.toml --axis A", "servomill step scenario.toml --axis ''",
          "servomill tune scenario.toml --axis al"),
    typed("a case that there is not", BODE + " --case tabel", "servomill tune scenario.toml --axis X --case nominl"),
    typed("frequencies that cannot be", BODE + " --f-min 0", BODE + " --f-min nan", BODE + " --f-min 0.01", BODE + " --f-max 2600",
          BODE + " --loop velocity --f-min 2600", BODE + " --f-min 10 --f-max 10", BODE + " --points 1"),
    typed("an amplitude that cannot be", BODE + " --amplitude '0 um'", BODE + " --amplitude -20",
          BODE + " --amplitude '20 N'", BODE + " --loop compliance --amplitude '20 um'",
          BODE + " --loop all --amplitude '20 um'", BODE + " --velocity '1 mm'"),
    typed("a loop, a method, a step that there is not", BODE + " --loop positon", BODE + " --method sinus",
          STEP + " --kind force"),
    typed("a step that cannot be", STEP + " --kind load --amplitude '0 N'", STEP + " --amplitude '1 mm'",
          STEP + " --kind load --amplitude '1 mm'", STEP + " --band 100", STEP + " --duration '0 s'",
          STEP + " --duration '1 h'"),
    typed("margins that cannot be", TUNE + " --phase-margin 90", TUNE + " --gain-margin 0", TUNE + " --overshoot 100",
          TUNE + " --bandwidth -5", TUNE + " --phase-margin 85"),
    typed("a file to write responses to that cannot be had", BODE + " --method none -o scenario.toml",
          STEP + " -o nowhere/out.h5"),
]

SOFT = "drive = \"two_mass\"\nstiffness = 180\ndamping = 1000"
UNITS = [
    {"title": "a stiffness in N/um without its unit", "commands": ["servomill check machine.toml"],
     "edit": [("machine.toml", 'drive = "rigid"', SOFT)]},
    {"title": "bare numbers that no machine has, of a machine that is stable", "commands": ["servomill check machine.toml", "servomill run scenario.toml -q -o out.h5"],
     "edit": [("machine.toml", 'v_max = "40 m/min"', "v_max = 40000")]},
]

POST_IT = "servomill post part.cls --machine machine.toml -o out.ngc"
POST_T = POST_IT + " --tool-length 0"
RIGHT = "FEDRAT/600\nRAPID\nGOTO/0,0,10\nGOTO/0,0,0\n"

POST = [
    typed("cutter locations that cannot be read", POST_IT,
          write={"part.cls": "UNITS/CM\nFEDRAT/0\nFEDRAT/10,MPM\nGOTO/1,2\nGOTO/1,2,3,0,0,0\nGOTO/1,2,three\nGTO/1,2,3\n"
                             "CIRCLE/0,0,0,0,0,1,5\nSPINDL/ON\nLOADTL/1.5\nGOTO/1,2,$"}),
    typed("cutter locations to be checked", "servomill check part.cls part.csv",
          write={"part.cls": "GOTO/1,2,3,0,0,0\n", "part.csv": "x,y,z,i,j,k\n1,2,3,0,0\n"}),
    typed("no cutter locations", POST_IT, write={"part.cls": "PARTNO empty\nFINI\n"}),
    typed("a CSV table without a column", POST_IT.replace("cls", "csv"), write={"part.csv": "x,y,z,i,j\n"}),
    typed("a CSV table with wrong lines", POST_IT.replace("cls", "csv"),
          write={"part.csv": "x,y,z,i,j,k\n1,2,3,0,0\n1,2,3,0,0,0\n1,2,3,0,0,up\n"}),
    typed("odd cutter locations, which are post-processed all the same", POST_T + " -q --force",
          write={"part.cls": "MACHIN/ANY\nPAINT/PATH\nCOOLNT/THRU\nPAINT/PATH\nGOTO/0,0,10,0,0,1.1\nFINI\nGOTO/1,1,1\n",
                 "out.ngc": "(old)\n"}),
    typed("more odd tool axes than one wants to read of", POST_T + " -q",
          write={"part.cls": "FEDRAT/600\n" + "GOTO/0,0,10,0,0,1.1\n" * 23}, about="23 tool axes of length 1.1"),
    typed("a tool axis and a place that the machine does not have", POST_T,
          write={"part.cls": RIGHT + "GOTO/0,0,0,0,1,1\nGOTO/9999,0,0,0,0,1\n"}),
    typed("a place that the machine does not have behind an odd tool axis, which is reported, too", POST_T,
          write={"part.cls": "FEDRAT/600\nGOTO/0,0,10,0,0,2\nGOTO/9999,0,0\n"}),
    typed("no feed", POST_T, write={"part.cls": "GOTO/0,0,10\nGOTO/0,0,0\n"}),
    typed("a tool that the table lacks", POST_IT + " --tools tools.tbl", write={"part.cls": "LOADTL/7\n" + RIGHT,
                                                                              "tools.tbl": "T1 P1 Z100\n"}),
    typed("a tool without a length, and one that comes late", POST_IT, POST_IT.replace("part", "late") + " --tool-length 100",
          write={"part.cls": "LOADTL/7\n" + RIGHT, "late.cls": RIGHT + "LOADTL/7\nGOTO/1,0,0\n"}),
    typed("a program that is there already", "servomill post part.cls --machine machine.toml", POST_IT.replace("out.ngc", "''"),
          POST_IT.replace("out.ngc", "."), POST_IT.replace("out.ngc", "nowhere/out.ngc"), write={"part.cls": RIGHT}),
    typed("options of post that cannot be", "servomill post part.cls", "servomill post", POST_IT + " --tcp --classical",
          POST_IT + " --tools a.tbl --tool-length 100", POST_IT + " --tolerance 0", POST_IT + " --axis-tolerance nan",
          POST_IT + " --work-offset 1,2", POST_IT + " --work-offset 1,2,x", POST_IT + " --start Q=1", POST_IT + " --start A=10",
          POST_IT + " --start X=ten", POST_IT + " --work-system 60", POST_IT + " --feed -1", POST_IT + " --tool -1",
          POST_IT + " --approach sideways", POST_IT + " --clearance '0 mm'", POST_IT + " --retract up", POST_IT + " --retract Z=9999",
          POST_IT + " --approach direct --retract Z=10", POST_T + " --clearance '2 m'", POST_T + " --retract Z=15",
          POST_IT + " --tool-length '5 deg'", POST_IT + " --set structure=3", POST_IT + " --set axis.X.lead=3", POST_IT, POST_IT + " --tool 3",
          POST_IT + " --tool 0 --tool-length 5", write={"part.cls": RIGHT}),
    typed("a part and a tool that are nowhere on a machine with rotary axes", POST_IT, POST_IT + " --work-offset 0,0,0 --approach direct",
          write={"part.cls": RIGHT, "machine.toml": 'structure = "[w C\' A\' b X Y Z t]"\n'}),
    typed("a height that nobody has named", POST_IT, write={"part.cls": RIGHT, "machine.toml": 'structure = "[w b X Y Z t]"\n'}),
    typed("the machine of post", POST_IT.replace("machine.toml", "machin.toml"), POST_IT.replace("machine.toml", "part.ngc"),
          POST_IT.replace("machine.toml", "scenario.toml"), write={"part.cls": RIGHT}),
]

TABLE = "servomill table scenario.toml --format siemens -o out"

TABLES = [
    typed("tables in no format, to no folder, of no model", "servomill table scenario.toml -o out",
          "servomill table scenario.toml --format heidenhein -o out", "servomill table scenario.toml --format csv",
          TABLE + " --model imposd", "servomill table machine.toml --format csv -o out"),
    line("one of several error models", "[errors.imposed]", "[errors.true]\nEXX = { constant_um = 1.0 }\n[errors.imposed]",
         commands=[TABLE]),
    line("no error model for a table", '[errors.imposed]\nEYX = { harmonic = { amplitude_um = 150.0, period_mm = 62.0 } }', "",
         commands=["servomill table scenario.toml --format csv -o out --set 'imposed=\"\"' --set 'case=[{name=\"nominal\"}]' --set 'quantity=[]'"]),
    typed("tables of more points than the control takes", TABLE + " --spacing '4 mm'",
          "servomill table scenario.toml --format heidenhain -o out --spacing '3 mm'",
          TABLE + " --max-points 1", "servomill table scenario.toml --format heidenhain -o out --max-points 257"),
    typed("a spacing that is none", TABLE + " --spacing -5", TABLE + " --spacing '0 mm'", TABLE + " --spacing '5 deg'",
          TABLE + " --tool-length '-1 mm'"),
    typed("positions of axes that are none", TABLE + " --travel X", TABLE + " --travel X=10:-10", TABLE + " --travel C=0:10",
          TABLE + " --at X=middle", TABLE + " --at X=500", TABLE + " --axis Q"),
    typed("tables that can hold nothing of the model", "servomill table scenario.toml --format linuxcnc -o out",
          TABLE + " --axis Y"),
    typed("options that mean nothing", "servomill table scenario.toml --format linuxcnc -o out --comp-file-type 2",
          TABLE + " --comp-file-type 1", TABLE + " --rotary-spacing '1 deg'",
          "servomill table scenario.toml --format csv -o out --at Z=10", "servomill table scenario.toml --format csv -o out --tool-length '1 mm'"),
    typed("a file of error models that holds something else", "servomill table scenario.toml --machine machine.toml --format csv -o out",
          "servomill table errors.toml --machine machine.toml --format csv -o out --set a=1",
          "servomill table errors.toml --machine machine.toml --format csv -o out",
          write={"errors.toml": "[errors.found]\nEXC = { constant_um = 1.0 }\n"}),
    typed("tables where something stands already", TABLE + " -q", "servomill table scenario.toml --format siemens -o part.ngc",
          write={"out/NC_CEC.INI": "precious"}, about="a file"),
]

CASES = '[[case]]\nname = "nominal"'
LINE = 'line = { from_mm = [0, 0, -1], to_mm = [50, 0, -1], normal = [0, -1, 0], points = 6 }'

OTHER = '[[quantity]]\nname = "imposed_error_residual"\naxis = "Y"'


def probed(title, probes, *quantities, diameter="\ndiameter_mm = 8.0"):
    """A scenario with these tables before its cases, and quantities behind them."""
    edits = [("scenario.toml", "length_mm = 110.0", "length_mm = 110.0" + diameter),
             ("scenario.toml", CASES, probes + "\n" + CASES)]
    edits += [("scenario.toml", 'name = "imposed_error_residual"\naxis = "Y"', one) for one in quantities]
    return {"title": title, "edit": edits, "commands": CHECK}


def probe(keys, name="flank"):
    return f'[[probe]]\nname = "{name}"\n{keys}\n'


PROBES = [
    probed("a probe where nothing is cut", probe(LINE), diameter=""),
    probed("a probe that says nothing, and one that says too much", probe("") + probe(LINE + "\npoints_mm = []", "top")),
    probed("probes without names of their own", probe(LINE) + probe(LINE) + probe(LINE, "a/b")),
    probed("a line that is none", probe(LINE.replace("50,", "0,")) + probe(LINE.replace("points = 6", "points = 1"), "two")
           + probe(LINE.replace("[0, -1, 0]", "[1, 0, 0]"), "three") + probe(LINE.replace("[0, -1, 0]", "[0, 0, 0]"), "four")
           + probe(LINE.replace("[50, 0, -1]", "[50, 0]"), "five")),
    probed("a plane that is none", probe("plane = { corner_mm = [0, 0, 0], u_mm = [1, 0, 0], v_mm = [2, 0, 0], normal = [0, 0, 1], "
                                         "points = [3, 3] }")
           + probe("plane = { corner_mm = [0, 0, 0], u_mm = [1, 0, 0], v_mm = [0, 1, 0], normal = [0, 0, 1], points = [3, 1] }", "top")),
    probed("a circle that is none", probe("circle = { centre_mm = [0, 0, 0], radius_mm = 0, outside = true, points = 2 }")
           + probe("circle = { centre_mm = [0, 0, 0], radius_mm = 5, outside = true, points = 8, from_deg = 90, to_deg = 0 }", "two")
           + probe("cylinder = { centre_mm = [0, 0, 0], radius_mm = 5, outside = true, points = [8, 2], to_mm = 0 }", "three")),
    probed("points that are none", probe("points_mm = [[0, 0, 0, 0, 0, 1], [0, 0, 0, 0, 0, 0]]")),
    probed("a CMM that is none", probe(LINE) + "[cmm]\nuncertainty_um = -1\nrepetitions = 0\nprobe_radius = 1"),
    probed("quantities of probes that are wrong themselves", probe(LINE.replace("points = 6", "points = 1"))
           + probe(LINE.replace("[0, -1, 0]", "[0, 0, 0]"), "side") + probe("", "top"),
           'name = "straightness"\nprobe = "flank"\n[[quantity]]\nname = "angle"\nprobe = "side"\nto = "top"\n' + OTHER),
    probed("quantities where a probe has no name", probe(LINE, ""), 'name = "straightness"\nprobe = "flank"\n' + OTHER),
    probed("a quantity of a probe that is not there", probe(LINE), 'name = "straightness"\nprobe = "flnak"'),
    probed("a quantity of another kind of probe", probe(LINE), 'name = "flatness"\nprobe = "flank"'),
]

WRONG_INPUTS = (COMMAND_LINE + FILES + SCENARIO + MACHINE + AXIS + SET + MACHINE_REFUSES + PROGRAM + OUTPUT + SWEEP + SERVO + UNITS + POST + TABLES
                + COMPENSATE + CUTTING + PART + PROBES)
