#include "sim/evaluation/probed_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "sim/model/work_frame.h"

namespace servomill::sim {
namespace {

using Eigen::Vector3d;
using plant::Meeting;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kSameS = 1e-8;          // m; recorded arc lengths are rounded
constexpr double kPoorChord = 1.0 * um;  // chord errors beyond it are told
constexpr double kParallel = 1e-9;       // sine of an angle
constexpr double kBelow = 1.0 * um;      // a surface, where its material is looked for

Vector3d vector_at(const Series& series, std::size_t row, std::size_t first) {
  return {series.at(row, first), series.at(row, first + 1), series.at(row, first + 2)};
}

// The piece of the program that a recorded row belongs to; rows are asked for in order.
class PieceOfRow {
 public:
  PieceOfRow(const Series& series, const ProgramPath& path)
      : series_(series), path_(path), s_(*series.column("s")), line_(*series.column("line")) {}

  ProgramPath::Piece at(std::size_t row) {
    const double s = series_.at(row, s_) * mm;
    const int line = static_cast<int>(series_.at(row, line_));
    while (piece_ + 1 < path_.size() && is_behind(s, line)) ++piece_;
    return path_.piece(piece_);
  }

 private:
  bool is_behind(double s, int line) const {
    const double s_end = path_.s_end(piece_);
    return s > s_end + kSameS || (line != path_.line(piece_) && s >= s_end - kSameS);
  }

  const Series& series_;
  const ProgramPath& path_;
  std::size_t s_, line_;
  std::size_t piece_ = 0;
};

const plant::Cutter* cutter_of(const PartSource& source, const ProgramPath::Piece& piece) {
  const auto found = source.cutters.find(piece.tool);
  return found == source.cutters.end() ? nullptr : &found->second;
}

// Where the tip of a cutter with axis k stands when its body touches a face with this normal at a
// point: at the foot of the flank, on the rounding or, as for a plane, under the axis.
Vector3d tip_that_cuts(const plant::Cutter& cutter, const Vector3d& k,
                       const plant::ProbeTarget& target) {
  const Vector3d across = target.normal - target.normal.dot(k) * k;
  const double r = cutter.corner_radius;
  Vector3d tip = target.point + r * (target.normal - k);
  if (across.norm() > kParallel) tip += (cutter.radius - r) * across.normalized();
  return tip;
}

// The ways of the cutters, and the first feed of each, which says what turned in the spindle.
struct Ways {
  std::vector<plant::CutterPass> passes;
  std::vector<std::optional<ProgramPath::Piece>> feeds;  // of each pass; none: only rapid

  // That of the pass which a position (counted through all of them) belongs to.
  const ProgramPath::Piece* feed_at(std::size_t position) const {
    for (std::size_t i = 0; i < passes.size(); ++i) {
      if (position < passes[i].positions.size()) return feeds[i] ? &*feeds[i] : nullptr;
      position -= passes[i].positions.size();
    }
    return nullptr;
  }
};

Ways ways_of(const PartSource& source) {
  const PartFrame frame = work_frame(source.chain, source.work_offset);
  const Series& servo = source.servo;
  const std::size_t position = *servo.column("tool_position_true", 'X');
  const std::size_t axis = *servo.column("tool_axis_true", 'I');
  PieceOfRow pieces(servo, source.path);
  Ways out;
  const plant::Cutter* cutting = nullptr;
  for (std::size_t row = 0; row < servo.rows(); ++row) {
    const ProgramPath::Piece& piece = pieces.at(row);
    const plant::Cutter* cutter = cutter_of(source, piece);
    if (cutter != nullptr && cutter != cutting) {
      out.passes.push_back({*cutter, {}});
      out.feeds.emplace_back();
    }
    cutting = cutter;
    if (cutter == nullptr) continue;
    if (!out.feeds.back() && !piece.rapid) out.feeds.back() = piece;
    out.passes.back().positions.push_back(
        {frame.point(vector_at(servo, row, position) * mm),
         frame.direction(vector_at(servo, row, axis)).normalized()});
  }
  return out;
}

// Displacement along the normal that the imposed errors ask for where a piece of the program cuts
// the point, with the rotary axes where the work system has them at 0.
double imposed_at(const PartSource& source, const PartFrame& frame, const ProgramPath::Piece& piece,
                  const plant::ProbeTarget& target) {
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

struct Misses {
  std::size_t count = 0, first = 0;
};

enum class Miss : std::uint8_t { untouched, blocked, through, no_stock };

// What the stylus met is a cut surface only where there was raw material below it.
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

std::string why(Miss miss, const Cmm& cmm) {
  switch (miss) {
    case Miss::untouched:
      return "no cutter came there";
    case Miss::no_stock:
      return "the raw part ([[part.stock]]) does not reach there";
    case Miss::blocked:
      return cmm.probe_radius > 0.0
                 ? fmt::format("the stylus ball does not fit {:g} mm (cmm.clearance_mm) above it",
                               cmm.clearance / mm)
                 : fmt::format("there is uncut material {:g} mm (cmm.clearance_mm) above it",
                               cmm.clearance / mm);
    case Miss::through:
      return fmt::format("the cutter took away all down to {:g} mm (cmm.depth_mm) below it",
                         cmm.depth / mm);
  }
  return "";
}

}  // namespace

std::vector<plant::CutterPass> cutter_passes(const PartSource& source) {
  return ways_of(source).passes;
}

double chord_error(const Series& servo) {
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

ProbedPart probe_part(const PartSource& source, const std::vector<ProbeSpec>& plan,
                      const Cmm& cmm) {
  const PartFrame frame = work_frame(source.chain, source.work_offset);
  const Ways ways = ways_of(source);
  const plant::MachinedSurface surface(ways.passes);
  ProbedPart out;
  std::size_t met = 0;
  for (const ProbeSpec& probe : plan) {
    const std::vector<plant::ProbeTarget>& targets = probe.feature.targets;
    ProbedFeature found{probe.name, probe.feature, {}, {}, {}};
    std::map<Miss, Misses> missed;
    const auto meetings = cmm.probe_radius > 0.0
                              ? surface.touch(targets, cmm.probe_radius, cmm.clearance, cmm.depth)
                              : surface.meet(targets, cmm.clearance, cmm.depth);
    for (std::size_t i = 0; i < meetings.size(); ++i) {
      throw_if_interrupted();
      const std::optional<Miss> miss = miss_of(meetings[i], targets[i], source.stock);
      found.deviation.push_back(miss ? kNone : meetings[i].distance);
      met += miss ? 0 : 1;
      if (miss && missed[*miss].count++ == 0) missed[*miss].first = i;
      if (source.imposed == nullptr) continue;
      const ProgramPath::Piece* feed = miss ? nullptr : ways.feed_at(meetings[i].position);
      found.imposed.push_back(feed ? imposed_at(source, frame, *feed, targets[i]) : kNone);
    }
    for (const auto& [miss, misses] : missed) {
      out.notes.push_back(fmt::format(
          "{}: warning: case {}: {} of {} points of probe '{}' met no cut surface, first at {}: {}",
          to_string(probe.place), source.case_name, misses.count, targets.size(), probe.name,
          program_words(targets[misses.first].point), why(miss, cmm)));
    }
    found.measured = probe_all(cmm, source.case_name, probe.name, found.deviation);
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

}  // namespace servomill::sim
