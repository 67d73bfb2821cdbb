#include "sim/run/store_learnt.h"

#include <numeric>
#include <string>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/records/nexus.h"
#include "strategies/path_offset.h"

namespace servomill::sim::run {
namespace {

// Offset of the linear or of the rotary joints, row after row.
void write_joints(records::Hdf5Group& group, const std::vector<Joints>& rows,
                  const JointLayout& layout, bool linear) {
  std::string letters;
  std::vector<int> joints;
  for (int j = 0; j < kJoints; ++j) {
    if (!layout.has(j) || (j < kLinearJoints) != linear) continue;
    joints.push_back(j);
    letters += layout.letter_of(j);
  }
  if (joints.empty()) return;
  const std::string name = linear ? "linear" : "rotary";
  group.labels("axis_" + name, letters, name + " axes");
  std::vector<double> values;
  for (const Joints& row : rows) {
    for (const int j : joints) values.push_back(row[j] / um);  // um is urad
  }
  group.table(name, joints.size(), values,
              {linear ? "um" : "urad", "offset that is added to the setpoint, " + name + " axes"},
              "time", "axis_" + name);
}

void write_offset(records::Hdf5Group group, const strategies::PathOffset& offset,
                  const JointLayout& layout) {
  std::vector<double> time, s;
  std::vector<Joints> rows;
  for (std::size_t n = 0; n < offset.offset.size(); ++n) {
    const std::size_t instant = n * offset.times->every;
    time.push_back(static_cast<double>(instant) * offset.times->h);
    s.push_back(offset.times->s[instant] / mm);
    rows.push_back(offset.at(static_cast<double>(instant)));
  }
  group.list("time", time, {"s", "time since the start of the program that was learnt from"});
  group.list("s", s, {"mm", "arc length on the path of the original program"}, "time");
  write_joints(group, rows, layout, true);
  write_joints(group, rows, layout, false);
  records::make_nexus_data(group, {"linear", {"time", "axis_linear"}, {}});
}

}  // namespace

void write_learnt(records::Hdf5Group& all, const LearntRuns& learnt, const JointLayout& layout) {
  std::vector<double> rms, largest;
  for (const strategies::TrialFigures& run : learnt.lesson.trials) {
    rms.push_back(run.rms / um);
    largest.push_back(run.largest / um);
  }
  records::Hdf5Group group = all.group(learnt.strategy);
  std::vector<double> numbers(rms.size());
  std::iota(numbers.begin(), numbers.end(), 1.0);
  group.counts("run", numbers, {"1", "number of the run, counted from 1"});
  group.list("rms", rms, {"um", "deviation from the interpolated path in feed motion, rms"}, "run");
  group.list("largest", largest, {"um", "the same, largest"}, "run");
  records::make_nexus_data(group, {"rms", {"run"}, {"largest"}});
  write_offset(group.group("offset"), *learnt.lesson.offset, layout);
}

}  // namespace servomill::sim::run
