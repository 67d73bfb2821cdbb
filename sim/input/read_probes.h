/// Reads what is probed on the part of a scenario, and with what.
#pragma once

#include "sim/config/reader.h"
#include "sim/metrology/cmm.h"
#include "sim/metrology/probing_plan.h"

namespace servomill::sim::input {

/// The table [cmm]: uncertainty_um, probe_radius_mm, repetitions, seed, approach_mm, search_mm.
metrology::Cmm read_cmm(config::Reader& root);

/// All [[probe]]: a name and one of line, plane, circle, cylinder, notch, points_mm.
/// With a fault a probe has no name, or a feature without targets, so that what refers to it can
/// still be read.
/// @param has_cutter  whether a tool has a diameter: without one nothing is cut
std::vector<metrology::ProbeSpec> read_probes(config::Reader& root, bool has_cutter);

}  // namespace servomill::sim::input
