#include "sim/preparation/part_deviations.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "sim/numerics/decompositions.h"
#include "sim/preparation/probed_face.h"

namespace servomill::sim::preparation {
namespace {

using Eigen::Vector3d;

constexpr double kMoves = 1e-9;    // m
constexpr double kPlunge = 0.14;   // sine of the angle between path and axis
constexpr double kCorner = 0.98;   // cosine of 11 deg, from one row to the next
constexpr double kSameFace = 0.5;  // cosine of 60 deg
constexpr double kApart = 0.3;     // of singular values: normals within 33 deg count as one
constexpr std::array kParts = {CutBy::flank, CutBy::tip, CutBy::corner};

// Consecutive rows.
struct Run {
  std::size_t first = 0, end = 0;
};

std::vector<Run> runs_of(const std::vector<ToolRow>& rows) {
  std::vector<Run> out;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    if (rows[n].run < 0) continue;
    const bool goes_on = n > 0 && rows[n].run == rows[n - 1].run;
    if (!goes_on) out.push_back({n, n});
    out.back().end = n + 1;
  }
  return out;
}

// The vector along normals n_i as long as d_i that fits all best, and is the shortest of these.
Vector3d fitted(const std::vector<ProbedFace::At>& faces) {
  if (faces.empty()) return Vector3d::Zero();
  if (faces.size() == 1) return faces[0].deviation * faces[0].normal;
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(3, 3);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(3);
  for (const ProbedFace::At& one : faces) {
    N += one.normal * one.normal.transpose();
    b += one.normal * one.deviation;
  }
  const numerics::SingularValues of = numerics::singular_values(N);
  return of.solve(b, of.rank(kApart * kApart));
}

// One run of feed motion.
class ProbedRun {
 public:
  ProbedRun(const std::vector<ToolRow>& rows, const Run& run) : rows_(rows), run_(run) {
    s_.push_back(0.0);
    for (std::size_t n = run.first + 1; n < run.end; ++n) {
      s_.push_back(s_.back() + (rows[n].tip - rows[n - 1].tip).norm());
    }
    find_frames();
  }

  bool moves() const { return s_.back() > kMoves; }
  bool is_probed() const { return !faces_.empty(); }

  void add(const std::vector<ProbedCut>& cuts) {
    for (const CutBy by : kParts) {
      std::vector<FacePoint> points;
      for (const ProbedCut& cut : cuts) {
        const bool is_here = cut.place.row >= run_.first && cut.place.row < run_.end;
        if (is_here && cut.place.by == by) points.push_back(point_of(cut));
      }
      std::stable_sort(points.begin(), points.end(),
                       [](const FacePoint& a, const FacePoint& b) { return a.s < b.s; });
      add_faces(by, points);
    }
  }

  Vector3d deviation(std::size_t row) const {
    const std::size_t n = row - run_.first;
    std::vector<ProbedFace::At> all;
    for (const ProbedFace& face : faces_) {
      all.push_back(face.at(s_[n], frames_[n], rows_[row].axis));
    }
    return fitted(all);
  }

 private:
  FacePoint point_of(const ProbedCut& cut) const {
    const std::size_t n = cut.place.row - run_.first;
    const double s = s_[n] + cut.place.share * (s_[n + 1] - s_[n]);
    const PathFrame& frame = frames_[cut.place.share < 0.5 ? n : n + 1];
    return face_point(cut.place.by, s, cut.deviation, cut.normal, frame);
  }

  // Each point goes to the face that is most like it.
  void add_faces(CutBy by, const std::vector<FacePoint>& points) {
    std::vector<ProbedFace> faces;
    for (const FacePoint& point : points) {
      const auto best = std::max_element(faces.begin(), faces.end(), [&](auto& a, auto& b) {
        return a.likeness(point) < b.likeness(point);
      });
      const bool is_known =
          best != faces.end() && (by == CutBy::tip || best->likeness(point) >= kSameFace);
      (is_known ? *best : faces.emplace_back(by)).add(point);
    }
    faces_.insert(faces_.end(), faces.begin(), faces.end());
  }

