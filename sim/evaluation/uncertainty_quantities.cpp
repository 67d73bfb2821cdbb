#include "sim/evaluation/uncertainty_quantities.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "plant/geometry/reversal_memory.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/case_evaluation.h"
#include "sim/evaluation/statistic.h"
#include "sim/evaluation/vector_at.h"
#include "sim/model/scenario.h"
#include "sim/model/tip_uncertainty.h"

namespace servomill::sim::evaluation {
namespace {

// Longest reversal of each joint whose errors have one.
std::vector<plant::Play> plays_of(const model::UncertainErrors& errors, const JointLayout& layout) {
  std::vector<plant::Play> out;
  for (const auto& parts : errors.parts) {
    for (const model::UncertainPart& part : parts) {
      const auto joint = layout.joint_of(part.name.axis);
      if (!joint || part.above.reversals.empty()) continue;
      const double distance = part.above.reversals.front().distance;
      const auto known = std::find_if(out.begin(), out.end(),
                                      [&](const plant::Play& one) { return one.joint == *joint; });
      if (known == out.end()) {
        out.push_back({*joint, distance});
      } else {
        known->distance = std::max(known->distance, distance);
      }
    }
  }
  return out;
}

// Joints of the recorded rows and their directions of travel; rows are asked for in rising order.
class TravelledJoints {
 public:
  TravelledJoints(const CaseData& one, const model::UncertainErrors& errors)
      : servo_(*one.servo), plays_(plays_of(errors, one.chain.layout)) {
    for (int joint = 0; joint < kJoints; ++joint) {
      if (!one.chain.layout.has(joint)) continue;
      const bool linear = joint < kLinearJoints;
      const auto column =
          servo_.column(linear ? "true_linear" : "true_rotary", one.chain.layout.letter_of(joint));
      if (column) columns_.push_back({joint, *column, linear ? mm : deg});
      is_complete_ = is_complete_ && column.has_value();
    }
    if (servo_.rows() > 0) memory_ = plant::ReversalMemory(plays_, at(0));
  }

  bool is_complete() const { return is_complete_; }

  Joints at(std::size_t row) const {
    Joints Q = Joints::Zero();
    for (const Column& one : columns_) Q[one.joint] = servo_.at(row, one.column) * one.unit;
    return Q;
  }

  // At a row, once all rows before it have been passed.
  Joints directions(std::size_t row) {
    for (; row_ < row; ++row_) memory_.travel(at(row_));
    std::vector<double> of_plays(plays_.size());
    memory_.directions(at(row), of_plays);
    Joints out = Joints::Zero();
    for (std::size_t i = 0; i < plays_.size(); ++i) out[plays_[i].joint] = of_plays[i];
    return out;
  }

 private:
  struct Column {
    int joint;
    std::size_t column;
    double unit;
  };
  const records::Series& servo_;
  std::vector<plant::Play> plays_;
  std::vector<Column> columns_;
  bool is_complete_ = true;
  plant::ReversalMemory memory_;
  std::size_t row_ = 0;
};

// Tip in the spindle nose, of the ideal machine with the recorded tip.
Eigen::Vector3d tip_in_spindle(const plant::MachineChain& chain, const Joints& Q,
                               const Eigen::Vector3d& p_WT) {
  const Eigen::Vector3d nose = plant::forward(chain, Q, Eigen::Vector3d::Zero()).p_WT;
  Eigen::Matrix3d R_WS;
  for (int k = 0; k < 3; ++k) {
    R_WS.col(k) = plant::forward(chain, Q, Eigen::Vector3d::Unit(k)).p_WT - nose;
  }
  return R_WS.transpose() * (p_WT - nose);
}

QuantityValue tool_deviation_uncertainty(const model::QuantitySpec& spec, CaseEvaluation& compared,
                                         const CaseData*) {
  const CaseData& one = compared.data;
  if (!one.uncertain) return {.note = "the covariance of the identified errors is unknown"};
  TravelledJoints joints(one, *one.uncertain);
  const auto tip = one.servo->column("tool_position_true", 'X');
  if (!joints.is_complete() || !tip) return {.note = "positions were not recorded"};
  const model::TipUncertainty uncertainty(one.chain, *one.uncertain);
  Statistic statistic(spec.statistic);
  compared.samples.rows(spec.sections).for_each([&](std::size_t row) {
    const Joints Q = joints.at(row);
    const Eigen::Vector3d p_ST =
        tip_in_spindle(one.chain, Q, vector_at(*one.servo, row, *tip) * mm);
    statistic.add(uncertainty.expanded(Q, p_ST, joints.directions(row))[spec.axis - 'X'] / um);
  });
  return {statistic.value()};
}

constexpr QuantityEntry kQuantities[] = {
    {.name = "tool_deviation_uncertainty",
     .unit = "um",
     .help = "expanded uncertainty (k = 2) of the tool_deviation of a corrected machine, from the "
             "covariance of its identified errors, in the directions of travel",
     .axes = "XYZ",
     .has_statistic = true,
     .needs_covariance = true,
     .evaluate = tool_deviation_uncertainty},
};

}  // namespace

std::span<const QuantityEntry> uncertainty_quantities() { return kQuantities; }

}  // namespace servomill::sim::evaluation
