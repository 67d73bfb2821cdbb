#include "controllers/dialects/siemens_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "controllers/dialects/siemens_block.h"
#include "controllers/dialects/siemens_state.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr double kLongestDwell = 1e6;  // s

// DEF INT NERR and WRITE(NERR,"file",...), the report of a measurement ([P] p. 566), with or
// without a block number: they move nothing.
bool is_report(std::string_view line) {
  const auto skip_blanks = [&line] {
    while (line.starts_with(' ')) line.remove_prefix(1);
  };
  skip_blanks();
  if (line.size() > 1 && line[0] == 'N' && line[1] >= '0' && line[1] <= '9') {
    const std::size_t end = line.find_first_not_of("0123456789", 1);
    line.remove_prefix(std::min(end, line.size()));
    skip_blanks();
  }
  return line == "DEF INT NERR" || (line.starts_with("WRITE(NERR,\"") && line.ends_with(')'));
}

bool is_stop(int M) { return M == 0 || M == 1; }
bool is_end(int M) { return M == 2 || M == 17 || M == 30; }

class Reader {
 public:
  Reader(const std::string& file, const ControlSetup& setup, const SiemensSettings& settings,
         const SiemensRules& rules)
      : context_{file, setup, settings, rules} {
    state_.position = setup.start;
  }