  // A tool that stands or plunges keeps the frame before; at the beginning it has that behind.
  void find_frames() {
    std::optional<PathFrame> last;
    std::size_t unknown = 0;
    for (std::size_t n = run_.first; n < run_.end; ++n) {
      if (const std::optional<PathFrame> now = frame_at(n)) last = now;
      ++unknown;
      if (!last) continue;
      frames_.resize(frames_.size() + unknown, *last);
      unknown = 0;
    }
    frames_.resize(frames_.size() + unknown);
  }

  std::optional<PathFrame> frame_at(std::size_t n) const {
    const Vector3d t = tangent_at(n), to_left = rows_[n].axis.cross(t);
    if (to_left.norm() < kPlunge) return {};
    const Vector3d l = to_left.normalized();
    return PathFrame{t, l, t.cross(l)};
  }

  // Along the step from a row to the next (0 where the tool stands and beyond the run).
  Vector3d direction(std::ptrdiff_t from) const {
    const auto first = static_cast<std::ptrdiff_t>(run_.first);
    if (from < first || from + 1 >= static_cast<std::ptrdiff_t>(run_.end)) return Vector3d::Zero();
    const auto n = static_cast<std::size_t>(from);
    const Vector3d step = rows_[n + 1].tip - rows_[n].tip;
    return step.norm() <= kMoves ? Vector3d(Vector3d::Zero()) : step.normalized();
  }

  // Unit tangent, or 0 if the tool is at rest. At a corner it is that of the leg with this row: the
  // step across the corner has the direction of neither leg.
  Vector3d tangent_at(std::size_t row) const {
    const auto n = static_cast<std::ptrdiff_t>(row);
    const Vector3d before = direction(n - 1), behind = direction(n);
    if (before.isZero() || behind.isZero()) return before + behind;
    if (before.dot(behind) > kCorner) {
      return (rows_[row + 1].tip - rows_[row - 1].tip).normalized();
    }
    return before.dot(direction(n - 2)) >= behind.dot(direction(n + 1)) ? before : behind;
  }

  const std::vector<ToolRow>& rows_;
  Run run_;
  std::vector<double> s_;  // m, row by row
  std::vector<PathFrame> frames_;
  std::vector<ProbedFace> faces_;
};

// Rows between runs go from one to the next.
void join(std::vector<Vector3d>& tip, const std::vector<Run>& runs) {
  if (runs.empty()) return;
  std::fill(tip.begin(), tip.begin() + static_cast<std::ptrdiff_t>(runs.front().first),
            Vector3d(tip[runs.front().first]));
  std::fill(tip.begin() + static_cast<std::ptrdiff_t>(runs.back().end), tip.end(),
            Vector3d(tip[runs.back().end - 1]));
  for (std::size_t i = 1; i < runs.size(); ++i) {
    const std::size_t from = runs[i - 1].end - 1, to = runs[i].first;
    for (std::size_t n = from + 1; n < to; ++n) {
      const double share = static_cast<double>(n - from) / static_cast<double>(to - from);
      tip[n] = tip[from] + share * (tip[to] - tip[from]);
    }
  }
}

}  // namespace

PartDeviations part_deviations(const std::vector<ToolRow>& rows,
                               const std::vector<ProbedCut>& cuts) {
  PartDeviations out;
  out.tip.assign(rows.size(), Vector3d::Zero());
  std::vector<Run> moving;
  for (const Run& run : runs_of(rows)) {
    ProbedRun one(rows, run);
    if (!one.moves()) continue;
    moving.push_back(run);
    one.add(cuts);
    if (!one.is_probed()) {
      out.unprobed.push_back({rows[run.first].line, rows[run.end - 1].line});
      continue;
    }
    for (std::size_t n = run.first; n < run.end; ++n) out.tip[n] = one.deviation(n);
  }
  join(out.tip, moving);
  return out;
}

}  // namespace servomill::sim::preparation
