#include "sim/limits/path_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "plant/vocabulary/tool_axis.h"
#include "sim/limits/path_follower.h"

namespace servomill::sim::limits {
namespace {

using Piece = engine::ProgramPath::Piece;

constexpr double kRounding = 1e-3;       // of a tolerance: digits of logs
constexpr double kMinLength = 1e-9;      // m, a piece that has a direction
constexpr double kCornerReach = 0.5e-3;  // m along the path, at least, in which a corner is passed
constexpr double kCornerTolerances = 10.0;
constexpr double kWhole = 1.0 - 1e-6;  // of the path
constexpr std::size_t kAtOnce = 1U << 12;

double distance_to_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                           const Eigen::Vector3d& b) {
  const Eigen::Vector3d d = b - a;
  const double square = d.squaredNorm();
  const double share = square > 0.0 ? std::clamp(d.dot(p - a) / square, 0.0, 1.0) : 0.0;
  return (a + share * d - p).norm();
}

// Direction of X Y Z at the begin or end of a piece.
Eigen::Vector3d direction(const Piece& piece, bool at_end) {
  const double h = std::min(1e-4, kMinLength / piece.curve.length());
  const double from = at_end ? 1.0 - h : 0.0;
  return (piece.curve.at(from + h) - piece.curve.at(from)).head<3>().normalized();
}

class PathCheck {
 public:
  PathCheck(const ProgrammedPath& program, const LoggedPath& log)
      : program_(program), log_(log), follower_(program, log) {
    out_.program = program.program;
    out_.floor = 0.5 * log.quantum.head<3>().norm();
  }

  PathReport run() {
    follow();
    find_corners();
    note_what_is_missing();
    return std::move(out_);
  }

 private:
  void follow() {
    Stage progress("samples", static_cast<double>(log_.t.size()));
    s_.reserve(log_.t.size());
    for (std::size_t k = 0; k < log_.t.size(); ++k) {
      if (k % kAtOnce == 0) {
        throw_if_interrupted();
        progress.reach(static_cast<double>(k));
      }
      const PathPlace place = follower_.at(k);
      s_.push_back(place.s);
      take(place, k);
    }
    out_.passed = program_.path.length() > 0.0 ? s_.back() / program_.path.length() : 1.0;
  }

  void note_what_is_missing() {
    if (out_.passed < kWhole) {
      out_.notes.push_back(fmt::format("the recording ends in line {}, after {:.3g} % of the path",
                                       out_.last_line, 100.0 * out_.passed));
    }
  }

  void take(const PathPlace& place, std::size_t sample) {
    LineDeviation& line = line_of(place.piece);
    out_.last_line = line.line;
    if (place.knows_rotary) line.rotary = std::max(line.rotary.value_or(0.0), place.rotary);
    const double tolerance = program_.tolerance[place.piece];
    if (place.linear - out_.floor > (1.0 + kRounding) * tolerance) {
      out_.time_beyond += sample > 0 ? log_.t[sample] - log_.t[sample - 1] : 0.0;
    }
    if (line.time >= log_.t.front() &&
        place.linear * line.tolerance <= line.deviation * tolerance) {
      return;
    }
    line.deviation = place.linear;
    line.tolerance = tolerance;
    line.time = log_.t[sample];
  }

  LineDeviation& line_of(std::size_t piece) {
    const int line = program_.path.line(piece);
    const auto [known, is_new] = index_.try_emplace(line, out_.lines.size());
    if (is_new) {
      LineDeviation one;
      one.line = line;
      one.tolerance = program_.tolerance[piece];
      one.time = -std::numeric_limits<double>::infinity();
      out_.lines.push_back(one);
    }
    return out_.lines[known->second];
  }

  // Corners that the motion has passed.
  void find_corners() {
    const engine::ProgramPath& path = program_.path;
    std::optional<Piece> before;  // the piece before that has a direction
    std::size_t index = 0;
    for (std::size_t i = 0; i < path.size(); ++i) {
      if (i % kAtOnce == 0) throw_if_interrupted();
      Piece here = path.piece(i);
      if (!(here.curve.length() > kMinLength)) continue;
      if (before) look_at_corner(index, *before, here);
      before = std::move(here);
      index = i;
    }
  }

  void look_at_corner(std::size_t index, const Piece& from, const Piece& to) {
    const bool is_one_frame = from.is_tip == to.is_tip && (!from.is_tip || from.p_ST == to.p_ST);
    if (!is_one_frame || angle_between(direction(from, true), direction(to, false)) < kMinCorner) {
      return;
    }
    const double tolerance = program_.tolerance[index];
    const double reach = std::max(kCornerReach, kCornerTolerances * tolerance);
    const auto first = std::lower_bound(s_.begin(), s_.end(), from.s_end - reach);
    const auto last = std::upper_bound(first, s_.end(), from.s_end + reach);
    if (last == s_.end() && s_.back() <= from.s_end) return;  // the log ends before it
    ++out_.corners;
    std::size_t k = first == s_.begin() ? 0 : static_cast<std::size_t>(first - s_.begin()) - 1;
    const std::size_t end = std::min(static_cast<std::size_t>(last - s_.begin()) + 1, s_.size());
    pass_corner(index, from, tolerance, k, end);
  }

  // The motion between the samples first ... end - 1.
  void pass_corner(std::size_t index, const Piece& piece, double tolerance, std::size_t first,
                   std::size_t end) {
    const Eigen::Vector3d corner = piece.end.head<3>();
    const auto at = [&](std::size_t k) -> Eigen::Vector3d {
      return follower_.in_coordinates_of(piece, k).head<3>();
    };
    double nearest = std::numeric_limits<double>::infinity(), bend = 0.0, time = 0.0;
    for (std::size_t k = first; k + 1 < end; ++k) {
      const double distance = distance_to_segment(corner, at(k), at(k + 1));
      if (distance >= nearest) continue;
      nearest = distance;
      time = log_.t[k];
      bend = k > 0 ? (at(k + 1) - 2.0 * at(k) + at(k - 1)).norm() : 0.0;
      if (k + 2 < s_.size()) bend = std::max(bend, (at(k + 2) - 2.0 * at(k + 1) + at(k)).norm());
    }
    LineDeviation& line = line_of(index);
    if (line.corner && nearest <= *line.corner) return;
    line.corner = nearest;
    line.corner_time = time;
    line.corner_floor = bend / 8.0;  // of a parabola over its chord
    line.tolerance = std::min(line.tolerance, tolerance);
  }

  const ProgrammedPath& program_;
  const LoggedPath& log_;
  PathFollower follower_;
  PathReport out_;
  std::vector<double> s_;                       // m, of each sample
  std::unordered_map<int, std::size_t> index_;  // of a line in out_.lines
};

}  // namespace

bool LineDeviation::is_sampled() const { return std::isfinite(time); }

double LineDeviation::factor() const {
  return std::max(deviation, corner.value_or(0.0)) / tolerance;
}

bool PathReport::is_beyond(const LineDeviation& one) const {
  const double most = (1.0 + kRounding) * one.tolerance;
  return one.deviation - floor > most || one.corner.value_or(0.0) - one.corner_floor - floor > most;
}

std::size_t PathReport::lines_beyond() const {
  return static_cast<std::size_t>(
      std::count_if(lines.begin(), lines.end(), [&](const auto& one) { return is_beyond(one); }));
}

PathReport check_path(const ProgrammedPath& program, const LoggedPath& log) {
  return PathCheck(program, log).run();
}

}  // namespace servomill::sim::limits
