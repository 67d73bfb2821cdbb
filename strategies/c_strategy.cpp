#include "strategies/c_strategy.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <exception>
#include <string_view>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "strategies/axis_displacement.h"
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
      throw Refused("displaces a rotary axis, and its declaration says that it does not");
    }
    return d;
  }
};

class COffset final : public SetpointPart {
 public:
  explicit COffset(std::shared_ptr<const Made> made) : made_(std::move(made)) {}

  SetpointEntry entry() const override { return {}; }
  std::string_view failure() const override { return failure_; }

  Joints offset(const Joints& Q_ref) const override {
    Reading now;
    now.Q_ref = now.Q_fb = Q_ref;
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
  Joints found(void* state, const servomill_reading& reading) const {
    Joints out = Joints::Zero();
    const PluginCall call(made_->label);
    throw_if_refused(made_->declared->offset(state, &reading, out.data()));
    return out;
  }
  template <class Find>
  void find(Find find_it) const {
    if (!failure_.empty()) return;
    try {
      const Joints out = find_it(state_.of(made_, 0.0));
      if (out.allFinite()) {
        offset_ = out;
      } else {
        failure_ =
            fmt::format("strategy {}: offset returned what is not finite", made_->declared->name);
      }
    } catch (const std::exception& error) {
      failure_ = fmt::format("strategy {}: offset: {}", made_->declared->name, error.what());
    } catch (...) {
      failure_ =
          fmt::format("strategy {}: offset: an exception of unknown type", made_->declared->name);
    }
  }

  std::shared_ptr<const Made> made_;
  // settling begins a run anew, and is const in SetpointPart
  mutable CState state_;
  mutable Joints offset_ = Joints::Zero();
  mutable std::string failure_;
};

// Blocks that `rewrite` makes of a program.
std::vector<servomill_block> blocks_of(const std::shared_ptr<const Made>& made, CProgram& program) {
  CState state;
  void* mine = state.of(made, 0.0);
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
  bool rewrites() const override { return made_->declared->rewrite != nullptr; }
  std::vector<Move> rewrite(const std::vector<Move>& moves) const override;
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

std::vector<Move> CStrategy::rewrite(const std::vector<Move>& moves) const {
  if (!rewrites()) return moves;
  const IdentifiedModel& identified = made_->identified;
  std::string wrong;
  try {
    CProgram program(moves, identified.layout, identified.reference);
    const std::vector<servomill_block> blocks =
        plugins_are_isolated() ? isolated_blocks_of(made_, program) : blocks_of(made_, program);
    std::vector<Move> out = with_blocks(moves, blocks, identified.layout, identified.reference,
                                        displaces_rotary(), wrong);
    if (wrong.empty()) return out;
  } catch (const Interrupted&) {
    throw;
  } catch (const PluginFailed&) {
    throw;
  } catch (const std::exception& error) {
    wrong = error.what();
  } catch (...) {
    wrong = "an exception of unknown type";
  }
  throw PluginFailed(fmt::format("strategy {}: rewrite: {}", made_->declared->name, wrong));
}

bool is_name(std::string_view name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return ('a' <= c && c <= 'z') || ('0' <= c && c <= '9') || c == '_';
  });
}

bool is_number(std::string_view text) {
  try {
    std::size_t end = 0;
    std::stod(std::string(text), &end);
    return end == text.size();
  } catch (const std::exception&) {
    return false;
  }
}

// Bytes of the struct as the first headers of this ABI version had it; what follows was appended.
constexpr std::size_t kFirstSize = offsetof(servomill_strategy, rewrite);
constexpr std::size_t kMostSize = 1024;

// A struct of a library that was built with other headers: as far as both know it.
servomill_strategy completed(const servomill_strategy& declared) {
  servomill_strategy out{};
  std::memcpy(&out, &declared, std::min(declared.size, sizeof out));
  return out;
}

bool has_unknown_parts(const servomill_strategy& declared) {
  const char* const bytes = reinterpret_cast<const char*>(&declared);
  return declared.size > sizeof declared &&
         std::any_of(bytes + sizeof declared, bytes + declared.size, [](char c) { return c != 0; });
}

std::string wrong_with(const servomill_parameter* one) {
  if (one == nullptr || one->size < sizeof(servomill_parameter)) return "is not declared";
  if (one->name == nullptr || *one->name == '\0') return "has no name";
  if (!text(one->default_text).empty() && !is_number(text(one->default_text))) {
    return fmt::format("has the default '{}', which is no number", one->default_text);
  }
  if (!(one->min <= one->max)) return "has a minimum above its maximum";
  return "";
}

}  // namespace

std::string wrong_with(const servomill_strategy& declared) {
  if (declared.size < kFirstSize || declared.size > kMostSize) {
    return fmt::format("its struct has {} bytes, expected {} to {}", declared.size, kFirstSize,
                       kMostSize);
  }
  if (has_unknown_parts(declared)) {
    return "has functions that this program does not know: it was built for a later one";
  }
  const servomill_strategy full = completed(declared);
  if (!is_name(text(declared.name))) {
    return fmt::format("'{}' is no name: lower case, digits and '_'", text(declared.name));
  }
  if (declared.create == nullptr) return "lacks the function create";
  if (full.displacement == nullptr && full.offset == nullptr && full.rewrite == nullptr) {
    return "has none of the functions displacement, offset and rewrite";
  }
  for (std::size_t n = 0; n < declared.parameter_count; ++n) {
    if (const std::string wrong = wrong_with(declared.parameters[n]); !wrong.empty()) {
      return fmt::format("parameter {} {}", n, wrong);
    }
  }
  return "";
}

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
