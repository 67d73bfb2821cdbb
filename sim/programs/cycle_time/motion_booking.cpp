#include "sim/programs/cycle_time/motion_booking.h"

#include <fmt/format.h>

#include <algorithm>

#include "controllers/path/feed_reduction.h"
#include "sim/model/machine.h"

namespace servomill::sim::programs {

DurationSettings MotionBooking::with_booking(const DurationSettings& settings) {
  DurationSettings out = settings;
  out.on_part = [this](const PlannedPart& part) { book(part); };
  return out;
}

MotionBooking::MotionBooking(const model::MachineSettings& machine,
                             const DurationSettings& settings, double raise, unsigned threads)
    : machine_(machine),
      raise_(raise),
      file_(settings.file),
      duration_(machine, with_booking(settings)),
      accountant_(machine.chain.layout, duration_.limits(), duration_.options()) {
  if (raise > 0.0) raised_.emplace(machine, duration_, settings, raise, threads);
}

void MotionBooking::book(const PlannedPart& part) {
  for (const controllers::FeedReduction& slowed : part.slowed) {
    slowed_.push_back({{file_, slowed.line}, to_string(slowed, machine_.chain.layout)});
  }
  travel_.insert(travel_.end(), part.travel.begin(), part.travel.end());
  accountant_.add(part);
  if (raised_) raised_->add(part);
}

void MotionBooking::finish(CycleTimeReport& report, bool warns_of_travel) {
  duration_.finish();
  report.machine = machine_.name;
  report.layout = machine_.chain.layout;
  report.accounts = accountant_.take();
  report.tool_change_time = machine_.nc.tool_change_time;
  report.spindle_time = machine_.nc.spindle_time;
  report.knows_spindle = machine_.nc.spindle.has_value();
  report.left_out = duration_.left_out();
  report.unknown_dwells = duration_.unknown_dwells();
  report.unknown_moves = duration_.unknown_moves();
  report.raise = raise_;
  if (raised_) report.raised = raised_->result();
  report.warnings.insert(report.warnings.end(), slowed_.begin(), slowed_.end());
  if (!warns_of_travel) return;
  constexpr std::size_t kMax = 10;
  const std::size_t shown = std::min(travel_.size(), kMax);
  report.warnings.insert(report.warnings.end(), travel_.begin(),
                         travel_.begin() + static_cast<std::ptrdiff_t>(shown));
  if (travel_.size() <= shown) return;
  report.warnings.push_back(
      {{file_}, fmt::format("{} more moves leave the travel", travel_.size() - shown)});
}

}  // namespace servomill::sim::programs
