// Specimens that show single keys: a machine with one axis, identified values.
#include "sim/input/key_specimens.h"

namespace servomill::sim::input {
namespace {

constexpr std::string_view kThird = R"(
title = "third"
sweep.samples = { count = 2, from = ["a.toml"], identified = [{ keys = ["nc.Kv"], units = ["1/s"], values = [50.0], covariance = [[1]] }] }

[machine]
structure = "[w b Z t]"
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

[program]
file = "third.ngc"
text = "M2\n"

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

std::string_view identified_specimen() { return kIdentified; }

}  // namespace servomill::sim::input