  std::vector<MachineAction> read(std::string_view text) {
    int line = 0;
    while (!text.empty() && !has_ended_) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      std::string_view now = text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
      if (!now.empty() && now.back() == '\r') now.remove_suffix(1);
      ++line;
      if (line == 1 && !now.empty() && now.front() == '%') continue;  // "%_N_SHAFT_MPF" [P] p. 43
      read_line(now, line);
    }
    if (!has_ended_) fail(std::max(line, 1), 1, "the program ends without M2, M17 or M30");
    return std::move(actions_);
  }

 private:
  [[noreturn]] void fail(int line, int column, std::string message) const {
    context_.fail(line, column, std::move(message));
  }
  [[noreturn]] void fail(int column, std::string message) const {
    fail(block_.line, column, std::move(message));
  }
  [[noreturn]] void fail(std::string message) const {
    fail(block_.line, block_.column, std::move(message));
  }

  void read_line(std::string_view text, int line) {
    if (is_report(text)) return;
    const SiemensLine words = siemens_words(text, line, context_.file);
    if (words.is_empty) return;
    block_ = siemens_block(words, line, context_.file);
    if (words.is_skippable && context_.setup.skips_blocks) return;
    carry_wrong_rules();
    check_block();
    if (block_.MEAS && !block_.moves()) fail(block_.MEAS->column, "MEAS requires an axis");
    set_modes();
    set_numbers();
    if (block_.has(SiemensGroup::dwell)) return dwell();
    if (block_.T || has_M(6)) change_tool();
    if (!context_.rules.stop_acts_after_motion) stop();
    switch_spindle();
    switch_coolant();
    if (block_.moves()) actions_.push_back(siemens_motion(state_, block_, context_));
    if (context_.rules.stop_acts_after_motion) stop();
    end_block();
  }

  // Only rules that a test has set wrong outlive their block.
  void carry_wrong_rules() {
    const auto carry = [&](SiemensGroup group, bool is_right, std::optional<SiemensCode>& kept) {
      std::optional<SiemensCode>& now = block_.codes[static_cast<std::size_t>(group)];
      if (now) kept = now;
      if (!is_right) now = kept;
    };
    carry(SiemensGroup::suppression, context_.rules.SUPA_ends_with_its_block, last_SUPA_);
    carry(SiemensGroup::exact_stop, context_.rules.G9_ends_with_its_block, last_G9_);
  }

  bool has_M(int number) const {
    return std::any_of(block_.M.begin(), block_.M.end(),
                       [&](const SiemensNumber& M) { return M.value == number; });
  }

  // Words that may share a block.
  void check_block() const {
    for (const SiemensGroup group : {SiemensGroup::frame, SiemensGroup::transformation}) {
      if (block_.has(group) && block_.words > 1) {
        fail(block_.code(group)->column,
             fmt::format("{} must be in a separate block", block_.code(group)->name));
      }
    }
    if (block_.smoothing && block_.words > 1) {
      fail(block_.smoothing->column, "CYCLE832 must be in a separate block");
    }
    if (block_.has(SiemensGroup::dwell)) {
      const bool has_one = block_.F.has_value() != block_.S.has_value();
      if (!has_one || block_.words != 2) {
        fail("G4 must be in a separate block, with F in seconds or S in revolutions");
      }
    }
    check_M();
  }

  // Before or after the motion: MD22200 and its like, set by the builder, for all but M0, M1, M2,
  // M17 and M30, which act after it (M).
  void check_M() const {
    const auto of_group = [&](std::initializer_list<int> group) {
      std::ptrdiff_t count = 0;
      for (const SiemensNumber& M : block_.M) {
        count += std::count(group.begin(), group.end(), static_cast<int>(M.value));
      }
      return count;
    };
    if (of_group({0, 1, 2, 17, 30}) > 1 || of_group({3, 4, 5}) > 1 || of_group({7, 8, 9}) > 1 ||
        of_group({6}) > 1) {
      fail(block_.M.back().column, "two M functions of the same group in one block");
    }
    const bool has_T = block_.T || has_M(6);
    if (has_T && block_.words > (block_.T ? 1 : 0) + (has_M(6) ? 1 : 0) + (block_.D ? 1 : 0)) {
      fail("a tool change must be in a separate block, with T, M6 and D only");
    }
    if (!block_.moves()) return;
    for (const SiemensNumber& M : block_.M) {
      if (!is_stop(static_cast<int>(M.value)) && !is_end(static_cast<int>(M.value))) {
        fail(M.column, fmt::format("M{} in a block with a motion: the machine builder defines "
                                   "whether it acts before or after the motion",
                                   M.value));
      }
    }
    if (block_.S) {
      fail(block_.S->column,
           "S in a block with a motion: the machine builder defines whether it acts before or "
           "after the motion");
    }
  }

  int number_of(SiemensGroup group) const { return block_.code(group)->value; }

  void set_modes() {
    using enum SiemensGroup;
    if (block_.has(motion)) {
      state_.motion = block_.code(motion)->name == "CIP" ? kThroughPoint : number_of(motion);
    }
    if (block_.has(plane)) state_.normal_axis = 19 - number_of(plane);
    if (block_.has(cutter)) state_.is_cutter_off = true;
    if (block_.has(frame)) state_.is_frame_clear = true;
    if (block_.has(transformation)) state_.is_transformation_off = true;
    if (block_.has(path)) state_.path = number_of(path);
    if (block_.has(distance)) state_.is_incremental = number_of(distance) == 91;
    if (block_.has(rapid)) state_.is_rapid_linear = block_.code(rapid)->name == "RTLION";
    if (block_.has(work_offset)) {
      const int number = number_of(work_offset);
      state_.work_offset = number < 100 ? number - 53 : number - 500;
    }
    if (block_.has(units)) {
      const int number = number_of(units);
      state_.units = SiemensUnits{number == 70 || number == 700 ? inch : mm, number >= 700};
    }
    if (block_.has(feed)) set_feed_mode(number_of(feed));
  }

  void set_feed_mode(int number) {
    const FeedMode mode = number == 93   ? FeedMode::inverse_time
                          : number == 94 ? FeedMode::units_per_minute
                                         : FeedMode::units_per_revolution;
    if (state_.feed_mode != mode && context_.rules.F_ends_with_its_kind) state_.F.reset();
    state_.feed_mode = mode;
  }

  double length_of(const SiemensNumber& word) const {
    if (!state_.units) fail(word.column, "the unit system is unknown; program G710 or G700");
    return word.value * state_.units->length;
  }

  void set_numbers() {
    const bool is_dwell = block_.has(SiemensGroup::dwell);
    if (block_.F && !(is_dwell && context_.rules.F_of_G4_is_time)) {
      if (!(block_.F->value > 0.0))
        fail(block_.F->column, fmt::format("F = {}; must be > 0", block_.F->value));
      state_.F = block_.F->value;
    }
    if (block_.S && !(block_.S->value >= 0.0)) {
      fail(block_.S->column, fmt::format("S = {}; must be >= 0", block_.S->value));
    }
    if (block_.D && !block_.T && !has_M(6)) state_.D = static_cast<int>(block_.D->value);
    if (block_.ADIS) state_.ADIS = length_of(*block_.ADIS);
    if (block_.CTOL) {
      state_.CTOL.reset();
      if (block_.CTOL->value > 0.0) state_.CTOL = length_of(*block_.CTOL);
    }
    if (block_.smoothing) {
      state_.path.reset();
      if (const auto tolerance = block_.smoothing->tolerance) {
        state_.path = 832;
        state_.smoothing = length_of({*tolerance, SiemensForm::number, block_.smoothing->column});
      }
    }
  }

  MachineAction& add(ActionKind kind) {
    MachineAction& action = actions_.emplace_back();
    action.kind = kind;
    action.line = block_.line;
    action.end = state_.position;
    action.tool = state_.tool.value_or(0);
    return action;
  }

  void dwell() {
    double seconds = 0.0;
    if (block_.F) {
      seconds = block_.F->value;
    } else {
      if (!state_.S || *state_.S == 0.0 || !state_.direction || *state_.direction == 0) {
        fail(block_.S->column, "G4 S is in spindle revolutions and requires a running spindle");
      }
      seconds = block_.S->value * minute / *state_.S;
    }
    if (!(seconds >= 0.0 && seconds <= kLongestDwell)) {
      fail(fmt::format("dwell time {:g} s; must be from 0 to {:g} s", seconds, kLongestDwell));
    }
    add(ActionKind::dwell).value = seconds;
  }

  void change_tool() {
    const bool is_M6 = has_M(6);
    const bool changes_here = context_.settings.T_changes_tool ? block_.T.has_value() : is_M6;
    if (block_.D && !is_M6 && !context_.settings.T_changes_tool) {
      fail(block_.D->column,
           "D with T but without M6: it is undetermined whether it applies to the old or the new "
           "tool");
    }
    if (block_.T) state_.selected = block_.T->number;
    if (is_M6 && !state_.selected) fail("M6 requires T: the tool is unknown");
    if (changes_here) put_tool_in();
    if (changes_here || is_M6) forget_after_change();
    if (changes_here) add(ActionKind::tool).number = *state_.tool;
  }

  void put_tool_in() {
    state_.tool = state_.selected;
    const int D = context_.settings.default_D;
    if (D >= 0) state_.D = D;
    if (block_.D) state_.D = static_cast<int>(block_.D->value);
    // The length acts with the next motion: the positions stay.
  }

  void forget_after_change() {
    if (!context_.settings.M6_is_macro || !context_.rules.macro_forgets_state) return;
    SiemensState now;
    now.tool = state_.tool;
    now.selected = state_.selected;
    state_ = now;
  }

  void switch_spindle() {
    const bool has_switch = has_M(3) || has_M(4) || has_M(5);
    if (block_.S) {
      // G96 would make it a cutting speed, and it is of the group of G93, G94 and G95.
      if (!state_.feed_mode)
        fail(block_.S->column,
             "S requires an active G93, G94 or G95: with G96 it is not a spindle speed");
      state_.S = block_.S->value;
    }
    if (has_switch) {
      state_.direction = has_M(3) ? 1 : has_M(4) ? -1 : 0;
    } else if (!block_.S || state_.direction.value_or(0) == 0) {
      return;
    }
    if (*state_.direction != 0 && !state_.S) fail("the spindle starts, but S is unknown");
    MachineAction& action = add(ActionKind::spindle);
    action.direction = *state_.direction;
    action.value = action.direction == 0 ? 0.0 : *state_.S * rpm;
  }

  void switch_coolant() {
    if (!has_M(7) && !has_M(8) && !has_M(9)) return;
    state_.coolant = has_M(9) ? 0 : state_.coolant | (has_M(7) ? 1 : 2);
    add(ActionKind::coolant).number = state_.coolant;
  }

  void stop() {
    for (const SiemensNumber& M : block_.M) {
      const int number = static_cast<int>(M.value);
      if (is_stop(number)) {
        if (context_.rules.stop_forgets_positions) state_.forget_positions();
        add(ActionKind::stop).number = number;
      }
      if (is_end(number)) {
        add(ActionKind::end);
        has_ended_ = true;
      }
    }
  }

  void end_block() {
    if (context_.rules.IC_ends_with_its_block) return;
    for (const auto& axis : block_.axes) {
      if (axis && axis->form == SiemensForm::incremental) state_.is_incremental = true;
    }
  }

  SiemensContext context_;
  SiemensState state_;
  SiemensBlock block_;
  std::optional<SiemensCode> last_SUPA_, last_G9_;
  std::vector<MachineAction> actions_;
  bool has_ended_ = false;
};

}  // namespace

