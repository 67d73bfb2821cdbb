#include "sim/programs/compensate/path_record.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "plant/vocabulary/simd.h"
#include "plant/vocabulary/units.h"
#include "sim/programs/compensate/program_corrector.h"
#include "sim/records/hdf5_group.h"
#include "sim/records/nexus.h"
#include "sim/run/store.h"

namespace servomill::sim::programs {
namespace {

constexpr double kApart = 1e-3;     // m
constexpr double kMaxPlaces = 1e4;  // of one block

}  // namespace

void PathRecord::add_place(const Step& step, double t, const AxisWords& corrected, bool is_end) {
  const AxisWords at = step.programmed.at(t);
  const WorkFrame& frame = step.programmed.frame;
  const AxisWords machine = frame.machine(at), d = frame.turned(corrected - at);
  s_.push_back((way_ + t * step.programmed.length()) / mm);
  line_.push_back(step.move->line);
  block_end_.push_back(is_end ? 1.0 : 0.0);
  rapid_.push_back(step.move->kind == MoveKind::rapid ? 1.0 : 0.0);
  for (int i = 0; i < kLinearJoints; ++i) {
    position_[i].push_back(machine[i] / mm);
    correction_[i].push_back(d[i] / um);
  }
}

void PathRecord::add(const Step& step, const Correction& correction) {
  if (!step.is_corrected) return;
  for (const FittedBlock& block : step.blocks) {
    const double length = (block.t_end - block.t_begin) * step.programmed.length();
    const int n = 1 + static_cast<int>(std::min(length / kApart, kMaxPlaces));
    for (int i = 1; i < n && step.move->kind != MoveKind::rapid; ++i) {
      const double t = block.t_begin + (block.t_end - block.t_begin) * i / n;
      add_place(step, t, corrected(step.programmed, correction, t), false);
    }
    add_place(step, block.t_end, block.end, true);
  }
  way_ += step.programmed.length();
}

void PathRecord::write(const std::string& path, bool force, const std::string& title,
                       const std::string& machine) const {
  records::OutputFile file(run::writable_name(path, force), force);
  file.remove_unless_committed();
  records::Hdf5Group root = file.root();
  root.attribute("Conventions", "CF-1.8");
  root.attribute("title", title);
  run::write_build(root);
  root.attribute("schema_version", std::int64_t{run::kSchemaVersion});
  root.attribute("kind", "compensate");
  root.attribute("machine", machine);
  records::Hdf5Group group = root.group("compensate");
  group.list("s", s_, {"mm", "arc length on the programmed path"});
  group.counts("line", line_, {"1", "line of the program"}, "s");
  group.counts("block_end", block_end_, {"1", "1 where a block of the corrected program ends"},
               "s");
  group.counts("rapid", rapid_, {"1", "1 during a rapid move"}, "s");
  constexpr std::array<char, 3> kLetters = {'x', 'y', 'z'};
  for (int i = 0; i < kLinearJoints; ++i) {
    const char c = kLetters[static_cast<std::size_t>(i)];
    group.list(fmt::format("position_{}", c), position_[i],
               {"mm", fmt::format("programmed machine {}", c)}, "s");
    group.list(fmt::format("correction_{}", c), correction_[i],
               {"um", fmt::format("correction of {}", c)}, "s");
  }
  records::make_nexus_group(root, "NXroot", "compensate");
  records::make_nexus_data(group, {"correction_x", {"s"}, {"correction_y", "correction_z"}});
  file.commit();
}

}  // namespace servomill::sim::programs
