// O-words: labels and subroutines; M98 and M99.
#include <fmt/format.h>

#include <cmath>

#include "controllers/gcode/interpreter_machine.h"

namespace servomill::controllers {
namespace {

// Subroutines are known everywhere, other labels within their subroutine only.
bool is_global(Flow flow) {
  switch (flow) {
    case Flow::sub:
    case Flow::endsub:
    case Flow::return_:
    case Flow::call:
    case Flow::program:
    case Flow::m98:
    case Flow::m99:
      return true;
    default:
      return false;
  }
}

// Unknown names count as 0 while it lives.
class Forgiving {
 public:
  explicit Forgiving(Parameters& parameters) : parameters_(parameters) {
    parameters_.forgive_unknown_names(true);
  }
  Forgiving(const Forgiving&) = delete;
  Forgiving& operator=(const Forgiving&) = delete;
  ~Forgiving() { parameters_.forgive_unknown_names(false); }

 private:
  Parameters& parameters_;
};

}  // namespace

// The subroutine whose labels are meant: that which runs or is being defined, or "" outside of all.
const std::string& Interpreter::Machine::scope_name() const {
  static const std::string outside;
  if (!flow_.calls.empty()) return flow_.calls.back().name;
  return flow_.defining ? *flow_.defining : outside;
}

// As the program says it: a name, or a whole number.
std::string Interpreter::Machine::label_text(const OWord& o) const {
  if (o.name >= 0) return block_.names[static_cast<std::size_t>(o.name)];
  const double value = evaluate(o.number, block_, parameters_, file());
  const double nearest = std::round(value);
  if (!(std::abs(value - nearest) <= kIntegerTol) || std::abs(nearest) > 1e9) {
    fail(o.column,
         fmt::format("{}{}; must be an integer", o.flow == Flow::m98 ? "M98 P" : "O", value));
  }
  return fmt::format("{}", static_cast<long>(nearest));
}

std::string Interpreter::Machine::label_of(const OWord& o) const {
  if (o.flow == Flow::m99) return scope_name();
  std::string label = label_text(o);
  return is_global(o.flow) ? label : scope_name() + "#" + label;
}

double Interpreter::Machine::flow_value(const OWord& o) {
  return o.has_value ? evaluate(o.value, block_, parameters_, file()) : 0.0;
}

void Interpreter::Machine::skip_to(const std::string& label) {
  flow_.skip_to = label;
  flow_.skip_from = line();
}

void Interpreter::Machine::go_to(const LinePlace& place) {
  text_ = place.text;
  text().go_to(place.mark);
}

// Called where the program turns back or into a subroutine. Long bodies count for more, so that an
// endless program is stopped in seconds, whatever it does.
void Interpreter::Machine::count_jump() {
  constexpr long kLinesOfATurn = 10;
  const bool is_endless =
      ++flow_.jumps > setup_.most_jumps || flow_.lines > kLinesOfATurn * setup_.most_jumps;
  if (!is_endless) return;
  fail(block_.o_word.column, fmt::format("{} loop iterations and subroutine calls, {} lines; the "
                                         "program appears to loop endlessly",
                                         flow_.jumps, flow_.lines));
}

Label& Interpreter::Machine::new_label(const std::string& name, Flow flow) {
  return flow_.labels[name] = {flow, here_, std::nullopt};
}

void Interpreter::Machine::run_flow() {
  const OWord& o = block_.o_word;
  if (o.flow == Flow::m99 && flow_.calls.empty()) {  // of the program itself: its end
    block_.words.push_back({'M', {99.0, 0, 0}, o.column});
    block_.o_word.flow = Flow::none;
    return run_block();
  }
  const std::string name = label_of(o);
  if (flow_.skips_to_sub && o.flow != Flow::sub && o.flow != Flow::program) return;
  switch (o.flow) {
    case Flow::sub:
    case Flow::program:
      return begin_subroutine(name, o);
    case Flow::endsub:
    case Flow::return_:
    case Flow::m99:
      return end_subroutine(name, o);
    case Flow::call:
      return call_subroutine(name, o);
    case Flow::m98:
      return call_subprogram(name, o);
    case Flow::do_:
      flow_.skip_to.reset();
      if (!flow_.labels.contains(name)) new_label(name, Flow::do_);
      return;
    case Flow::while_:
      return while_line(name, o);
    case Flow::repeat:
      return repeat(name, o);
    case Flow::if_:
    case Flow::elseif:
    case Flow::else_:
    case Flow::endif:
      return branch(name, o);
    case Flow::break_:
    case Flow::continue_:
      return leave_loop(name, o);
    case Flow::endwhile:
    case Flow::endrepeat:
      return end_loop(name, o);
    case Flow::none:
    case Flow::unknown:
      return;
  }
}

// ------------------------------------------------------------------------------------ subroutines

void Interpreter::Machine::begin_subroutine(const std::string& name, const OWord& o) {
  if (flow_.defining) {
    fail(o.column, fmt::format("a subroutine within the definition of O<{}>", *flow_.defining));
  }
  if (!flow_.calls.empty()) {
    const bool by_m98 = flow_.calls.back().flow == Flow::m98;
    if (o.flow == Flow::program && !by_m98) {
      fail(o.column, fmt::format("O{} is a subprogram; call it with M98 P{}", name, name));
    }
    if (o.flow == Flow::sub && by_m98) {
      fail(o.column, fmt::format("O<{}> is a subroutine; call it with O<{}> CALL", name, name));
    }
  }
  const auto known = flow_.labels.find(name);
  const bool is_sought = flow_.skip_to.has_value();
  flow_.skip_to.reset();
  flow_.skips_to_sub = false;
  if (is_sought && known == flow_.labels.end()) new_label(name, o.flow);
  if (o.flow == Flow::program || !flow_.calls.empty()) return;
  if (known != flow_.labels.end()) {
    fail(o.column,
         known->second.place == here_
             ? fmt::format("the program runs into O<{}>, which it has already called", name)
             : fmt::format("O<{}> is already defined in line {}", name,
                           known->second.place.mark.line + 1));
  }
  new_label(name, o.flow);
  flow_.defining = name;
  skip_to(name);
}

void Interpreter::Machine::keep_result(const OWord& o) {
  flow_.value = flow_value(o);
  flow_.has_value = o.has_value;
}

// As LinuxCNC: a definition that is passed over leaves its result, too.
void Interpreter::Machine::end_subroutine(const std::string& name, const OWord& o) {
  if (flow_.calls.empty()) {
    if (!flow_.defining) fail(o.column, fmt::format("subroutine O<{}> has not started", name));
    const Forgiving forgiving(parameters_);
    keep_result(o);
    if (o.flow != Flow::endsub) return;
    flow_.skip_to.reset();
    flow_.defining.reset();
    return;
  }
  const bool by_m98 = flow_.calls.back().flow == Flow::m98;
  if (by_m98 != (o.flow == Flow::m99)) {
    fail(o.column, by_m98 ? "a subprogram called by M98 must end with M99"
                          : "a subroutine must end with ENDSUB or RETURN, not with M99");
  }
  keep_result(o);
  if (o.flow == Flow::endsub) flow_.skip_to.reset();
  leave_call();
}

void Interpreter::Machine::leave_call() {
  const Call call = std::move(flow_.calls.back());
  flow_.calls.pop_back();
  flow_.turns_left.pop_back();
  parameters_.commit();
  parameters_.leave_scope();
  if (call.flow == Flow::call) {
    for (int i = 0; i < kArguments; ++i) {
      parameters_.set(i + 1, call.saved[static_cast<std::size_t>(i)]);
    }
  }
  restore_on_return();
  go_to(call.return_to);
}

void Interpreter::Machine::call_subroutine(const std::string& name, const OWord& o) {
  if (o.arguments.size() > kArguments) {
    fail(o.column, fmt::format("{} arguments; a subroutine accepts at most {}", o.arguments.size(),
                               kArguments));
  }
  std::array<double, kArguments> arguments{};
  for (std::size_t i = 0; i < o.arguments.size(); ++i) {
    arguments[i] = evaluate(o.arguments[i], block_, parameters_, file());
  }
  enter_call(name, o, {text_, text().mark()});
  for (int i = 0; i < kArguments; ++i) {
    const auto k = static_cast<std::size_t>(i);
    flow_.calls.back().saved[k] = parameters_.get(i + 1);
    parameters_.set(i + 1, arguments[k]);
  }
  find_subroutine(name);
}

namespace {

std::string word_behind_call(char letter) {
  if (letter == 'Q') {
    return "Q with M98: no effect (LinuxCNC), or the block where the subprogram starts (Fanuc); "
           "remove it, or choose with --reader linuxcnc";
  }
  return fmt::format(
      "{} after M98: no effect (LinuxCNC), or executed before the call (Fanuc, Haas); program it "
      "in a separate block, or choose with --reader linuxcnc",
      letter);
}

}  // namespace

// With L it is this block that runs again and again, so P may change from turn to turn.
void Interpreter::Machine::call_subprogram(const std::string& name, const OWord& o) {
  long& turns = flow_.turns_left.back();
  if (o.has_value) {
    const double L = flow_value(o);
    if (!(std::abs(L - std::round(L)) <= kIntegerTol) || L < -kIntegerTol || L > 1e9) {
      fail(o.value_column, fmt::format("L{}; must be an integer >= 0", L));
    }
    if (turns == 0) turns = std::lround(L);
    if (turns == 0) return;
    --turns;
  }
  for (const Word& word : block_.words) {
    if (word.letter == 'P' || word.letter == 'L') continue;
    if (setup_.reader != Reader::linuxcnc) fail(word.column, word_behind_call(word.letter));
    warn(word.column, fmt::format("{} word in the block of M98 has no effect", word.letter));
  }
  const bool again = o.has_value && turns > 0;
  enter_call(name, o, again ? here_ : LinePlace{text_, text().mark()});
  find_subroutine(name);
}

void Interpreter::Machine::enter_call(const std::string& name, const OWord& o,
                                      const LinePlace& return_to) {
  if (flow_.calls.size() == kMaxCalls) {
    const bool is_recursive = std::any_of(flow_.calls.begin(), flow_.calls.end(),
                                          [&](const Call& call) { return call.name == name; });
    fail(o.column, fmt::format("subroutine calls nested deeper than {}{}", kMaxCalls,
                               is_recursive ? fmt::format(": O<{}> calls itself", name) : ""));
  }
  count_jump();
  Call call;
  call.name = name;
  call.flow = o.flow;
  call.return_to = return_to;
  call.line = line();
  flow_.calls.push_back(std::move(call));
  flow_.turns_left.push_back(0);
  parameters_.enter_scope();
}

namespace {

bool holds_program_number(ProgramText& text) {
  bool found = false;
  for (std::string_view line; !found && text.next(line);) {
    const std::size_t at = line.find_first_not_of(" \t");
    if (at == std::string_view::npos || at + 1 >= line.size()) continue;
    const bool is_label = line[at] == 'O' || line[at] == 'o' || line[at] == ':';
    found = is_label && line[at + 1] >= '0' && line[at + 1] <= '9';
  }
  text.rewind();
  return found;
}

}  // namespace

// Looks at its known place, then for a file of its name, then further on in this text.
void Interpreter::Machine::find_subroutine(const std::string& name) {
  if (const auto known = flow_.labels.find(name); known != flow_.labels.end()) {
    return go_to(known->second.place);
  }
  std::optional<ProgramText> found;
  if (setup_.subroutine_file) found = setup_.subroutine_file(name);
  const bool is_ngc = found && found->file().ends_with(".ngc");
  if (found && !is_ngc && !tolerates(ReaderRule::subprogram_file, 0)) found.reset();
  // a file that has no O number is its subprogram from its first line on
  if (!found || is_ngc || holds_program_number(*found)) {
    skip_to(name);
    flow_.skips_to_sub = true;
  }
  if (!found) return;
  texts_.push_back({std::move(*found), {}, 0});
  text_ = texts_.size() - 1;
}

}  // namespace servomill::controllers
