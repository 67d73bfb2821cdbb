#include "sim/input/key_specimens.h"

namespace servomill::sim::input {
namespace {

constexpr std::string_view kFirst = R"(
title = "first"
machine_errors = "NAME"
imposed = "NAME"

[machine]
name = "first"
structure = "[w C' b X Y Z t]"
structural_mode = [{ direction = [1.0, 0.0, 1.0], stiffness = 5e7, frequency_Hz = 60.0, damping = 0.05 }]
[machine.nc]
Kv = 50.0
spindle = { acceleration_rpm_per_s = 1500.0, Kv = 30.0, velocity_feed_forward = 0.5 }
[machine.axis.X]
drive = "two_mass"
lead_mm = 20.0
motor_inertia = 9.6e-3
moving_mass = 750.0
stiffness = 2.2e8
damping = 4.0e4
structural_stiffness = 5e7
machine_bed = { mass = 9000.0, frequency_Hz = 20.0, damping = 0.05 }
Kt = 1.6
i_max_A = 50.0
current_loop = "pi"
winding = { inductance = 5e-3, resistance = 0.5, bandwidth = 3000.0 }
velocity_bandwidth = 200.0
travel_mm = [-400.0, 400.0]
centre_mm = [0.0, 0.0, 0.0]
v_max = 0.6
a_max = 6.0
j_max = 100.0
[machine.axis.X.friction]
model = "lugre"
coulomb = 450.0
breakaway = 560.0
coulomb_negative = 440.0
breakaway_negative = 550.0
viscous = 100.0
viscous_negative = 150.0
stribeck_velocity = 0.002
bristle_stiffness = 5e7
bristle_damping = 3e4
[[machine.axis.X.filter]]
type = "notch"
frequency_Hz = 300.0
width_Hz = 50.0
[[machine.axis.X.filter]]
type = "low_pass"
frequency_Hz = 900.0
[[machine.axis.X.filter]]
type = "low_pass_2"
frequency_Hz = 900.0
[[machine.axis.X.filter]]
type = "lead_lag"
zero_Hz = 100.0
pole_Hz = 200.0
[machine.axis.X.friction_compensation]
coulomb = 450.0
[machine.axis.X.backlash_compensation]
width = 5e-6
[machine.axis.X.scale]
period = 20e-6
subdivision = 1024
[machine.axis.X.motor]
periods_per_revolution = 2048
[machine.axis.X.marks]
increment = 1000
[machine.axis.X.screw]
lead_error = { um_per_m = 10.0 }

[machine.axis.Y]
drive = "direct"
motor_inertia = 10.0
moving_mass = 300.0
Kt = 100.0
i_max_A = 50.0
velocity_bandwidth = 200.0
v_max = 0.6
a_max = 6.0
j_max = 100.0
cogging = { amplitude = 5.0, period = 0.03 }
motor = { period = 1e-3 }

[machine.axis.Z]
drive = "rigid"
lead_mm = 10.0
motor_inertia = 9.6e-3
moving_mass = 300.0
Kt = 1.6
i_max_A = 50.0
velocity_bandwidth = 200.0
retract_mm = 100.0
v_max = 0.6
a_max = 6.0
j_max = 100.0
[machine.axis.C]
drive = "two_mass"
ratio = 0.01
motor_inertia = 1e-3
moving_inertia = 1.0
stiffness = 1e6
damping = 100.0
Kt = 1.0
i_max_A = 20.0
velocity_bandwidth = 200.0
travel_deg = [-360.0, 360.0]
friction = { model = "set_valued", coulomb = 2.0, breakaway = 2.0, coulomb_negative = 2.0, breakaway_negative = 2.0 }
friction_compensation = { coulomb = 2.0 }
backlash_compensation = { width = 1e-5 }
scale = { period = 1e-3 }
direction = [0.0, 0.0, 1.0]
v_max = 2.0
a_max = 20.0
j_max = 400.0
[machine.inertial_deflection]
XX = { gain_um_per_m_s2 = 1.0, frequency_Hz = 60.0, damping = 0.05, along = "Z", slope_um_per_m_s2_per_m = 0.5 }
ZC = { gain_um_per_rad_s2 = 0.1, along = "Z", slope_um_per_rad_s2_per_m = 0.1 }

[program]
file = "first.ngc"
text = "M2\n"
text_checksum = "f8ed25696332cceb"
subroutines = { NAME = "O<NAME> sub\nO<NAME> endsub\n" }
parameters = { "#101" = 1.0 }
work_offset = { X_mm = 0.0 }
start = { X_mm = 0.0 }
[[program.tool]]
number = 1
length_mm = 110.0
diameter_mm = 8.0
teeth = 4

[errors.NAME.EXX]
constant_um = 1.0
um_per_m = 1.0
polynomial_um = [0.0, 1.0]
harmonic = { amplitude_um = 1.0, period_mm = 60.0 }
table = { at_mm = [0.0, 1.0], value_um = [0.0, 1.0] }
reversal = { width_um = 1.0, width_polynomial_um = [1.0], distance_mm = 0.1 }
grid = { axes = "XZ", at_mm = [[-400, 400], [-400, 400]], value_um = [[0, 0], [0, 1]], interpolation = "linear" }
[errors.NAME.EAX]
constant_urad = 1.0
polynomial_urad = [0.0, 1.0]
harmonic = [{ amplitude_urad = 1.0, period_mm = 60.0 }]
table = { at_mm = [0.0, 1.0], value_urad = [0.0, 1.0] }
reversal = { width_urad = 1.0, width_polynomial_urad = [1.0], distance_mm = 0.1 }
grid = { axes = "XC", at_mm_deg = [[-400, 400], [-1e4, 1e4]], value_urad = [[0, 0], [0, 1]] }
[errors.NAME.EXC]
grid = { axes = "C", at_deg = [[-1e4, 1e4]], value_um = [0, 1] }
harmonic = { amplitude_um = 1.0, period_deg = 360.0 }
table = { at_deg = [0.0, 1.0], value_um = [0.0, 1.0] }
reversal = { width_um = 1.0, distance_deg = 0.1 }
[errors.NAME]
EYX = "EXX"
EX0C = { constant_um = 1.0 }
EY0C = "1 um"
EC0Y = { um_per_m = 1.0 }
EA0C = { constant_urad = 1.0 }
EB0Z = "1 urad"
[errors.OTHER]
relative_to = "NAME"

[part]
[[part.stock]]
box = { from_mm = [0, 0, 0], to_mm = [1, 1, 1] }
[[part.stock]]
cylinder = { centre_mm = [0, 0], radius_mm = 1, from_mm = 0, to_mm = 1 }

[touch_probe]
stylus_diameter_mm = 6
stylus_offset_um = [1, 2, 3]
tool_length_to = "end"
pretravel_um = 5
lobing_um = 1
lobes = 3
lobing_phase_deg = 30
repeatability_um = 0.5
delay_us = 4
seed = 2
workpiece = "stock"
workpiece_shift_mm = [0, 0, 0.1]
workpiece_rotation_deg = [0, 0, 1]
[[touch_probe.sphere]]
centre_mm = [0, 0, 0]
diameter_mm = 25
[[touch_probe.plane]]
point_mm = [0, 0, 0]
normal = [0, 0, 1]
[[touch_probe.bore]]
centre_mm = [0, 0]
diameter_mm = 50
from_mm = -20
to_mm = 0

[cutting]
material = "42CrMo4"
force = "instantaneous"

[[probe]]
name = "line"
line = { from_mm = [0, 0, 0], to_mm = [1, 0, 0], normal = [0, 0, 1], points = 2 }
[[probe]]
name = "plane"
plane = { corner_mm = [0, 0, 0], u_mm = [1, 0, 0], v_mm = [0, 1, 0], normal = [0, 0, 1], points = [2, 2] }
[[probe]]
name = "circle"
circle = { centre_mm = [0, 0, 0], radius_mm = 1, outside = false, points = 3 }
[[probe]]
name = "arc"
circle = { centre_mm = [0, 0, 0], radius_mm = 1, outside = false, from_deg = 10, points = 3 }
[[probe]]
name = "cylinder"
cylinder = { centre_mm = [0, 0, 0], radius_mm = 1, outside = false, from_deg = 10, to_mm = 1, points = [3, 2] }
[[probe]]
name = "notch"
notch = { from_mm = [0, 0, 0], to_mm = [1, 0, 0], width_mm = 1, points = 1 }
[[probe]]
name = "points"
points_mm = [[0, 0, 0, 0, 0, 1]]

[[case]]
name = "nominal"
work_offset = { C_deg = 0.0 }
machine_errors = ""
strategy = [{ type = "learning", machine = { nc = { Kv = 60.0 } }, recording = [{ file = "run.csv", measured = { X = "a" }, reference = { X = "r" } }, { file = "run.h5", case = "one" }] }]
[[case]]
name = "other"
wear = 1.5
machine_override = { nc = { Kv = 60.0 } }
[[case.strategy]]
type = "feedback"
model = "NAME"

[[quantity]]
name = "imposed_error_residual"
axis = "X"
baseline = "nominal"
sections = ["SECTION"]
basis = "predicted"
[[quantity]]
name = "circular_error"
sections = ["SECTION"]
[[quantity]]
name = "straightness"
probe = "line"
tolerance = 20.0
[[quantity]]
name = "probed_deviation"
probe = "line"
baseline = "nominal"
[[quantity]]
name = "squareness"
probe = "line"
to = "plane"
[[quantity]]
name = "distortion"
[[quantity]]
name = "ball_bar_deviation"
bar = [{ section = "SECTION", centre_mm = [0, 0, 0] }]
[[quantity]]
name = "location_error"
sections = ["SECTION"]
error = "EX0C"

[sweep]
samples = { design = "sobol", count = 2, from = "identified.toml", into = "drawn", identified = [{ keys = ["errors.NAME.EC0Y.constant_urad"], units = ["urad"], values = [300], covariance = [[1]] }] }
"program.feed_override" = { linear = [0.5, 1.0], count = 2 }
"machine.nc.Kv" = { log = [10.0, 100.0], count = 2 }
"errors.NAME.EXX.constant_um" = { normal = [1.0, 0.1] }
"errors.NAME.EXX.um_per_m" = { uniform = [1.0, 2.0] }
"record.period_ms" = { log_uniform = [1.0, 2.0] }
"machine.nc.preset" = { choice = ["CC422", "CC424"] }
[[sweep.zip]]
"machine.axis.X.v_max" = [0.1, 0.2]
"machine.axis.Y.v_max" = [0.1, 0.2]
)";

constexpr std::string_view kSecond = R"(
title = "second"

[machine]
name = "second"
structure = "[w C' b X Y Z t]"
friction_model = "set_valued"
[machine.nc]
preset = "CC422"
Kv = 40.0
velocity_feed_forward = 0.5
acceleration_feed_forward = 0.5
position_feedback = "crossover"
crossover_Hz = 30.0
nominal_filter = "mean"
nominal_filter_ms = 5.4
following_error_limit_mm = 5.0
following_error_limit_deg = 0.4

[machine.axis.X]
lead_mm = 20.0
motor_inertia = 9.6e-3
moving_mass = 750.0
stiffness = 2.2e8
damping = 4.0e4
Kt = 1.6
i_max_A = 50.0
velocity_bandwidth = 50.0
travel_mm = [-300.0, 300.0]
v_max = 0.6
a_max = 6.0
j_max = 100.0
friction = { coulomb = 400.0, breakaway = 400.0 }
scale = { period = 20e-6 }
motor = { period = 1e-3 }
marks = { increment = 1000 }
friction_compensation = { coulomb = 440.0 }

[machine.axis.Y]
drive = "rigid"
lead_mm = 10.0
motor_inertia = 9.6e-3
moving_mass = 300.0
Kt = 1.6
i_max_A = 50.0
velocity_bandwidth = 50.0
v_max = 0.6
a_max = 6.0
j_max = 100.0
friction = { model = "regularised", coulomb = 300.0, regularisation_velocity = 1e-4 }

[machine.axis.Z]
drive = "rigid"
lead_mm = 10.0
motor_inertia = 9.6e-3
moving_mass = 300.0
Kt = 1.6
i_max_A = 50.0
velocity_bandwidth = 50.0
v_max = 0.6
a_max = 6.0
j_max = 100.0
friction = { model = "set_valued", coulomb = 300.0, breakaway = 310.0, stribeck_velocity = 1e-3 }

[machine.axis.C]
drive = "direct"
motor_inertia = 1.0
moving_inertia = 1.0
Kt = 10.0
i_max_A = 20.0
velocity_bandwidth = 50.0
v_max = 2.0
a_max = 20.0
j_max = 400.0
friction = { coulomb = 1.0 }
cogging = { amplitude = 5.0, period = 0.03 }
scale = { periods_per_revolution = 18000 }

[program]
file = "second.ngc"
text = "M2\n"
[[program.tool]]
number = 1
length_mm = 110.0
diameter_mm = 10.0

[feedback_hardware]
connected = true

[part]
stl = "second.stl"
stl_base64 = "c29saWQgc3BlY2ltZW4KZmFjZXQgbm9ybWFsIDAgMCAtMQpvdXRlciBsb29wCnZlcnRleCAwIDAgMAp2ZXJ0ZXggMCAxMDAgMAp2ZXJ0ZXggMTAwIDAgMAplbmRsb29wCmVuZGZhY2V0CmZhY2V0IG5vcm1hbCAwIC0xIDAKb3V0ZXIgbG9vcAp2ZXJ0ZXggMCAwIDAKdmVydGV4IDEwMCAwIDAKdmVydGV4IDAgMCAxMDAKZW5kbG9vcAplbmRmYWNldApmYWNldCBub3JtYWwgLTEgMCAwCm91dGVyIGxvb3AKdmVydGV4IDAgMCAwCnZlcnRleCAwIDAgMTAwCnZlcnRleCAwIDEwMCAwCmVuZGxvb3AKZW5kZmFjZXQKZmFjZXQgbm9ybWFsIDEgMSAxCm91dGVyIGxvb3AKdmVydGV4IDEwMCAwIDAKdmVydGV4IDAgMTAwIDAKdmVydGV4IDAgMCAxMDAKZW5kbG9vcAplbmRmYWNldAplbmRzb2xpZCBzcGVjaW1lbgo="
stock = [{ box = { from_mm = [0, 0, 0], to_mm = [1, 1, 1] } }]

[cutting]
Ktc = 2e9
Krc = 1e9
Kac = 4e8
Kte = 4e4
Kre = 5e4
Kae = 1e4
wear = 2.0

[[probe]]
name = "line"
line = { from_mm = [10, 0, 10], to_mm = [40, 0, 10], normal = [0, -1, 0], points = 2 }

[[case]]
name = "nominal"
)";

}  // namespace

std::array<std::string_view, 4> key_specimens() {
  return {kFirst, kSecond, third_specimen(), test_specimen()};
}

}  // namespace servomill::sim::input
