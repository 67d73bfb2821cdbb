#include "sim/evaluation/spindle_quantities.h"

#include <cmath>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/evaluation/case_evaluation.h"
#include "sim/evaluation/statistic.h"
#include "sim/evaluation/vector_at.h"
#include "sim/model/scenario.h"

namespace servomill::sim::evaluation {
namespace {

// Rows of one way, in their order: nominal progress and deviation along it, and when.
class WayRows {
 public:
  explicit WayRows(const records::Series& servo)
      : servo_(servo),
        time_(*servo.column("time")),
        s_(*servo.column("s")),
        nominal_(*servo.column("tool_position_nominal", 'X')),
        true_(*servo.column("tool_position_true", 'X')) {}

  double s(std::size_t row) const { return servo_.at(row, s_) * mm; }
  double time(std::size_t row) const { return servo_.at(row, time_); }
  Eigen::Vector3d nominal(std::size_t row) const { return vector_at(servo_, row, nominal_) * mm; }
  Eigen::Vector3d deviation(std::size_t row) const {
    return (vector_at(servo_, row, true_) - vector_at(servo_, row, nominal_)) * mm;
  }

 private:
  const records::Series& servo_;
  std::size_t time_, s_, nominal_, true_;
};

// Direction of a straight way, from the first to the last of these rows.
Eigen::Vector3d direction_of(const WayRows& rows, const std::vector<std::size_t>& of) {
  return (rows.nominal(of.back()) - rows.nominal(of.front())).normalized();
}

// Adds the synchronisation errors at rows of one way (um).
void add_errors(const WayRows& rows, const std::vector<std::size_t>& of, const SynchronisedWay& way,
                SpindleLag& lag, Statistic& out) {
  if (of.size() < 2) return;
  const Eigen::Vector3d direction = direction_of(rows, of);
  double x = way.s_begin, t = rows.time(of.front());
  for (const std::size_t row : of) {
    lag.advance(rows.s(row) - x, rows.time(row) - t);
    x = rows.s(row);
    t = rows.time(row);
    out.add((rows.deviation(row).dot(direction) + lag.value()) / um);
  }
}

QuantityValue synchronisation_error(const model::QuantitySpec& spec, CaseEvaluation& one,
                                    const CaseData*) {
  if (one.data.spindle == nullptr || one.data.spindle->ways.empty()) {
    return {.note = "the program has no G33 and no G33.1"};
  }
  const SpindleMotion& motion = *one.data.spindle;
  if (!motion.drive || !motion.drive->Kv) {
    return {.note = "the gain of the spindle is not known: no nc.spindle.Kv in the machine file"};
  }
  const WayRows rows(*one.data.servo);
  Statistic errors(spec.statistic);
  SpindleLag lag(*motion.drive);
  RowRanges::Cursor cursor(one.samples.rows(spec.sections));
  for (const SynchronisedWay& way : motion.ways) {
    if (way.goes_back) {
      lag.reverse();
    } else {
      lag = SpindleLag(*motion.drive);
    }
    std::vector<std::size_t> of;
    while (!cursor.is_at_end() && rows.s(cursor.row()) < way.s_begin) cursor.step();
    for (; !cursor.is_at_end() && rows.s(cursor.row()) <= way.s_end; cursor.step()) {
      of.push_back(cursor.row());
    }
    add_errors(rows, of, way, lag, errors);
  }
  return {errors.value()};
}

constexpr QuantityEntry kQuantities[] = {
    {.name = "synchronisation_error",
     .unit = "um",
     .help = "tool centre point minus the position required by the spindle angle, along the path "
             "of G33 and G33.1",
     .has_statistic = true,
     .evaluate = synchronisation_error},
};

}  // namespace

SpindleMotion spindle_motion(const MoveRange& moves, const model::NcSettings& nc) {
  SpindleMotion out;
  out.drive = nc.spindle;
  for (const Move& move : moves) {
    if (move.synchronised == Synchronised::no) continue;
    out.ways.push_back({move.s_begin, move.s_end, move.synchronised == Synchronised::tap_out});
  }
  return out;
}

SpindleLag::SpindleLag(const model::SpindleDrive& drive)
    : Kv_(*drive.Kv), share_(1.0 - drive.velocity_feed_forward) {}

void SpindleLag::advance(double dx, double dt) {
  if (!(dt > 0.0)) return;
  const double steady = share_ * dx / dt / Kv_;
  lag_ = steady + (lag_ - steady) * std::exp(-Kv_ * dt);
}

std::span<const QuantityEntry> spindle_quantities() { return kQuantities; }

}  // namespace servomill::sim::evaluation
