#include "strategies/c_strategy.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <limits>
#include <string_view>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "strategies/axis_displacement.h"
#include "strategies/c_declaration.h"
#include "strategies/c_program.h"
#include "strategies/plugin_child.h"
#include "strategies/plugin_watch.h"
#include "strategies/single_run_feedback.h"

namespace servomill::strategies {
namespace {

using IdentifiedModel = IdentifiedMachine;

void copy(const Joints& from, double* to) { std::copy_n(from.data(), kJoints, to); }

servomill_reading reading_of(const Reading& now) {
  servomill_reading out{};
  out.size = sizeof out;
  out.t = now.t;
  out.s = now.s;
  copy(now.Q_ref, out.Q_ref);
  copy(now.dQ_ref, out.dQ_ref);
  copy(now.ddQ_ref, out.ddQ_ref);
  copy(now.Q_fb, out.Q_fb);
  copy(now.Q_cmd, out.Q_cmd);
  return out;
}

std::string_view text(const char* given) { return given != nullptr ? given : ""; }

// The text that a function of a plug-in returned, as an exception.
class Refused : public std::exception {
 public:
  explicit Refused(const char* why) : why_(why) {}
  const char* what() const noexcept override { return why_.c_str(); }

 private:
  std::string why_;
};

void throw_if_refused(const char* why) {
  if (why != nullptr) throw Refused(why);
}

// Displacement of the tool that the identified errors cause, to first order.
void error_at(const void* model, const double* Q, double* error) {
  const auto& identified = *static_cast<const IdentifiedModel*>(model);
  const Eigen::Vector3d d =
      setpoint_displacement(identified, Action::impose, Iterations::one, Joints(Q));
  std::copy_n(d.data(), 3, error);
}

// The same for a strategy that does not declare that it knows errors: its case ends, as it does for
// all that is not finite.
void no_error_at(const void*, const double*, double* error) {
  std::fill_n(error, 3, std::numeric_limits<double>::quiet_NaN());
}

constexpr double kNoPeriod = std::numeric_limits<double>::quiet_NaN();

// Declaration and parameters of a strategy; shared by its runs.
struct Made {
  const servomill_strategy* declared;
  const char* label;
  std::vector<double> parameters;  // SI
  Action action;
  IdentifiedModel identified;

  servomill_setup setup(double period) const {
    servomill_setup out{};
    out.size = sizeof out;
    out.parameters = parameters.data();
    out.parameter_count = parameters.size();
    out.period = period;
    copy(identified.lower, out.lower);
    copy(identified.upper, out.upper);
    for (int j = 0; j < kJoints; ++j) {
      out.axes[j] = identified.layout.has(j) ? identified.layout.letter_of(j) : '\0';
    }
    out.error_at = strategies::no_error_at;
    if (declared->knows_errors != 0) {
      out.sign = static_cast<double>(action);
      out.model = &identified;
      out.error_at = strategies::error_at;
    }
    return out;
  }
};

void settled(const Made& made, void* state, const servomill_reading& reading) {
  if (made.declared->settle == nullptr) return;
  const PluginCall call(made.label);
  throw_if_refused(made.declared->settle(state, &reading));
}

// The state of one run, made when it is settled first.
class CState {
 public:
  CState() = default;
  CState(const CState&) = delete;
  CState& operator=(const CState&) = delete;
  ~CState() {
    if (made_by_ == nullptr || made_by_->declared->destroy == nullptr) return;
    const PluginCall call(made_by_->label);
    made_by_->declared->destroy(state_);
  }

  void* of(const std::shared_ptr<const Made>& made, double period) {
    if (made_by_ == nullptr) {
      const servomill_setup setup = made->setup(period);
      const PluginCall call(made->label);
      throw_if_refused(made->declared->create(&setup, &state_));
      made_by_ = made;
    }
    return state_;
  }
  void* get() const { return state_; }

 private:
  std::shared_ptr<const Made> made_by_;
  void* state_ = nullptr;
};

struct CFeedback {
  using State = CState;
  std::shared_ptr<const Made> made;
  double period;  // s

  Joints settle(const Reading& now, State& state) const {
    void* mine = state.of(made, period);
    const servomill_reading reading = reading_of(now);
    settled(*made, mine, reading);
    return displaced(reading, mine);
  }
  Joints displacement(const Reading& now, State& state) const {
    return displaced(reading_of(now), state.get());
  }

