/// Probed features in result files.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/evaluation/part_fit.h"
#include "sim/evaluation/probed_part.h"
#include "sim/model/work_frame.h"
#include "sim/records/hdf5_group.h"
#include "sim/records/input_file.h"

namespace servomill::sim::run {

/// A group for each feature:
///
///     point, repetition                 numbers of the points and of the repetitions, from 0
///     nominal  (point, xyz)        mm   in the work frame
///     normal   (point, ijk)        1    out of the part
///     deviation (point)            um   along the normal, without error of the CMM; NaN: missed
///     measured (repetition, point) um   along the normal
///     sigma    (point)             um   standard deviation of the repetitions
///     imposed  (point)             um   displacement along the normal that is asked for, if any
///     aligned_position (point, xyz)       mm   point of the nominal part nearest to the measured
///     one after
///                                       best fit, where there is a nominal part
///     aligned_deviation (point, xyz)   um   the measured one minus that
///
/// and the attribute `kind`. Attributes of the group itself: the work frame in that of the
/// workpiece, in which tool positions are recorded, `work_origin_mm` and `work_axes` (the rotation
/// matrix, row by row), so that p_W = work_axes p + work_origin; of the best fit (measured ->
/// nominal)
/// `alignment_shift_um` (of the work zero), `alignment_rotation_urad` (rotation vector),
/// `alignment_rms_um`.
void write_probes(records::Hdf5Group group, std::span<const evaluation::ProbedFeature> features,
                  const model::PartFrame& frame, const std::optional<evaluation::PartFit>& fit);

/// Reads them back, in the order of the plan; nothing if there is no such group.
/// @throws InputError if what is there does not fit the plan
std::vector<evaluation::ProbedFeature> read_probed(const records::InputFile& file,
                                                   const std::string& group,
                                                   std::span<const metrology::ProbeSpec> plan);

}  // namespace servomill::sim::run
