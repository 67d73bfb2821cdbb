#include "tools/python/strategy_parts.h"

#include <algorithm>
#include <array>
#include <exception>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "plant/vocabulary/interrupt.h"

namespace servomill::python {
namespace {

namespace py = pybind11;

constexpr double kNoPeriod = std::numeric_limits<double>::quiet_NaN();

// Calls `ask` with the GIL; why it failed, or nothing.
template <class Ask>
std::string why_not(const Made& made, const char* function, Ask ask) {
  if (interrupt_wanted) return "interrupted";  // many calls lie between two looks of the run
  const py::gil_scoped_acquire acquired;
  const auto said = [&](const std::string& why) {
    return "strategy " + made->declared->name + ": " + function + why;
  };
  try {
    ask();
    return {};
  } catch (const py::error_already_set& error) {
    return said(": " + in_one_line(error));
  } catch (const std::exception& error) {
    return said(std::string(" ") + error.what());
  }
}

class OffsetPart final : public strategies::SetpointPart {
 public:
  explicit OffsetPart(Made made) : made_(std::move(made)) {}

  SetpointEntry entry() const override { return {}; }
  Joints offset(const Joints& Q_ref) const override {
    instance_.reset();
    return found(Q_ref);
  }
  Joints advance(const strategies::Reading& now) override { return found(now.Q_ref); }
  std::string_view failure() const override { return failure_; }

 private:
  Joints found(const Joints& Q_ref) const {
    if (!failure_.empty()) return offset_;
    Joints next = Joints::Zero();
    failure_ = why_not(made_, "offset", [&] {
      if (instance_ == nullptr) instance_ = instance_of(made_, kNoPeriod);
      call_with_rows(*instance_, "offset", true, {Q_ref.data(), kJoints}, {next.data(), kJoints});
    });
    if (failure_.empty()) offset_ = next;
    return offset_;
  }

  Made made_;
  // settling begins a run anew, and is const in SetpointPart
  mutable Held instance_;
  mutable Joints offset_ = Joints::Zero();
  mutable std::string failure_;
};

class FeedbackOfRuns final : public strategies::FeedbackPart {
 public:
  FeedbackOfRuns(Made made, double period) : made_(std::move(made)), period_(period) {}

  Joints settle(const Joints& Q_meas, std::size_t lane) override {
    Run& run = runs_.at(lane);
    if (!made_->declared->keeps_no_state) run.instance.reset();
    Rows rows{};
    std::copy_n(Q_meas.data(), kJoints, rows.begin());
    if (call(run, rows, 1)) run.next = row_of(rows, 0);
    return run.acting = run.next;
  }

  Joints advance(const JointLanes& Q_meas, std::size_t periods, std::size_t lane) override {
    Run& run = runs_.at(lane);
    Rows rows{};
    for (std::size_t n = 0; n < periods; ++n) take(Q_meas, n, rows, n);
    if (!call(run, rows, periods)) return run.acting = run.next;
    run.acting = periods > 1 ? row_of(rows, periods - 2) : run.next;
    run.next = row_of(rows, periods - 1);
    return run.acting;
  }

  const JointLanes& advance(const JointLanes& Q_meas, const LaneFlags& lanes) override {
    for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
      if (lanes[lane]) runs_[lane].acting = runs_[lane].next;
    }
    if (made_->declared->keeps_no_state) {
      step_together(Q_meas, lanes);
    } else {
      step_each(Q_meas, lanes);
    }
    for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
      for (int j = 0; j < kJoints; ++j) out_[j][lane] = runs_[lane].acting[j];
    }
    return out_;
  }

  std::string_view failure(std::size_t lane) const override { return runs_.at(lane).failure; }

 private:
  using Rows = std::array<double, kLaneWidth * kJoints>;
  struct Run {
    Held instance;
    Joints next = Joints::Zero();  // found, acts a period later
    Joints acting = Joints::Zero();
    std::string failure;
  };

  static void take(const JointLanes& Q, std::size_t lane, Rows& rows, std::size_t row) {
    for (int j = 0; j < kJoints; ++j)
      rows[row * kJoints + static_cast<std::size_t>(j)] = Q[j][lane];
  }
  static Joints row_of(const Rows& rows, std::size_t row) {
    return Joints(rows.data() + row * kJoints);
  }

  Held& instance(Run& run) { return made_->declared->keeps_no_state ? common_ : run.instance; }

  // Replaces the first rows by their displacements; false: the run cannot go on.
  bool call(Run& run, Rows& rows, std::size_t count) {
    if (!run.failure.empty()) return false;
    run.failure = why_not(made_, "step", [&] { ask(instance(run), rows, count); });
    return run.failure.empty();
  }

  void ask(Held& object, Rows& rows, std::size_t count) {
    if (object == nullptr) object = instance_of(made_, period_);
    const Rows given = rows;
    const std::size_t size = count * kJoints;
    call_with_rows(*object, "step", false, {given.data(), size}, {rows.data(), size});
    if (made_->declared->displaces_rotary) return;
    for (std::size_t row = 0; row < count; ++row) {
      if (row_of(rows, row).tail<2>().isZero(0.0)) continue;
      throw std::runtime_error("displaces a rotary axis, contrary to its declaration");
    }
  }

  void step_each(const JointLanes& Q_meas, const LaneFlags& lanes) {
    for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
      if (!lanes[lane]) continue;
      Rows rows{};
      take(Q_meas, lane, rows, 0);
      if (call(runs_[lane], rows, 1)) runs_[lane].next = row_of(rows, 0);
    }
  }

  // One call for all runs. Where it fails, each is asked alone, so that only those end that fail.
  void step_together(const JointLanes& Q_meas, const LaneFlags& lanes) {
    Rows rows{};
    std::array<std::size_t, kLaneWidth> lane_of{};
    std::size_t count = 0;
    for (std::size_t lane = 0; lane < kLaneWidth; ++lane) {
      if (!lanes[lane] || !runs_[lane].failure.empty()) continue;
      take(Q_meas, lane, rows, count);
      lane_of[count++] = lane;
    }
    if (count == 0) return;
    if (!why_not(made_, "step", [&] { ask(common_, rows, count); }).empty()) {
      step_each(Q_meas, lanes);
      return;
    }
    for (std::size_t n = 0; n < count; ++n) runs_[lane_of[n]].next = row_of(rows, n);
  }

  Made made_;
  double period_;  // s
  Held common_;    // of a class that keeps no state
  std::array<Run, kLaneWidth> runs_{};
  JointLanes out_{};
};

}  // namespace

std::unique_ptr<strategies::SetpointPart> offset_part(const Made& made) {
  return std::make_unique<OffsetPart>(made);
}

std::unique_ptr<strategies::FeedbackPart> feedback_part(const Made& made, double model_period) {
  return std::make_unique<FeedbackOfRuns>(made, model_period);
}

}  // namespace servomill::python
