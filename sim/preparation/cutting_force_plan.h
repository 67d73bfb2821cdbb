/// Finds the force of the cut along a program: where its cutters meet the stock and what they have
/// left of it by then.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "plant/cutting/cutter.h"
#include "plant/cutting/material.h"
#include "plant/cutting/stock.h"
#include "plant/structure/inertial_compliance.h"
#include "plant/vocabulary/input_error.h"
#include "sim/preparation/preparation_cache.h"

namespace servomill::sim::preparation {

struct CuttingPlanInputs {
  std::shared_ptr<const InterpretedProgram> program;  // the original one
  const plant::MachineChain& chain;                   // the ideal machine
  Joints start;                                       // m, rad
  AxisWords work_offset;                              // of the work frame, m, rad
  const plant::Stock& stock;                          // in the work frame (sim/model/work_frame.h)
  const std::map<int, plant::Cutter>& cutters;        // by number of tool
  plant::CuttingCoefficients coefficients;
  bool teeth;         // engagements of single teeth are planned
  bool regeneration;  // of teeth that vibrate
  bool displaced;     // cuts beside the path are planned
  // of the tool point: cuts that chatter are reported
  const std::vector<plant::StructuralMode>& modes;
  std::string file;  // of the program, for messages
  Place place;       // of [cutting]
};

/// The nominal path is followed; the ideal machine's cutter removes what it passes. The engagement
/// is looked at every 2 mm (a quarter of the cutter's diameter, if that is less) and closer, down
/// to 0.25 mm, where the force changes. Left out: errors of the machine and deflections do not
/// change the engagement; moves of rotary axes alone remove material but feel nothing.
/// @throws InputError where a cutter cuts with the spindle standing, a tool without a known cutter
///         is in material, or nothing ever touches the stock
PlannedCutting plan_cutting(const CuttingPlanInputs& inputs);

}  // namespace servomill::sim::preparation
