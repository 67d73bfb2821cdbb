#include "sim/evaluation/probed_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "plant/cutting/floor_marks.h"
#include "plant/cutting/machined_surface.h"
#include "plant/cutting/tooth_marks.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/cutter_path.h"
#include "sim/evaluation/vector_at.h"
#include "sim/model/work_frame.h"

namespace servomill::sim::evaluation {
namespace {

using Eigen::Vector3d;
using plant::Meeting;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kPoorChord = 1.0 * um;  // chord errors beyond it are reported
constexpr double kParallel = 1e-9;       // sine of an angle
constexpr double kBelow = 1.0 * um;      // a surface, where its material is looked for

// Tip of a cutter with axis k when its body touches a face with this normal at a
// point: at the foot of the flank, on the rounding or, as for a plane, under the axis.
Vector3d tip_that_cuts(const plant::Cutter& cutter, const Vector3d& k,
                       const plant::ProbeTarget& target) {
  const Vector3d across = target.normal - target.normal.dot(k) * k;
  const double r = cutter.corner_radius;
  Vector3d tip = target.point + r * (target.normal - k);
  if (across.norm() > kParallel) tip += (cutter.radius - r) * across.normalized();
  return tip;
}

// Displacement along the normal that the imposed errors ask for where a piece of the program cuts
// the point, with the rotary axes where the work system has them at 0.
double imposed_at(const PartSource& source, const model::PartFrame& frame,
                  const engine::ProgramPath::Piece& piece, const plant::ProbeTarget& target) {
  const plant::MachineChain& chain = source.chain;
  const Joints Q_0 = chain.layout.joints(source.work_offset);
  const auto tip = source.tips.find(piece.tool_offset);
  const Vector3d p_ST = tip == source.tips.end() ? Vector3d::Zero() : tip->second;
  const Vector3d k = frame.direction(plant::forward(chain, Q_0, p_ST).k_W);
  const Vector3d p_W = frame.in_workpiece(tip_that_cuts(*cutter_of(source, piece), k, target));
  const auto Q = plant::inverse_fixed_rotary(chain, p_W, Q_0, p_ST);
  if (!Q) return kNone;
  const Vector3d displacement =
      plant::linear_jacobian(chain, Q_0) * source.imposed->joint_offset(*Q, p_ST);
  return target.normal.dot(frame.direction(displacement));
}

// Contact of a probe, and the feed that cut there.
struct Probed {
  Meeting meeting;
  const engine::ProgramPath::Piece* feed = nullptr;
  bool lacks_marks = false;  // those of teeth are asked for, and the surface is of none
};

// The surface of a part. A short path of the cutters is held as a whole; of a long one, what comes
// near some targets at a time.
class ProbedSurface {
 public:
  ProbedSurface(const PartSource& source, const metrology::Cmm& cmm, const PositionsHeld& held)
      : path_(source),
        cmm_(cmm),
        held_(held),
        swing_(cmm.tooth_marks && source.vibrates ? deflection_range(source.servo) : 0.0) {
    if (path_.positions() <= held.most) whole_.emplace(path_.all());
  }

  std::vector<Probed> probe(std::span<const plant::ProbeTarget> targets) const {
    std::vector<Probed> out;
    out.reserve(targets.size());
    if (whole_) {
      probe(targets, *whole_, out);
      return out;
    }
    while (!targets.empty()) {
      const std::vector<CutterPath::Box> boxes = next_boxes(targets);
      probe(targets.first(boxes.size()), Cut(path_.near(boxes)), out);
      targets = targets.subspan(boxes.size());
    }
    return out;
  }

 private:
  struct Cut {
    explicit Cut(CutterPasses passes_in) : passes(std::move(passes_in)), surface(passes.passes) {}
    CutterPasses passes;
    plant::MachinedSurface surface;
  };

  void probe(std::span<const plant::ProbeTarget> targets, const Cut& cut,
             std::vector<Probed>& out) const {
    const std::size_t first = out.size();
    const auto meetings =
        cmm_.probe_radius > 0.0
            ? cut.surface.touch(targets, cmm_.probe_radius, cmm_.clearance, cmm_.depth)
            : cut.surface.meet(targets, cmm_.clearance, cmm_.depth);
    for (const Meeting& meeting : meetings) {
      const bool is_met = meeting.kind == Meeting::Kind::met;
      out.push_back({meeting, is_met ? cut.passes.feed_at(meeting.position) : nullptr});
      if (is_met && cmm_.tooth_marks) {
        add_tooth_mark(cut.passes, targets[out.size() - 1 - first], out.back());
      }
    }
  }

