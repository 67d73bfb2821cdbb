#include "controllers/gcode/readers/block_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "controllers/gcode/modal_groups.h"
#include "controllers/gcode/readers/possible_readers.h"
#include "controllers/gcode/readers/reading_step.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr std::uint32_t bits(std::string_view letters) {
  std::uint32_t out = 0;
  for (const char letter : letters) out |= word_bit(letter);
  return out;
}
constexpr std::uint32_t kOffsets = bits("DH"), kAxisWordBits = bits("XYZABC@^"),
                        kPlaces = kAxisWordBits | bits("IJKR"), kCentres = bits("IJK");

// Codes of LinuxCNC that another control reads differently, or with other words.
bool is_special(char letter, int tenths) {
  constexpr std::array kG = {40,  50,  51,  52,  53,  100, 280, 281, 300,
                             301, 410, 420, 430, 530, 690, 921, 980, 990};
  constexpr std::array kM = {500, 510, 520, 530, 980};
  return letter == 'G' ? std::find(kG.begin(), kG.end(), tenths) != kG.end()
                       : std::find(kM.begin(), kM.end(), tenths) != kM.end();
}

// Codes of a block, as far as they tell that no rule concerns it.
struct PlainCodes {
  bool are_plain = true;
  bool turns_spindle = false;
  int motion = -1;  // tenths
  std::uint32_t groups = 0;

  void add(const Word& word) {
    const int tenths = word.value.is_constant() ? tenths_of(word.value.number) : -1;
    const Code* code = find_code(word.letter, tenths);
    if (code == nullptr || !code->supported || is_special(word.letter, tenths)) {
      are_plain = false;
      return;
    }
    const std::uint32_t group = 1U << static_cast<unsigned>(code->group);
    const bool can_repeat = word.letter == 'G' || code->group == Group::m_coolant;
    if (can_repeat && (groups & group) != 0) are_plain = false;
    groups |= group;
    // G92 beside a motion code
    const auto both = 1U << static_cast<unsigned>(Group::g_motion) |
                      1U << static_cast<unsigned>(Group::g_non_modal);
    if ((groups & both) == both) are_plain = false;
    if (code->group == Group::g_motion) motion = tenths;
    turns_spindle = turns_spindle || (word.letter == 'M' && (tenths == 30 || tenths == 40));
  }
};

bool concerns_call(const Block& block) {
  constexpr double kFiveDigits = 1e4;
  return std::any_of(block.words.begin(), block.words.end(), [](const Word& word) {
    return word.letter == 'P' && word.value.is_constant() && word.value.number >= kFiveDigits;
  });
}

// A word that means something else together with some codes of its block.
bool depends_on_codes(const PlainCodes& codes, std::uint32_t letters) {
  const auto has = [letters](char letter) { return (letters & word_bit(letter)) != 0; };
  const auto has_group = [&codes](Group group) {
    return (codes.groups & 1U << static_cast<unsigned>(group)) != 0;
  };
  const bool takes_no_P = codes.turns_spindle || has_group(Group::g_work_system);
  if (takes_no_P && has('P')) return true;
  if (codes.turns_spindle && has('S')) return true;  // of a laser, S0
  return has_group(Group::g_units) && has('F');
}

// Arcs whose end or centre two controls find differently.
bool is_arc_of_two_readings(const PlainCodes& codes, int motion, std::uint32_t letters) {
  if (motion != 20 && motion != 30) return false;
  const bool has_no_end = codes.motion < 0 && (letters & kAxisWordBits) == 0;
  return has_no_end || (letters & kCentres) == kCentres;
}

}  // namespace

BlockReading::BlockReading(const ReadingOptions& options,
                           std::map<int, AxisWords> additional_offsets)
    : options_(options) {
  memory_.additional_offsets = std::move(additional_offsets);
}