std::string to_string(const SiemensSettings& settings) {
  std::string text = fmt::format("MD20270={} MD10760={:d} MD22550={:d} SD42940={} {}",
                                 settings.default_D, settings.SUPA_drops_length,
                                 !settings.T_changes_tool, settings.length_follows_plane ? 0 : 17,
                                 settings.M6_is_macro ? "M6 a macro" : "plain M6");
  for (std::size_t i = 0; i < settings.is_modulo.size(); ++i) {
    if (settings.is_modulo[i]) text += fmt::format(" {} MD30310=1", "ABC"[i]);
  }
  if (settings.G90_is_shortest) text += " MD30455.2=1";
  return text;
}

std::vector<SiemensSettings> all_siemens_settings(std::array<bool, 3> may_be_modulo) {
  std::vector<SiemensSettings> out;
  for (const bool SUPA_drops_length : {true, false}) {
    for (const bool T_changes_tool : {false, true}) {
      for (const bool length_follows_plane : {true, false}) {
        // A macro may leave any D behind, whatever MD20270 says.
        SiemensSettings one{.SUPA_drops_length = SUPA_drops_length,
                            .T_changes_tool = T_changes_tool,
                            .length_follows_plane = length_follows_plane};
        out.push_back(one);
        one.M6_is_macro = false;
        for (const int default_D : {0, 1, -1}) {
          one.default_D = default_D;
          out.push_back(one);
        }
      }
    }
  }
  if (may_be_modulo != std::array<bool, 3>{}) {
    for (const bool G90_is_shortest : {false, true}) {
      out.push_back({.is_modulo = may_be_modulo, .G90_is_shortest = G90_is_shortest});
    }
  }
  return out;
}

std::vector<MachineAction> read_siemens(std::string_view text, const std::string& file,
                                        const ControlSetup& setup, const SiemensSettings& settings,
                                        const SiemensRules& rules) {
  return Reader(file, setup, settings, rules).read(text);
}

}  // namespace servomill::controllers
