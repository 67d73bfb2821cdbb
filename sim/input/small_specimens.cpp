// Specimens that show single keys: a machine with one axis and heat, identified values.
#include "sim/input/key_specimens.h"

namespace servomill::sim::input {
namespace {

constexpr std::string_view kThird = R"(
title = "third"
sweep.samples = { count = 2, from = ["a.toml"], identified = [{ keys = ["nc.Kv"], units = ["1/s"], values = [50.0], covariance = [[1]] }] }

[machine]
structure = "[w C' b Z t]"
[machine.nc]
Kv = 50.0
[machine.axis.Z]
drive = "rigid"
lead_mm = 10.0
motor_inertia = 9.6e-3
moving_mass = 300.0
Kt = 1.6
i_max_A = 50.0
velocity_bandwidth = 200.0
v_max = 0.6
a_max = 6.0
j_max = 100.0

[machine.axis.C]
drive = "rigid"
ratio = 1.0
motor_inertia = 1.0
moving_inertia = 1.0
Kt = 10.0
i_max_A = 20.0
velocity_bandwidth = 200.0
v_max = 2.0
a_max = 20.0
j_max = 400.0

[machine.heat]
reference_degC = 20.0
start_degC = 20.0
clock_h = 7.0
noise_seed = 1
surroundings = { room = { mean_degC = 20.0, amplitude_K = 1.0, period_h = 24.0, warmest_at_h = 15.0 } }
part = { body = "head", expansion = "11.5 um/m/K", fixed_at_mm = [0.0, 0.0, 0.0] }
[machine.heat.body.head]
capacity_J_per_K = 5e4
winding = false
conductance_W_per_K = { room = 10.0 }
errors_per_K = { EZZ = { constant_um = 1.0 } }
[machine.heat.sensor]
NAME = { body = "head", noise_K = 0.05, errors_per_K = { EZZ = { constant_um = 1.0 } } }
[machine.heat.source]
pump = { body = "head", kind = "constant", power_W = 10.0 }
bearings = { body = "head", kind = "spindle", speed_rpm = [0, 1000], power_W = [0, 10.0] }
motor = { body = "head", kind = "motor", axis = "Z", resistance = 1.0 }
chips = { body = "head", kind = "cutting", share = 0.1 }
nut = { body = "head", kind = "friction", axis = "Z", share = 0.5 }

[program]
file = "third.ngc"
text = "M2\n"

[day]
sample_min = 1.0
probe_noise_um = 0.5
noise_seed = 1
remeasure = { place = "table", every_min = 30.0, duration_min = 2.0 }
[[day.place]]
name = "table"
at = { Z_mm = 0.0, C_deg = 0.0 }
tool_length_mm = 100.0
[[day.phase]]
activity = "spindle"
duration_min = 15.0
speed_rpm = 6000.0
[[day.phase]]
activity = "program"
cycles = 10
[[day.phase]]
activity = "probe"
place = "table"

[record.windows]
sections = ["SECTION"]
time_s = [[0, 1], [10, 12]]
every = 10
[[case]]
name = "nominal"
)";

// Tests of a machine, which make their own program.
constexpr std::string_view kTests = R"(
title = "tests"

[machine]
structure = "[w C Y X b t]"
[machine.nc]
Kv = 50.0
[machine.axis.X]
drive = "rigid"
lead_mm = 10.0
motor_inertia = 9.6e-3
moving_mass = 300.0
Kt = 1.6
i_max_A = 50.0
velocity_bandwidth = 200.0
travel_mm = [-100.0, 100.0]
v_max = 0.6
a_max = 6.0
j_max = 100.0

[machine.axis.Y]
drive = "rigid"
lead_mm = 10.0
motor_inertia = 9.6e-3
moving_mass = 300.0
Kt = 1.6
i_max_A = 50.0
velocity_bandwidth = 200.0
travel_mm = [-100.0, 100.0]
v_max = 0.6
a_max = 6.0
j_max = 100.0

[machine.axis.C]
drive = "rigid"
ratio = 1.0
motor_inertia = 1.0
moving_inertia = 1.0
Kt = 12.0
i_max_A = 50.0
velocity_bandwidth = 200.0
v_max = 6.0
a_max = 60.0
j_max = 1000.0

[program]
[[program.tool]]
number = 1
length_mm = 100.0

[[test]]
name = "X"
standard = "iso230-2"
axis = "X"
from_mm = 0.0
to_mm = 50.0
target_count = 5
target_spread_mm = 1.0
runs = 5
overrun_mm = 1.0
feed = 0.02
dwell_s = 1.0
tool = 0
seed = 1
[test.at]
[test.device]
scale_uncertainty_um_per_m = 0.3
target_uncertainty_um = 0.1
resolution_um = 0.01
misalignment_mrad = 0.5
coefficient_per_K = 11.7e-6
coefficient_uncertainty_per_K = 0.6e-6
temperature_degC = 21.0
temperature_uncertainty_K = 0.3
variation_um = 0.4
drift_um = 0.5
set_up_um = 0.1

[[test]]
name = "given targets"
standard = "iso230-2"
axis = "X"
targets_mm = [0.0, 10.0]
feed = 0.02

[[test]]
name = "diagonals"
standard = "iso230-6"
from = { X_mm = 0.0, Y_mm = 0.0 }
to = { X_mm = 50.0, Y_mm = 50.0 }
feed = 0.02

[[test]]
name = "circles"
standard = "iso230-4"
plane = "XY"
radius_mm = 50.0
reading_count = 720
feed = 0.02
at = { X_mm = 0.0, Y_mm = 0.0 }

[[test]]
name = "C"
standard = "iso230-2"
axis = "C"
from_deg = 0.0
to_deg = 360.0
target_count = 8
target_spread_deg = 1.0
runs = 5
overrun_deg = 1.0
rotary_feed = 1.0
[test.device]
target_uncertainty_urad = 1.0
resolution_urad = 0.1
variation_urad = 1.0
drift_urad = 1.0
set_up_urad = 0.1

[[test]]
name = "given angles"
standard = "iso230-2"
axis = "C"
targets_deg = [0.0, 90.0]
rotary_feed = 1.0

[[test]]
name = "table"
standard = "iso230-7"
axis = "C"
from_deg = 0.0
revolutions = 3
distance_mm = 100.0
overrun_deg = 10.0
reading_count = 360
rotary_feed = 1.0
at = { X_mm = 0.0, Y_mm = 0.0 }

[[test]]
name = "ball"
standard = "iso10791-6"
axis = "C"
from_deg = 0.0
to_deg = 360.0
overrun_deg = 10.0
reading_count = 360
rotary_feed = 1.0
tool = 1
at = { X_mm = 20.0, Y_mm = 0.0 }

[[case]]
name = "nominal"
)";

// A machine file with identified values, as a table of a scenario.
constexpr std::string_view kIdentified = R"([machine]
based_on = "start_machine.toml"
solver_tolerance_nm = 0.002
identified = { keys = ["solver_tolerance_nm"], units = ["nm"], values = [0.002], covariance = [[1e-8]] }
)";

}  // namespace

std::string_view third_specimen() { return kThird; }

std::string_view test_specimen() { return kTests; }

std::string_view identified_specimen() { return kIdentified; }

}  // namespace servomill::sim::input
