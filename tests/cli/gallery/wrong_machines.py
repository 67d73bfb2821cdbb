"""Wrong machines: what their files may say, and what their drives and loops cannot be."""
from edits import CHECK, line, machine, program, typed

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


def structure(title, text):
    """A machine that gives way to the acceleration of its axes."""
    return machine(title, "[axis.X]\n", "[inertial_deflection]\n" + text + "\n[axis.X]\n")


def mode(title, text):
    """A machine whose tool point vibrates."""
    return machine(title, "[axis.X]\n", "[[structural_mode]]\n" + text + "\n[axis.X]\n")


def heat(title, text):
    """A machine that warms up."""
    return machine(title, "[axis.X]\n", "[heat]\n" + text + "\n[axis.X]\n")


HEAD = "surroundings = { room = { mean_degC = 20.0 } }\n[heat.body.head]\ncapacity_J_per_K = 5e4\nconductance_W_per_K = { room = 10.0 }\n"
HEAT = [
    heat("heat: a body that nothing cools", "surroundings = { room = {} }\n[heat.body.head]\ncapacity_J_per_K = 5e4"),
    heat("heat: a network that is not passive", HEAD.replace("room = 10.0", "room = -10.0")),
    heat("heat: a link to a body that there is not", HEAD.replace("{ room = 10.0", "{ room = 10.0, colum = 5.0")),
    heat("heat: a source of no body and no axis", HEAD + '[heat.source]\ns = { body = "spindle", kind = "motor", axis = "W", resistance = 1.0 }'),
    heat("heat: more than all of the cutting power, and a part of no body", 'part = { body = "vice", expansion = "23.5 um/m/K", fixed_at_mm = [0.0] }\n' + HEAD +
         '[heat.source]\nchips = { body = "head", kind = "cutting", share = 0.8 }\ntool = { body = "head", kind = "cutting", share = 0.3 }'),
    heat("heat: a room above the limits", HEAD.replace("20.0", "120.0")),
    heat("heat: an error that the machine cannot have", HEAD + "errors_per_K = { EXA = { constant_um = 1.0 } }"),
]

STRUCTURE = [
    table_of_axis("bed: a mass that is none", '[axis.X.machine_bed]\nmass = 0.0\nfrequency_Hz = 18.0\ndamping = 0.04'),
    table_of_axis("bed: a mode that does not swing", '[axis.X.machine_bed]\nmass = 5500.0\nfrequency_Hz = 0.0\ndamping = 1.0'),
    table_of_axis("bed: a mode above what the base period resolves", '[axis.X.machine_bed]\nmass = 5500.0\nfrequency_Hz = 6000.0\ndamping = 0.04'),
    machine("bed: under a slide of unknown mass", 'moving_mass = "750 kg"', 'machine_bed = { mass = 5500.0, frequency_Hz = 18.0, damping = 0.04 }'),
    machine("structural mode: nothing is as it must be", "[axis.X]\n", '[[structural_mode]]\ndirection = [0.0, 0.0, 0.0]\nstiffness = -5e7\ndamping = 0.05\n[[structural_mode]]\ndirection = "X"\nfrequency_Hz = 60.0\n\n[axis.X]\n'),
    mode("a mode of the tool point that does not vibrate", "direction = [0, 0, 0]\nstiffness = 2e7\nfrequency_Hz = 0.0\ndamping = 1.0"),
    structure("inertia: axes that the machine does not have", "BX = { gain_um_per_m_s2 = 1.0 }\nXC = { gain_um_per_rad_s2 = 1.0 }"),
    structure("inertia: a mode above what the loops resolve", "XX = { gain_um_per_m_s2 = 1.0, frequency_Hz = 800.0, damping = 0.05 }"),
    structure("inertia: neither a mode nor static", "XX = { gain_um_per_m_s2 = 1.0, frequency_Hz = 60.0 }\nYY = { gain_um_per_m_s2 = 1.0, damping = 0.05 }"),
    structure("inertia: a mode that does not vibrate", "XX = { gain_um_per_m_s2 = 1.0, frequency_Hz = -60.0, damping = 1.5 }"),
    structure("inertia: another frequency, without a unit", "XX = { gain_um_per_m_s2 = 1.0, frequency = 60.0, damping = 0.05 }"),
    structure("inertia: a stiffness in place of a gain", "XX = { stiffness = 5e7 }"),
    structure("inertia: a gain over no position", 'XX = { gain_um_per_m_s2 = 1.0, slope_um_per_m_s2_per_m = 0.5 }\nYY = { gain_um_per_m_s2 = 1.0, along = "C", slope_um_per_m_s2_per_m = 1.0 }'),
]

AXIS = [
    table_of_axis("friction: no breakaway for LuGre", FRICTION.replace('"560 N"', '"0 N"')),
    table_of_axis("friction: viscous friction below 0", FRICTION + 'viscous_negative = "-1 N s/m"\n'),
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

BODE, STEP, TUNE = (f"servomill {command} scenario.toml --axis Y" for command in ("bode", "step", "tune"))
FMU = "servomill fmu scenario.toml --axis Y -o y.fmu"
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
    typed("an axis that cannot be exported", "servomill fmu scenario.toml --axis Y", "servomill fmu scenario.toml -o y.fmu",
          FMU.replace(" Y ", " A "), FMU + " --fmi 1", FMU + " --case tabel",
          FMU.replace(".fmu", ".zip"),
          FMU + " --set machine_override.integrator='\"cvode\"'"),
    line("an ideal servo, which has no loops to be exported", 'name = "nominal"', 'name = "nominal"\nservo = "ideal"', "scenario.toml",
         [FMU + " --case nominal"]),
    typed("margins that cannot be", TUNE + " --phase-margin 90", TUNE + " --gain-margin 0", TUNE + " --overshoot 100",
          TUNE + " --bandwidth -5", TUNE + " --phase-margin 85"),
    typed("a file to write responses to that cannot be had", BODE + " --method none -o scenario.toml",
          STEP + " -o nowhere/out.h5"),
]