bool BlockReading::concerns(const Block& block, const ModalState& state) const {
  if (block.words.empty() || block.deleted) return false;
  if (block.o_word.flow != Flow::none)
    return block.o_word.flow == Flow::m98 && concerns_call(block);
  const bool reads_all =
      options_.reader != Reader::any || options_.decimal_point != DecimalPoint::unset;
  if (reads_all || memory_.has_any_mode()) return true;
  PlainCodes codes;
  std::uint32_t letters = 0;
  for (const Word& word : block.words) {
    if (word.letter == 'G' || word.letter == 'M') {
      codes.add(word);
    } else {
      letters |= word_bit(word.letter);
      if (word.letter == 'F' && word.value.is_constant() && word.value.number == 0.0) return true;
    }
  }
  const int motion = codes.motion >= 0 ? codes.motion : state.motion;
  if (!codes.are_plain || (letters & kOffsets) != 0 || is_canned_cycle(motion)) return true;
  if (depends_on_codes(codes, letters)) return true;
  if ((letters & kPlaces) == 0) return codes.motion == 800;
  if (is_arc_of_two_readings(codes, motion, letters)) return true;
  if (motion <= 10 && (letters & word_bit('R')) != 0) return true;
  const bool lacks_feed = motion > 0 && state.feed_linear == 0.0;
  return motion == 800 || lacks_feed || (letters & word_bit('S')) != 0;
}

bool BlockReading::read(std::string_view line, const std::string& file, const Block& block,
                        const ModalState& state, const Evaluate& evaluate) {
  before_ = memory_;
  applied_.clear();
  notes_.clear();
  has_unknown_dwell_ = has_unknown_feed_ = positions_below_r_ = false;
  lines_.clear();
  local_call_.reset();
  words_.emplace(line, block, evaluate);
  next_words_.reset();
  if (corner_ && corner_->is_next) {
    next_words_.emplace(corner_->next_line, corner_->next, evaluate);
  }
  ReadingStep step(*this, *words_, state, file, block);
  try {
    step.run();
  } catch (const InputError&) {
    roll_back();
    throw;
  }
  if (!words_->is_changed() && step.before.empty() && step.behind.empty()) return false;
  lines_ = std::move(step.before);
  edited_line_ = lines_.size();
  lines_.push_back(words_->text());
  lines_.insert(lines_.end(), step.behind.begin(), step.behind.end());
  cause_column_ = applied_.empty() ? 0 : applied_.front().column;
  return true;
}

int BlockReading::original_column(std::size_t nth_line, int column) const {
  if (nth_line != edited_line_ || !words_) return cause_column_;
  return words_->original_column(column);
}

// ------------------------------------------------------------------------------------ one block

void ReadingStep::run() {
  if (block_.o_word.flow == Flow::m98) return subprograms();
  if (reading_.calls_again_) drop_words_of_earlier_turn();
  foreign_codes();
  unit_codes();
  decimal_points();
  shift_behind_corner();
  repeated_groups();
  refused_codes();
  circular_pocket();
  machine_functions();
  coolant_codes();
  exact_stop();
  spindle_power();
  idle_codes();
  call_behind_words();
  local_call();
  dwell();
  frame_codes();
  curve_codes();
  inputs();
  presets();
  machine_coordinates();
  homing_cycle();
  length_offset();
  diameter_offset();
  if (has_unknown_code()) return;  // which is then what is wrong with the block
  cycles();
  home();
  home_under_tip_control();
  arc_without_axes();
  motion_in_force();
  radius_of_line();
  arc_centre();
  feed();
  corner();
  laser_power();
  frames();
  feed_beside_unit();
}

// Words that the control of the reader does not have.
void ReadingStep::foreign_codes() {
  if (options.reader == Reader::any) return;
  for (const BlockWord& word : words.all()) {
    if (word.letter != 'G' && word.letter != 'M') continue;
    const int tenths = tenths_of(word.value);
    if (!lacks(options.reader, word.letter, tenths)) continue;
    refuse(word.column, fmt::format("{} is not supported by {}", code_name(word.letter, tenths),
                                    kReaders[static_cast<std::size_t>(options.reader)]));
  }
  const bool is_of_linuxcnc = words.has_code('G', 640) && (words.has('P') || words.has('Q'));
  if (is_of_linuxcnc && options.reader != Reader::mach) {
    refuse(words.code('G', 640)->column,
           fmt::format("G64 with P or Q is not supported by {}",
                       kReaders[static_cast<std::size_t>(options.reader)]));
  }
}

bool ReadingStep::apply(ReaderRule rule, int column, std::string detail) {
  if (!has_rule(options.reader, rule)) return false;
  reading_.applied_.push_back({rule, column, std::move(detail)});
  return true;
}

void ReadingStep::need(ReaderRule rule, int column, std::string detail) {
  if (apply(rule, column, std::move(detail))) return;
  const ReaderRuleEntry& entry = reader_rules()[static_cast<std::size_t>(rule)];
  refuse(column, fmt::format("{}: not supported by reader {} ({}: {})", entry.found,
                             kReaders[static_cast<std::size_t>(options.reader)], entry.controls,
                             entry.reading));
}