  // In place of the surface of a body that turns, that of its teeth.
  void add_tooth_mark(const CutterPasses& cut, const plant::ProbeTarget& target,
                      Probed& probed) const {
    const auto [pass, position] = cut.place_of(probed.meeting.position);
    if (cut.angles[pass].empty()) return;
    const plant::CutterPass& of = cut.passes[pass];
    const plant::TurningPath path{of.positions, cut.angles[pass], path_.frame().R_WG, swing_};
    std::optional<double> mark;
    if (plant::is_floor(target, of.positions[position])) {
      const double met = probed.meeting.distance;
      mark = plant::floor_mark(of.cutter, path, {target.point + met * target.normal, target.normal},
                               position);
      if (mark) *mark += met;
    } else {
      mark = plant::tooth_mark(of.cutter, path, target, position);
    }
    probed.lacks_marks = !mark;
    if (mark) probed.meeting.distance = *mark;
  }

  // Boxes of the first targets, as many as may be held together. What is near several of them is
  // held once: at most what is near a box around all of them.
  std::vector<CutterPath::Box> next_boxes(std::span<const plant::ProbeTarget> targets) const {
    std::vector<CutterPath::Box> out;
    CutterPath::Box around_all;
    std::size_t sum = 0, limit = 0;
    for (const plant::ProbeTarget& target : targets) {
      const CutterPath::Box box = around(target);
      const std::size_t near = path_.positions_near(box);
      sum += near;
      around_all.extend(box);
      if (out.empty()) limit = std::max(held_.at_once, 2 * near);
      if (std::min(sum, path_.positions_near(around_all)) > limit) break;
      out.push_back(box);
    }
    return out;
  }

  // All that the stylus goes through.
  CutterPath::Box around(const plant::ProbeTarget& target) const {
    const double r = cmm_.probe_radius;
    CutterPath::Box box(Vector3d(target.point + (cmm_.clearance + 2.0 * r) * target.normal));
    box.extend(Vector3d(target.point - (cmm_.depth + r) * target.normal));
    const Vector3d side = Vector3d::Constant(r);
    return {box.min() - side, box.max() + side};
  }

