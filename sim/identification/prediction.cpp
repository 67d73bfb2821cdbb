#include "sim/identification/prediction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <limits>
#include <memory>

#include "plant/vocabulary/units.h"

namespace servomill::sim::identification {

Prediction::Prediction(const config::Document& document, std::vector<Estimate> estimates,
                       std::vector<const AxisRecord*> records, unsigned threads)
    : document_(document),
      estimates_(std::move(estimates)),
      records_(std::move(records)),
      threads_(threads) {
  for (const AxisRecord* record : records_) samples_ += record->record.size();
}

Values Prediction::start() const {
  Values values;
  for (const Estimate& one : estimates_) values.push_back(one.start);
  for (const AxisRecord* record : records_) {
    const StartOfMotion motion = start_of_motion(record->record);
    values.push_back(motion.position);
    values.push_back(motion.speed);
  }
  return values;
}

std::pair<double, double> Prediction::bounds(std::size_t parameter) const {
  const double infinite = std::numeric_limits<double>::infinity();
  if (parameter >= estimates_.size()) return {-infinite, infinite};
  return {estimates_[parameter].lower, estimates_[parameter].upper};
}

Mask Prediction::all_samples() const {
  Mask mask;
  for (const AxisRecord* record : records_) {
    mask.emplace_back(record->record.size(), char{1});
    for (const SampleRange& range : record->record.omitted) {
      std::fill(mask.back().begin() + static_cast<std::ptrdiff_t>(range.begin),
                mask.back().begin() + static_cast<std::ptrdiff_t>(range.end), char{0});
    }
  }
  return mask;
}

std::optional<ModelOfValues> Prediction::model(const Values& values, std::size_t record) const {
  try {
    return model_of(document_, estimates_, std::span(values).first(estimates_.size()), record);
  } catch (const InputError&) {
    return std::nullopt;  // outside of what a machine can be
  }
}

// Some are for one record alone.
bool Prediction::has_own() const {
  return std::any_of(estimates_.begin(), estimates_.end(),
                     [](const Estimate& one) { return one.record != Estimate::kAllRecords; });
}

void Prediction::refuse(const Values& values) const {
  for (std::size_t r = 0; r < records_.size(); ++r) {
    const ModelOfValues model = model_of(
        document_, estimates_, std::span(values).first(estimates_.size()), records_[r]->number);
    const AxisModel axis = started_axis(model, values, r);
    if (!identification::simulate(records_[r]->record, {&axis, 1}, 1).front().diverges) continue;
    throw InputError({records_[r]->record.name},
                     fmt::format("the motion that is simulated with the starting values diverges: "
                                 "the loop (period_ms = {:g}, gains, signs) or a starting value is "
                                 "not that of the recording",
                                 records_[r]->record.period / ms));
  }
  throw InputError(
      {records_.front()->record.name},
      "cannot be simulated with these values: the friction is too stiff for the exact integrator");
}

std::vector<std::optional<Prediction::Signals>> Prediction::simulate(
    std::span<const Values> values) const {
  std::vector<std::optional<Signals>> out(values.size(), Signals{});
  const bool own = has_own();
  std::vector<std::optional<ModelOfValues>> models;
  for (std::size_t r = 0; r < records_.size(); ++r) {
    if (r == 0 || own) {
      models.clear();
      for (const Values& at : values) models.push_back(model(at, records_[r]->number));
    }
    std::vector<AxisModel> axes;
    std::vector<std::size_t> possible;
    for (std::size_t n = 0; n < values.size(); ++n) {
      assert(values[n].size() == size());
      if (!models[n]) out[n].reset();
      if (!out[n]) continue;
      possible.push_back(n);
      axes.push_back(started_axis(*models[n], values[n], r));
    }
    std::vector<Simulated> simulated =
        identification::simulate(records_[r]->record, axes, threads_);
    for (std::size_t m = 0; m < possible.size(); ++m) {
      if (simulated[m].resolved && !simulated[m].diverges) {
        out[possible[m]]->of_record.push_back(std::move(simulated[m]));
      } else {
        out[possible[m]].reset();
      }
    }
  }
  return out;
}

AxisModel axis_model(const ModelOfValues& model, int joint) {
  AxisModel out{.drive = model.machine.drives[static_cast<std::size_t>(joint)],
                .loop = model.loop,
                .machine = nullptr,
                .joint = joint};
  if (model.loop.kind == LoopKind::nc) {
    out.machine = std::make_shared<model::MachineSettings>(model.machine);
  }
  return out;
}

AxisModel Prediction::started_axis(const ModelOfValues& model, const Values& values,
                                   std::size_t record) const {
  const std::size_t own = estimates_.size() + 2 * record;
  AxisModel out = axis_model(model, records_[record]->joint);
  out.position = values[own];
  out.speed = values[own + 1];
  return out;
}

Eigen::VectorXd Prediction::residual(const Signals& signals, const Mask& mask) const {
  Eigen::VectorXd out(static_cast<Eigen::Index>(samples_));
  Eigen::Index row = 0;
  for (std::size_t r = 0; r < records_.size(); ++r) {
    const std::vector<double>& recorded = records_[r]->record.feedback;
    for (std::size_t k = 0; k < recorded.size(); ++k) {
      out[row++] = mask[r][k] != 0 ? signals.of_record[r].feedback[k] - recorded[k] : 0.0;
    }
  }
  return out;
}

}  // namespace servomill::sim::identification
