"""The wrong inputs of the gallery: a title, what is changed, what is typed.

edit: (file, old text, new text); write: {file: content}; folders: made before; stdout: shown, too.
"""
from edits import CHECK, line, machine, typed
from wrong_cycle_times import CYCLE_TIMES
from wrong_experiments import EXPERIMENTS
from wrong_identified import IDENTIFIED
from wrong_machines import AXIS, HEAT, MACHINE, MACHINE_REFUSES, SERVO, STRUCTURE
from wrong_parts import CUTTING, PART, PROBES
from wrong_programs import COMPENSATE, POST, PROGRAM, TABLES
from wrong_readings import READINGS
from wrong_tests import TESTS

COMMAND_LINE = [
    typed("an unknown command", "servomill rnu scenario.toml", "servomill frobnicate"),
    typed("an unknown option", "servomill run scenario.toml --forse", "servomill --quiet", "servomill check -x",
          "servomill list strategies --markdown", "servomill table scenario.toml --json --import a.csv -o b.toml"),
    typed("an option without its value", "servomill run scenario.toml -o", "servomill run scenario.toml --set"),
    typed("a value of the wrong type", "servomill run scenario.toml --threads many",
          "servomill run scenario.toml --threads -1", "servomill run scenario.toml --force=yes"),
    typed("an empty name", "servomill run ''", "servomill run scenario.toml -o ''", "servomill check ''"),
    typed("no file, or too many", "servomill run", "servomill run scenario.toml machine.toml", "servomill check",
          "servomill compare", "servomill canon", "servomill sweep", "servomill list"),
    typed("instructions that there are not", "SERVOMILL_SIMD=avx servomill run scenario.toml", "SERVOMILL_SIMD=fast servomill list machines"),
    typed("something that cannot be listed", "servomill list strategy", "servomill list foo", "servomill list machines --folder nowhere",
          "servomill list machines", "servomill list keys machine.axis.Y.frction"),
    typed("a name where there is no folder of scenarios", "servomill run experiment1", "servomill check part.ngc --machine hsm600u"),
    typed("a result file of another format", "servomill run scenario.toml -o out.csv"),
    typed("a scenario where a machine is wanted", "servomill check part.ngc --machine scenario.toml"),
    line("a table in place of a list of tables", '[[case.strategy]]\ntype = "table"', '[case.strategy]\ntype = "table"'),
    line("keys without their unit, and of other quantities", "[[case]]", '[[quantity]]\nname = "cycle_time"\naxis = "Y"\n[[program.tool]]\nnumber = 9\n'
         'length = 50.0\n[[case]]'),
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
    line("a tool as long as none is", "length_mm = 110.0", "length_mm = 1e300"),
    line("a tool twice", "length_mm = 110.0", "length_mm = 110.0\n[[program.tool]]\nnumber = 1\nlength_mm = 90.0"),
    line("an unknown strategy", 'type = "table"', 'type = "tabel"'),
    line("an unknown error model", 'model = "imposed"', 'model = "imposd"'),
    line("no error models at all", '[errors.imposed]\nEYX = { harmonic = { amplitude_um = 150.0, period_mm = 62.0 } }', ""),
    line("an unknown error", "EYX", "EYQ"),
    line("an error of an axis that the machine does not have", "EYX", "EYC"),
    line("an error that names itself", "EYX = { harmonic = { amplitude_um = 150.0, period_mm = 62.0 } }", 'EYX = "EYX"'),
    line("a table of errors that does not rise", "harmonic = { amplitude_um = 150.0, period_mm = 62.0 }",
         "table = { at_mm = [0.0, 10.0, 5.0], value_um = [1.0, 2.0, 3.0] }"),
    line("a grid of errors that does not cover the travel", "harmonic = { amplitude_um = 150.0, period_mm = 62.0 }",
         'grid = { axes = "XZ", at_mm = [[-400, 400], [0, 10]], value_um = [[0, 1], [2, 3]] }'),
    line("a grid of errors over an axis that the machine does not have", "harmonic = { amplitude_um = 150.0, period_mm = 62.0 }",
         'grid = { axes = "XC", at_mm_deg = [[-400, 400], [0, 10]], value_um = [[0, 1], [2, 3]] }'),
    line("a grid of errors without a value", "harmonic = { amplitude_um = 150.0, period_mm = 62.0 }",
         'grid = { axes = "X", at_mm = [[-400, 0, 400]], value_um = [0, 1] }'),
    line("a case twice", 'name = "table"', 'name = "nominal"'),
    line("a case whose name is a path", 'name = "table"', 'name = "../table"'),
    line("a case without a name", 'name = "table"', 'name = ""'),
    line("an unknown case in a quantity", 'cases = ["table"]', 'cases = ["tabel"]'),
    line("an unknown quantity", 'name = "imposed_error_residual"', 'name = "imposed_error_residuals"'),
    line("an uncertainty of a machine without covariance", 'name = "imposed_error_residual"\naxis = "Y"\nbaseline = "nominal"',
         'name = "tool_deviation_uncertainty"\naxis = "Y"'),
    line("a tolerance of nothing", 'axis = "Y"\nbase', 'tolerance = 0.0\naxis = "Y"\nbase'),
    line("a tolerance with its limits exchanged", 'axis = "Y"\nbase', 'tolerance = [3.0, -3.0]\naxis = "Y"\nbase'),
    line("an axis that the quantity does not have", 'axis = "Y"\nbase', 'axis = "C"\nbase'),
    machine("an axis that the machine does not have", '"[w X b Y Z t]"', '"[w X b Z t]"'),
    line("a section that is not a circle", 'name = "imposed_error_residual"\naxis = "Y"\nbaseline = "nominal"',
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
    line("feedback that compensates its lag twice", '[[case.strategy]]\ntype = "table"', '[[case.strategy]]\ntype = "feedback"\nmodel = "imposed"\nprediction = "loop"\nextrapolation_time_ms = "auto"\n[[case.strategy]]\ntype = "table"'),
    line("a machine known to feedback without a prediction", '[[case.strategy]]\ntype = "table"', '[[case.strategy]]\ntype = "feedback"\nmodel = "imposed"\nmachine = { nc.Kv = "50 1/s" }\n[[case.strategy]]\ntype = "table"'),
    line("feedback without its hardware", '[[case.strategy]]\ntype = "table"', 'feedback_hardware = false\n[[case.strategy]]\ntype = "feedback"\nmodel = "imposed"\n[[case.strategy]]\ntype = "table"'),
    line("a recorder period that is no multiple", "period_ms = 1.0", "period_ms = 1.005"),
    line("a recorder period of the wrong type", "period_ms = 1.0", "period_ms = true"),
    line("a recorder period of nothing", "period_ms = 1.0", "period_ms = 0"),
    line("a recorder period that seldom meets the loops", "period_ms = 1.0", "period_ms = 7919.01"),
    line("windows of nothing", "period_ms = 1.0", "period_ms = 1.0\nwindows = {}"),
    line("windows of times that end before they begin", "period_ms = 1.0",
         "period_ms = 1.0\nwindows = { time_s = [[0, 1], [12, 10]] }"),
    line("windows of times that are no pairs", "period_ms = 1.0", "period_ms = 1.0\nwindows = { time_s = [0, 1] }"),
    line("passes of no section", "period_ms = 1.0", "period_ms = 1.0\nwindows = { time_s = [[0, 1]], every = 10 }"),
    line("no pass at all", "period_ms = 1.0", 'period_ms = 1.0\nwindows = { sections = ["flank"], every = 0 }'),
    line("a window of a section that the program does not have", "period_ms = 1.0",
         'period_ms = 1.0\nwindows = { sections = ["flnak"] }'),
    {"title": "a circle outside the windows of the recording",
     "edit": [("scenario.toml", "period_ms = 1.0", "period_ms = 1.0\nwindows = { time_s = [[0, 1]] }"),
              ("scenario.toml", 'name = "imposed_error_residual"\naxis = "Y"\nbaseline = "nominal"', 'name = "circular_error"')],
     "commands": CHECK},
    {"title": "a window with a part that is probed",
     "edit": [("scenario.toml", "length_mm = 110.0", "length_mm = 110.0\ndiameter_mm = 8.0"),
              ("scenario.toml", "[record]", '[[probe]]\nname = "top"\npoints_mm = [[5.0, 5.0, 0.0, 0.0, 0.0, 1.0]]\n[record]'),
              ("scenario.toml", "period_ms = 1.0", 'period_ms = 1.0\nwindows = { sections = ["flank"] }')],
     "commands": CHECK},
    line("an ideal servo recorded between its position periods", 'name = "nominal"', 'name = "nominal"\nservo = "ideal"', "scenario.toml",
         ["servomill check scenario.toml --set record.period_ms=0.13"]),
    line("a run that no memory holds", "feed_override = 1.0", "feed_override = 1e-9", "scenario.toml",
         ["servomill check scenario.toml"]),
    line("a delay that is no multiple", "signal_delay_us = 10.0", "signal_delay_us = 12.0"),
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

def recording(title, content, *more):
    return typed(title, "servomill recording record.csv", *more, write={"record.csv": content})


RECORDINGS = [
    typed("no recording, and two for one output", "servomill recording", "servomill recording nothing.csv",
          "servomill recording a.csv b.csv -o out.csv"),
    recording("a recording in a file of another kind", "PK\x03\x04\x14\x00"),
    recording("a recording in UTF-16", "t;x\n0;1\n".encode("utf-16")),
    recording("a recording without a row of numbers", "time;x\nstarted;stopped\n"),
    recording("an empty recording", ""),
    recording("a recording without a channel", "t [s]\n0\n1\n"),
    recording("a recording with a name twice", "t [s];x;x\n0;1;2\n1;2;3\n"),
    recording("a recording with a row of another length", "t [s];x\n0;1\n1;2;3\n2;3\n"),
    recording("a recording that is cut off", "t [s];x;y\n0;1;2\n1;2;3\n2;3"),
    recording("a recording with a word for a number", "t [s];x\n0;1\n1;off\n2;3\n"),
    recording("a recording with an infinite value", "t [s];x\n0;1\n1;inf\n2;3\n"),
    recording("a recording in which time runs backwards", "t [ms];x\n0;1\n2;2\n1;3\n"),
    recording("a recording with an instant twice", "t [ms];x\n0;1\n1;2\n1;3\n"),
    recording("a recording with a row without its time", "t [ms];x\n0;1\n;2\n2;3\n"),
    recording("a recording with a time in mm", "t [mm];x\n0;1\n1;2\n"),
    recording("a unit of time for a file that has one, and one that there is not", "t [s];x\n0;1\n1;2\n",
              "servomill recording record.csv --time-unit ms", "servomill recording record.csv --time-unit mm"),
    recording("a recording of MATLAB that is cut off", b"MATLAB 5.0 MAT-file" + b" " * 105 + b"\x00\x01IM" + b"\x0e\x00\x00\x00\x40\x00\x00\x00\x06"),
    recording("a frequency measurement of a Sinumerik control that is cut off",
              '<?xml version="1.0"?>\n<ResponseTestCustom>\n  <float name="m_dProc'),
    recording("a frequency measurement of a Sinumerik control without a signal", '<?xml version="1.0"?>\n<ResponseTestCustom>\n</ResponseTestCustom>\n'),
    recording("a recording of TNCscope with fewer samples than it says", "%[GLOBAL]\n%[CURVE1]\n%CHANNELTYPE=s actual\n%AXISTYPE=X\n%COUNT=3\n%CYCLETIME=3000\n%[DATA]\n0;1\n3000;2\n"),
    recording("a recording of TNCscope without data", "%[GLOBAL]\n%[CURVE1]\n%COUNT=3\n"),
    recording("a trace of a Sinumerik control in which time runs backwards",
              '<traceData><dataFrame>\n<dataSignal name="/a"/>\n<rec time="0.002" f1="1"/>\n<rec time="0" f1="2"/>\n</dataFrame></traceData>\n'),
    recording("a trace of a Sinumerik control that is cut off", '<traceData><dataFrame>\n<dataSignal name="/a"/>\n<rec time="0" f1="1"/>\n<rec time="0.002'),
    recording("an export of TwinCAT Scope with a row that is cut off", "Name\tx\tName\ty\n0\t1\t0\t2\n1\t1\t1\n"),
    recording("an export of TwinCAT Scope in which the time of one group runs backwards", "Name\tx\tName\ty\n0\t1\t3\t2\n1\t1\t2\t2\n"),
    recording("a recording of halscope with another pin in a row", "Sampling period is 1000000 nSec\nx 1 y 2\nx 1 z 2\n"),
    recording("a recording of halscope that is cut off", "Sampling period is 1000000 nSec\nx 1 y 2\nx 1 y"),
    recording("samples of halsampler that were lost and are not numbered", "0.5 1\noverrun\n0.25 1\n"),
    recording("sample numbers of halsampler that run backwards", "0 0.5\n1 0.25\n2 0.1\n1 0.2\n"),
    recording("a recording of camonitor in which time runs backwards", "ax:pos 2024-03-01 10:00:01.500 1\nax:pos 2024-03-01 10:00:00.500 2\n"),
    recording("a recording of camonitor that is cut off", "ax:pos 2024-03-01 10:00:00.500 1\nax:pos 2024-03-01 10:00:01.500 2"),
    recording("a recording with several rates as one table", "Name\tx\tName\ty\n0\t1\t0\t2\n1\t1\t2\t2\n", "servomill recording record.csv -q -o out.csv"),
    recording("a recording that cannot be written", "t [s];x\n0;1\n1;2\n", "servomill recording record.csv -q -o record.csv -f",
              "servomill recording record.csv -q -o out.mat", "servomill recording record.csv -q -o ''"),
]

SOFT = "drive = \"two_mass\"\nstiffness = 180\ndamping = 1000"

UNITS = [
    {"title": "a stiffness in N/um without its unit", "commands": ["servomill check machine.toml"],
     "edit": [("machine.toml", 'drive = "rigid"', SOFT)]},
    {"title": "bare numbers that no machine has, of a machine that is stable", "commands": ["servomill check machine.toml", "servomill run scenario.toml -q -o out.h5"],
     "edit": [("machine.toml", 'v_max = "40 m/min"', "v_max = 40000")]},
]

WRONG_INPUTS = (COMMAND_LINE + FILES + SCENARIO + MACHINE + STRUCTURE + HEAT + AXIS + SET + MACHINE_REFUSES + IDENTIFIED + EXPERIMENTS + TESTS + READINGS + PROGRAM + OUTPUT + SWEEP + SERVO + UNITS + POST + TABLES
                + COMPENSATE + CYCLE_TIMES + CUTTING + PART + PROBES + RECORDINGS)
