/// The part that a case left behind, on the CMM.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "plant/cutting/cutter.h"
#include "plant/cutting/machined_surface.h"
#include "plant/cutting/stock.h"
#include "plant/geometry/volumetric.h"
#include "sim/engine/program_path.h"
#include "sim/metrology/cmm.h"
#include "sim/metrology/probing_plan.h"
#include "sim/records/series.h"

namespace servomill::sim {

/// What the CMM found of one feature of one case.
struct ProbedFeature {
  std::string name;
  Feature feature;                            // nominal
  std::vector<double> deviation;              // m along the normals, without error of the CMM; NaN:
                                              // nothing was met
  std::vector<std::vector<double>> measured;  // repetition, point; m
  std::vector<double> imposed;                // m along the normals, where errors are imposed
};

/// What the CMM found of one case.
struct ProbedPart {
  std::vector<ProbedFeature> features;  // one for each [[probe]]
  std::vector<std::string> notes;  // what was missed, and how well the recorded path resolves it
};

/// What a case brings along.
struct PartSource {
  const std::string& case_name;
  const Series& servo;
  const ProgramPath& path;
  const std::map<int, plant::Cutter>& cutters;      // by number of the tool
  const std::map<int, Eigen::Vector3d>& tips;       // p_ST (m), by number of the tool offset
  const plant::MachineChain& chain;                 // the ideal machine
  AxisWords work_offset = AxisWords::Zero();        // m, rad, machine coordinates
  const plant::VolumetricModel* imposed = nullptr;  // or none
  const plant::Stock* stock = nullptr;              // the raw part; none: it is everywhere
};

/// The true ways of the cutters in the work frame, one pass from each change of the tool to the
/// next: every recorded row, rapid moves included. Between rows they are straight; what is lost is
/// chord_error(). Rows of tools without a cutting part are left out.
std::vector<plant::CutterPass> cutter_passes(const PartSource& source);

/// Largest distance (m) between the recorded feed motion, straight from row to row, and a parabola
/// through three rows: a T^2 / 8 for an acceleration a and a record period T (0.6 um at 5 m/s^2 and
/// 1 ms), 0 where the tool moves evenly.
double chord_error(const Series& servo);

/// Cuts the part and probes it.
ProbedPart probe_part(const PartSource& source, const std::vector<ProbeSpec>& plan, const Cmm& cmm);

}  // namespace servomill::sim