 private:
  Joints displaced(const servomill_reading& reading, void* state) const {
    Joints d = Joints::Zero();
    const PluginCall call(made->label);
    throw_if_refused(made->declared->displacement(state, &reading, d.data()));
    if (made->declared->displaces_rotary == 0 && (d[3] != 0.0 || d[4] != 0.0)) {
      throw Refused("displaces a rotary axis, contrary to its declaration");
    }
    return d;
  }
};

// Calls for one run. What they throw, and values that are not finite, are the end of the run.
class GuardedCalls {
 public:
  explicit GuardedCalls(std::shared_ptr<const Made> made) : made_(std::move(made)) {}

  std::string_view failure() const { return failure_; }
  void* state(double period) { return state_.of(made_, period); }

  template <class Function>
  Joints value(Function function, void* state, const servomill_reading& reading) const {
    Joints out = Joints::Zero();
    const PluginCall call(made_->label);
    throw_if_refused(function(state, &reading, out.data()));
    return out;
  }

  /// @param is_found  false: the value is not finite
  template <class Find>
  void find(const char* function, Find is_found) {
    if (!failure_.empty()) return;
    const auto fail = [&](std::string_view why) {
      failure_ = fmt::format("strategy {}: {}{}", made_->declared->name, function, why);
    };
    try {
      if (!is_found()) fail(" returned a value that is not finite");
    } catch (const std::exception& error) {
      fail(std::string(": ") + error.what());
    } catch (...) {
      fail(": an exception of unknown type");
    }
  }

 private:
  std::shared_ptr<const Made> made_;
  CState state_;
  std::string failure_;
};

class COffset final : public SetpointPart {
 public:
  explicit COffset(std::shared_ptr<const Made> made) : made_(std::move(made)), calls_(made_) {}

  SetpointEntry entry() const override { return {}; }
  std::string_view failure() const override { return calls_.failure(); }

  Joints offset(const Joints& Q_ref) const override {
    Reading now;
    now.Q_ref = now.Q_fb = now.Q_cmd = Q_ref;
    find([&](void* state) {
      const servomill_reading reading = reading_of(now);
      settled(*made_, state, reading);
      return found(state, reading);
    });
    return offset_;
  }
  Joints advance(const Reading& now) override {
    find([&](void* state) { return found(state, reading_of(now)); });
    return offset_;
  }

 private:
  template <class Find>
  void find(Find find_it) const {
    calls_.find("offset", [&] {
      const Joints out = find_it(calls_.state(kNoPeriod));
      if (out.allFinite()) offset_ = out;
      return out.allFinite();
    });
  }
  Joints found(void* state, const servomill_reading& reading) const {
    return calls_.value(made_->declared->offset, state, reading);
  }

  std::shared_ptr<const Made> made_;
  // settling begins a run anew, and is const in SetpointPart
  mutable GuardedCalls calls_;
  mutable Joints offset_ = Joints::Zero();
};

class CPositionLoop final : public PositionLoopPart {
 public:
  CPositionLoop(std::shared_ptr<const Made> made, double period)
      : made_(std::move(made)), calls_(made_), period_(period) {}

  void settle(const Reading& now) override {
    calls_.find("settle", [&] {
      settled(*made_, calls_.state(period_), reading_of(now));
      return true;
    });
  }
  Joints velocity(const Reading& now) override {
    Joints out = Joints::Zero();
    calls_.find("position_loop", [&] {
      out = calls_.value(made_->declared->position_loop, calls_.state(period_), reading_of(now));
      return out.allFinite();
    });
    return out;
  }
  std::string_view failure() const override { return calls_.failure(); }