  CutterPath path_;
  const metrology::Cmm& cmm_;
  const PositionsHeld& held_;
  double swing_;  // m
  std::optional<Cut> whole_;
};

struct Misses {
  std::size_t count = 0, first = 0;
};

enum class Miss : std::uint8_t { untouched, blocked, through, no_stock };

// A contact of the stylus is on a machined surface only if there was stock below it.
std::optional<Miss> miss_of(const Meeting& meeting, const plant::ProbeTarget& target,
                            const plant::Stock* stock) {
  switch (meeting.kind) {
    case Meeting::Kind::untouched:
      return Miss::untouched;
    case Meeting::Kind::blocked:
      return Miss::blocked;
    case Meeting::Kind::through:
      return Miss::through;
    case Meeting::Kind::met:
      break;
  }
  const Vector3d below = target.point + (meeting.distance - kBelow) * target.normal;
  if (stock != nullptr && !stock->contains(below)) return Miss::no_stock;
  return std::nullopt;
}

std::string why(Miss miss, const metrology::Cmm& cmm) {
  switch (miss) {
    case Miss::untouched:
      return "no cutter reached this point";
    case Miss::no_stock:
      return "the stock ([[part.stock]]) does not extend to there";
    case Miss::blocked:
      return cmm.probe_radius > 0.0
                 ? fmt::format("the stylus ball does not fit {:g} mm (cmm.approach_mm) above it",
                               cmm.clearance / mm)
                 : fmt::format("there is uncut material within {:g} mm (cmm.approach_mm) above it",
                               cmm.clearance / mm);
    case Miss::through:
      return fmt::format("the cutter removed everything down to {:g} mm (cmm.search_mm) below it",
                         cmm.depth / mm);
  }
  return "";
}

// @param unmarked  points without the marks of teeth that are asked for
void add_notes(const PartSource& source, const metrology::ProbeSpec& probe,
               const std::map<Miss, Misses>& missed, std::size_t unmarked,
               const metrology::Cmm& cmm, std::vector<std::string>& notes) {
  const std::vector<plant::ProbeTarget>& targets = probe.feature.targets;
  for (const auto& [miss, misses] : missed) {
    notes.push_back(fmt::format(
        "{}: warning: case {}: {} of {} points of probe '{}' met no cut surface, first at {}: {}",
        to_string(probe.place), source.case_name, misses.count, targets.size(), probe.name,
        model::program_words(targets[misses.first].point), why(miss, cmm)));
  }
  if (unmarked > 0) {
    notes.push_back(fmt::format(
        "{}: warning: case {}: {} of {} points of probe '{}' are neither on a wall cut by a flank "
        "nor on a floor: cmm.tooth_marks excludes their marks",
        to_string(probe.place), source.case_name, unmarked, targets.size(), probe.name));
  }
}

}  // namespace

double chord_error(const records::Series& servo) {
  const std::size_t position = *servo.column("tool_position_true", 'X');
  const std::size_t rapid = *servo.column("rapid");
  double largest = 0.0;
  for (std::size_t row = 1; row + 1 < servo.rows(); ++row) {
    if (servo.at(row, rapid) != 0.0) continue;
    const Vector3d bend = vector_at(servo, row + 1, position) -
                          2.0 * vector_at(servo, row, position) +
                          vector_at(servo, row - 1, position);
    largest = std::max(largest, bend.norm() / 8.0 * mm);
  }
  return largest;
}

double deflection_range(const records::Series& servo) {
  const auto first = servo.column("structural_deflection", 'X');
  if (!first || servo.rows() == 0) return 0.0;
  Vector3d low = vector_at(servo, 0, *first), high = low;
  for (std::size_t row = 1; row < servo.rows(); ++row) {
    const Vector3d deflection = vector_at(servo, row, *first);
    low = low.cwiseMin(deflection);
    high = high.cwiseMax(deflection);
  }
  return (high - low).norm() * um;
}

ProbedPart probe_part(const PartSource& source, const std::vector<metrology::ProbeSpec>& plan,
                      const metrology::Cmm& cmm, const PositionsHeld& held) {
  const model::PartFrame frame = model::work_frame(source.chain, source.work_offset);
  const ProbedSurface surface(source, cmm, held);
  ProbedPart out;
  std::size_t met = 0;
  for (const metrology::ProbeSpec& probe : plan) {
    const std::vector<plant::ProbeTarget>& targets = probe.feature.targets;
    ProbedFeature found{probe.name, probe.feature, {}, {}, {}};
    std::map<Miss, Misses> missed;
    const std::vector<Probed> probed = surface.probe(targets);
    std::size_t unmarked = 0;
    for (std::size_t i = 0; i < probed.size(); ++i) {
      throw_if_interrupted();
      const auto& [meeting, feed, lacks_marks] = probed[i];
      unmarked += lacks_marks ? 1 : 0;
      const std::optional<Miss> miss = miss_of(meeting, targets[i], source.stock);
      found.deviation.push_back(miss ? kNone : meeting.distance);
      met += miss ? 0 : 1;
      if (miss && missed[*miss].count++ == 0) missed[*miss].first = i;
      if (source.imposed == nullptr) continue;
      found.imposed.push_back(!miss && feed ? imposed_at(source, frame, *feed, targets[i]) : kNone);
    }
    add_notes(source, probe, missed, unmarked, cmm, out.notes);
    found.measured = metrology::probe_all(cmm, source.case_name, probe.name, found.deviation);
    out.features.push_back(std::move(found));
  }
  if (met == 0) return out;
  const double chord = chord_error(source.servo);
  if (chord > kPoorChord) {
    out.notes.push_back(fmt::format(
        "warning: case {}: the recorded path has corners of up to {:.2g} um between its samples "
        "where the tool accelerates; probes there are as uncertain (record.period_ms)",
        source.case_name, chord / um));
  }
  return out;
}

std::vector<double> mean_deviations(const ProbedFeature& feature, const ProbedFeature* base) {
  std::vector<double> d = metrology::mean_of(feature.measured);
  if (base == nullptr) return d;
  const std::vector<double> of_base = metrology::mean_of(base->measured);
  for (std::size_t i = 0; i < d.size(); ++i) d[i] -= of_base[i];
  return d;
}

}  // namespace servomill::sim::evaluation