int ReadingStep::choose(WordDifference difference, int column) {
  const std::optional<int> chosen = chosen_reading(difference, column);
  if (!chosen) fail(column, both_readings(difference));
  return *chosen;
}

std::optional<int> ReadingStep::chosen_reading(WordDifference difference, int column) {
  const std::optional<int> own = reading_of(difference, options.reader);
  if (own) return own;
  if (options.is_trial) throw Undetermined();
  const PossibleReaders* possible = options.possible_readers ? options.possible_readers() : nullptr;
  const std::optional<DeducedReading> deduced =
      possible != nullptr ? possible->reading_of(difference) : std::nullopt;
  if (!deduced) return std::nullopt;
  const WordDifferenceEntry& entry = word_differences()[static_cast<std::size_t>(difference)];
  const WordReading& reading = entry.readings[static_cast<std::size_t>(deduced->reading)];
  reading_.notes_.push_back({column, fmt::format("{}: read as {} ({}), {}", entry.found,
                                                 reading.text, reading.controls, deduced->why)});
  return deduced->reading;
}

void ReadingStep::fail(int column, std::string message) const {
  if (options.is_trial) throw Undetermined();
  refuse(column, std::move(message));
}

void ReadingStep::refuse(int column, std::string message) const {
  throw InputError({file_, block_.line, column}, std::move(message));
}

// G5 to G5.3 with coordinates, which only LinuxCNC has. What other controls have under these
// numbers has been left out.
void ReadingStep::curve_codes() {
  constexpr int kFirst = 50, kLast = 53;
  for (const BlockWord& word : words.all()) {
    const int tenths = word.letter == 'G' && !word.is_erased ? tenths_of(word.value) : -1;
    if (tenths < kFirst || tenths > kLast || options.reader == Reader::any) continue;
    refuse(word.column,
           fmt::format("{} with coordinates is not supported by {}", code_name('G', tenths),
                       kReaders[static_cast<std::size_t>(options.reader)]));
  }
  const int motion = motion_in_block();
  const bool is_moved = memory.frame.is_active() || memory.polar.is_on;
  if (!is_moved || motion < kFirst || motion > kLast || !words.has_axis()) return;
  fail(words.all().front().column,
       fmt::format("{} is not supported with G16, G51, G51.1, G54.1 or G68, which no control with "
                   "splines has; cancel it first",
                   code_name('G', motion)));
}

int ReadingStep::motion_code() const {
  int out = -1;
  for (const BlockWord& word : words.all()) {
    if (word.letter != 'G' || word.is_erased) continue;
    const int tenths = tenths_of(word.value);
    const Code* code = find_code('G', tenths);
    const bool is_motion = code != nullptr && code->group == Group::g_motion;
    if (is_motion && (out < 0 || tenths != 800)) out = tenths;
  }
  return out;
}

int ReadingStep::motion_in_block() const {
  const int code = motion_code();
  if (code >= 0) return code;
  return memory.pending_motion >= 0 ? memory.pending_motion : state.motion;
}

bool ReadingStep::has_unknown_code() const {
  return std::any_of(words.all().begin(), words.all().end(), [](const BlockWord& word) {
    const bool is_code = (word.letter == 'G' || word.letter == 'M') && !word.is_erased;
    return is_code && find_code(word.letter, tenths_of(word.value)) == nullptr;
  });
}

bool ReadingStep::has_axis_taker() const {
  for (const BlockWord& word : words.all()) {
    if (word.letter != 'G' || word.is_erased) continue;
    const Code* code = find_code('G', tenths_of(word.value));
    if (code != nullptr && code->uses_axes && code->group != Group::g_motion) return true;
  }
  return false;
}

int ReadingStep::normal_axis() const {
  constexpr std::array<std::pair<int, int>, 3> kPlanes = {{{170, 2}, {180, 1}, {190, 0}}};
  for (const auto& [tenths, axis] : kPlanes) {
    if (words.has_code('G', tenths)) return axis;
  }
  return state.normal_axis;
}

bool ReadingStep::is_incremental() const {
  if (words.has_code('G', 900)) return false;
  return words.has_code('G', 910) || state.is_incremental;
}

double ReadingStep::unit() const {
  if (words.has_code('G', 200)) return inch;
  return words.has_code('G', 210) ? mm : state.unit;
}

}  // namespace servomill::controllers