 private:
  std::shared_ptr<const Made> made_;
  GuardedCalls calls_;
  double period_;  // s
};

// Blocks that `rewrite` makes of a program.
std::vector<servomill_block> blocks_of(const std::shared_ptr<const Made>& made, CProgram& program) {
  CState state;
  void* mine = state.of(made, kNoPeriod);
  {
    const PluginCall call(made->label);
    throw_if_refused(made->declared->rewrite(mine, program.program()));
  }
  return program.take_blocks();
}

// The same, in a process of its own.
std::vector<servomill_block> isolated_blocks_of(const std::shared_ptr<const Made>& made,
                                                CProgram& program) {
  constexpr std::chrono::milliseconds kLookPeriod{20};
  PluginChild child(made->label, [&] {
    return [blocks = blocks_of(made, program)](ProcessPipe& to) {
      const std::size_t count = blocks.size();
      to.write(&count, sizeof count);
      to.write(blocks.data(), count * sizeof(servomill_block));
    };
  });
  child.begin();
  while (!child.wait(kLookPeriod)) throw_if_interrupted();
  std::vector<servomill_block> blocks(child.read<std::size_t>());
  child.read(blocks.data(), blocks.size() * sizeof(servomill_block));
  return blocks;
}

class CStrategy final : public Strategy {
 public:
  explicit CStrategy(Made made) : made_(std::make_shared<const Made>(std::move(made))) {}

  std::unique_ptr<SetpointPart> setpoint() const override {
    if (made_->declared->offset == nullptr) return nullptr;
    return std::make_unique<COffset>(made_);
  }
  std::unique_ptr<PositionLoopPart> position_loop(double period) const override {
    if (made_->declared->position_loop == nullptr) return nullptr;
    return std::make_unique<CPositionLoop>(made_, period);
  }
  bool rewrites() const override { return made_->declared->rewrite != nullptr; }
  void rewrite(const MoveRange& moves, const PutMove& put) const override;
  bool displaces_feedback() const override { return made_->declared->displacement != nullptr; }
  bool displaces_rotary() const override { return made_->declared->displaces_rotary != 0; }
  std::unique_ptr<FeedbackPart> feedback(double model_period) const override {
    if (!displaces_feedback()) return nullptr;
    return std::make_unique<SingleRunFeedback<CFeedback>>(
        made_->declared->name, CFeedback{made_, model_period}, model_period);
  }

 private:
  std::shared_ptr<const Made> made_;
};

void CStrategy::rewrite(const MoveRange& moves, const PutMove& put) const {
  if (!rewrites()) return Strategy::rewrite(moves, put);
  const IdentifiedModel& identified = made_->identified;
  std::vector<servomill_block> blocks;
  std::string wrong;
  try {
    CProgram program(moves, identified.layout, identified.reference);
    blocks =
        plugins_are_isolated() ? isolated_blocks_of(made_, program) : blocks_of(made_, program);
  } catch (const Interrupted&) {
    throw;
  } catch (const PluginFailed&) {
    throw;
  } catch (const std::exception& error) {
    wrong = error.what();
  } catch (...) {
    wrong = "an exception of unknown type";
  }
  if (wrong.empty()) {
    wrong = put_with_blocks(moves, blocks, identified.layout, identified.reference,
                            displaces_rotary(), put);
  }
  if (wrong.empty()) return;
  throw PluginFailed(fmt::format("strategy {}: rewrite: {}", made_->declared->name, wrong));
}

}  // namespace

std::unique_ptr<OwnedEntry> entry_of(const servomill_strategy& declared, const std::string& file) {
  auto out = std::make_unique<OwnedEntry>();
  out->label = fmt::format("strategy {} ({})", declared.name, file);
  out->declared = completed(declared);
  for (std::size_t n = 0; n < declared.parameter_count; ++n) {
    const servomill_parameter& one = *declared.parameters[n];
    out->parameters.push_back({.name = text(one.name),
                               .help = text(one.help),
                               .unit = text(one.unit),
                               .default_text = text(one.default_text),
                               .min = one.min,
                               .max = one.max});
  }
  Entry& entry = out->entry;
  entry.name = declared.name;
  entry.summary = text(declared.summary);
  entry.parameters = out->parameters;
  entry.make = [owned = out.get()](const Parameters& p, Action action,
                                   const IdentifiedModel& identified) {
    Made made{&owned->declared, owned->label.c_str(), {}, action, identified};
    for (const ParameterSpec& one : owned->parameters) {
      made.parameters.push_back(p.number(one.name));
    }
    return std::make_unique<CStrategy>(std::move(made));
  };
  entry.plugin = out->label;
  entry.reads_errors = declared.knows_errors != 0;
  entry.uses_feedback_hardware = declared.displacement != nullptr;
  return out;
}

}  // namespace servomill::strategies
