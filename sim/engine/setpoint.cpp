#include "sim/engine/setpoint.h"

#include <utility>

namespace servomill::sim::engine {

Setpoint::Setpoint(const model::NcSettings& nc, const controllers::Trajectory& reference,
                   std::vector<std::unique_ptr<strategies::SetpointPart>> parts)
    : reference_(reference), Tp_(nc.periods.seconds(nc.periods.position)) {
  for (auto& part : parts) {
    const SetpointEntry entry = part->entry();
    corrections_.push_back({std::move(part), {entry, Tp_}});
  }
  if (nc.filter.length == 0) return;
  const auto filter = [&](const Joints& standing) {
    return controllers::NominalFilter(
        nc.filter.triangle ? controllers::FilterShape::triangle : controllers::FilterShape::mean,
        static_cast<int>(nc.filter.length), standing);
  };
  Joints before = Joints::Zero();
  for (const Correction& correction : corrections_) {
    if (correction.in_nc.entry() == EntryPoint::before_filter) {
      before += correction.part->offset(reference.start());
    }
  }
  const Joints zero = Joints::Zero();
  // The filter is linear: values and rates are filtered separately, so that the filtered value need
  // not be differentiated. The filter of the corrections starts at their value at rest.
  filters_.emplace(Filters{filter(reference.start()), filter(zero), filter(zero), filter(before)});
  delay_ = filters_->Q.delay() * Tp_;
}

Joints& Setpoint::Offsets::of(EntryPoint entry) {
  switch (entry) {
    case EntryPoint::before_filter:
      return before_filter;
    case EntryPoint::position_command:
      return position_command;
    case EntryPoint::feed_forward:
      break;
  }
  return feed_forward;
}

void Setpoint::read_temperatures(const strategies::TemperatureReading& now) {
  for (Correction& correction : corrections_) correction.part->read_temperatures(now);
}

const AxisSetpoint& Setpoint::settle() {
  const Joints& Q = reference_.start();
  out_ = {Q, Q, Joints::Zero(), Joints::Zero()};
  fed_forward_.setZero();
  fed_forward_rate_.setZero();
  for (Correction& correction : corrections_) {
    const Joints offset = correction.part->offset(Q);
    correction.in_nc.settle(offset);
    out_.Q_cmd += offset;
    // An offset at the start is no step: its first difference is 0.
    if (correction.in_nc.entry() != EntryPoint::position_command) fed_forward_ += offset;
  }
  return out_;
}

const AxisSetpoint& Setpoint::advance(const controllers::Trajectory::Sample& sample, double t,
                                      const Joints& Q_fb) {
  const Joints followed = out_.Q_cmd;
  out_ = {sample.Q_ref, sample.Q_ref, sample.dQ_ref, sample.ddQ_ref};
  if (filters_) {
    out_.Q_ref = filters_->Q(sample.Q_ref);
    out_.dQ_ff = filters_->dQ(sample.dQ_ref);
    out_.ddQ_ff = filters_->ddQ(sample.ddQ_ref);
    out_.Q_cmd = out_.Q_ref;
  }
  if (corrections_.empty()) return out_;

  Offsets offsets =
      corrections_at({t, sample.s, sample.Q_ref, sample.dQ_ref, sample.ddQ_ref, Q_fb, followed});
  if (filters_) {
    offsets.before_filter = filters_->offset(offsets.before_filter);
  }
  out_.Q_cmd += offsets.position_command;
  feed_forward(offsets.before_filter + offsets.feed_forward);
  return out_;
}

Setpoint::Offsets Setpoint::corrections_at(strategies::Reading now) {
  const Joints Q_ref = now.Q_ref;
  Offsets offsets;
  for (Correction& correction : corrections_) {
    // behind the filter, a table is looked up where the axis is sent, not where the program is
    const bool before = correction.in_nc.entry() == EntryPoint::before_filter;
    now.Q_ref = before ? Q_ref : out_.Q_ref;
    const Joints value =
        correction.in_nc.wants_value() ? correction.part->advance(now) : Joints(Joints::Zero());
    offsets.of(correction.in_nc.entry()) += correction.in_nc.advance(value);
  }
  return offsets;
}

std::string_view Setpoint::failure() const {
  for (const Correction& correction : corrections_) {
    if (const auto why = correction.part->failure(); !why.empty()) return why;
  }
  return {};
}

// A correction has no analytic derivative: the NC differentiates it over a position period.
void Setpoint::feed_forward(const Joints& offset) {
  const Joints rate = (offset - fed_forward_) / Tp_;
  out_.Q_cmd += offset;
  out_.dQ_ff += rate;
  // Second difference, one period late, as a control without a model of the correction has it.
  out_.ddQ_ff += (rate - fed_forward_rate_) / Tp_;
  fed_forward_ = offset;
  fed_forward_rate_ = rate;
}

}  // namespace servomill::sim::engine
