#include "controllers/gcode/request.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "controllers/gcode/canned_cycles.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::controllers {
namespace {

constexpr double kCodeTol = 1e-4;  // how far the number of a code may be from a code
constexpr int kMaxMCodes = 4;      // as LinuxCNC
constexpr std::string_view kClaimedLetters = "DHIJKLPQR";

constexpr std::uint32_t mask_of(std::string_view letters) {
  std::uint32_t mask = 0;
  for (const char letter : letters) mask |= word_bit(letter);
  return mask;
}
constexpr std::uint32_t kClaimedMask = mask_of(kClaimedLetters);

struct Context {
  const std::string& file;
  int line;

  [[noreturn]] void fail(int column, std::string message) const {
    throw InputError({file, line, column}, std::move(message));
  }
};

std::string name_of(char letter, const Code& code) { return code_name(letter, code.tenths); }

const Code& look_up(const Context& context, char letter, double value, int column) {
  const double tenths = std::floor(10.0 * value + 0.5);
  const bool exact = std::abs(10.0 * value - tenths) <= 10.0 * kCodeTol;
  const bool is_near = exact && tenths >= 0.0 && tenths < 1e4;
  const Code* code = is_near ? find_code(letter, static_cast<int>(tenths)) : nullptr;
  if (code == nullptr)
    context.fail(column, fmt::format("unknown {} code {}{}", letter, letter, value));
  if (!code->supported) {
    context.fail(column,
                 fmt::format("{}: {}", name_of(letter, *code), refusal(letter, code->tenths)));
  }
  return *code;
}

void choose(const Context& context, Request& request, char letter, const Code& code, int column) {
  const Request::Chosen& chosen = request.of(code.group);
  // G80 cancels nothing that its own block programs: G0 G17 G40 G80 is how many programs begin
  if (code.group == Group::g_motion && chosen.code != nullptr) {
    if (code.tenths == kNoMotion) return;
    if (chosen.code->tenths == kNoMotion) return request.set(code.group, {&code, column});
  }
  if (chosen.code != nullptr) {
    context.fail(column, fmt::format("{} and {} in one block (same modal group)",
                                     name_of(letter, *chosen.code), name_of(letter, code)));
  }
  request.set(code.group, {&code, column});
}

constexpr std::string_view kVectorLetters = "IJK";

// Column of the first axis word, or 0. The words of a tool axis are such words, too.
int first_axis_word(const Request& request, bool has_vectors) {
  int first = 0;
  const auto look = [&](char letter) {
    const int column = request.word(letter).column;
    if (column > 0 && (first == 0 || column < first)) first = column;
  };
  for (const Axis axis : kAllAxes) look(letter(axis));
  for (const char polar : {'@', '^'}) look(polar);
  if (has_vectors) {
    for (const char letter : kVectorLetters) look(letter);
  }
  return first;
}

// Does the block leave, or put, G43.5 in force?
bool has_vectors_after(const Request& request, bool before) {
  const int tool_length = request.code(Group::g_tool_length);
  return tool_length < 0 ? before : tool_length == kVectorControl;
}

// The code other than a motion that takes the axis words: G10, G28, G92, G43.1 ...
Request::Chosen axis_taker(const Request& request) {
  for (const Group group : {Group::g_non_modal, Group::g_tool_length, Group::g_work_plane}) {
    const Request::Chosen& chosen = request.of(group);
    if (chosen.code != nullptr && chosen.code->uses_axes) return chosen;
  }
  return {};
}

Request::Chosen choose_motion(const Context& context, const Request& request, int modal_motion,
                              bool has_vectors) {
  const Request::Chosen programmed = request.of(Group::g_motion);
  const Request::Chosen taker = axis_taker(request);
  const bool cancel = programmed.code != nullptr && programmed.code->tenths == kNoMotion;
  // words beside G43.1 and a motion are offsets and coordinates at once, as in LinuxCNC
  const bool shares = taker.code != nullptr && taker.code->group == Group::g_tool_length;
  if (taker.code != nullptr && !(shares && programmed.code != nullptr && !cancel)) {
    if (programmed.code != nullptr && !cancel) {
      context.fail(programmed.column,
                   fmt::format("{} and {} are not allowed in one block: both use the axis words",
                               name_of('G', *taker.code), name_of('G', *programmed.code)));
    }
    return {};
  }
  const int axis_column = first_axis_word(request, has_vectors);
  if (cancel && axis_column > 0) context.fail(axis_column, "axis words are not allowed with G80");
  if (cancel) return {};
  if (programmed.code != nullptr && axis_column == 0 && is_canned_cycle(programmed.code->tenths)) {
    context.fail(programmed.column,
                 fmt::format("{} requires an axis word", name_of('G', *programmed.code)));
  }
  if (programmed.code != nullptr || axis_column == 0) return programmed;
  if (modal_motion == kNoMotion) {
    context.fail(axis_column, "axis words, but no active G code uses them");
  }
  return {find_code('G', modal_motion), axis_column};
}

bool claims(const Request::Chosen& chosen, char letter) {
  return chosen.code != nullptr && chosen.code->uses.find(letter) != std::string_view::npos;
}

std::string users_of(char letter) {
  std::string names;
  for (const Code& code : g_codes()) {
    if (!code.supported || code.uses.find(letter) == std::string_view::npos) continue;
    names += fmt::format("{}{}", names.empty() ? "" : ", ", name_of('G', code));
  }
  for (const Code& code : m_codes()) {
    if (!code.supported || code.uses.find(letter) == std::string_view::npos) continue;
    names += fmt::format("{}{}", names.empty() ? "" : ", ", name_of('M', code));
  }
  return names;
}

bool is_straight(const Request& request) {
  return request.motion_code() == 0 || request.motion_code() == 10;
}

void check_claims(const Context& context, const Request& request, bool has_vectors) {
  if ((request.letters & kClaimedMask) == 0) return;
  for (const char letter : kClaimedLetters) {
    if (!request.has(letter)) continue;
    bool claimed = claims(request.motion, letter);
    claimed = claimed || (has_vectors && is_straight(request) &&
                          kVectorLetters.find(letter) != std::string_view::npos);
    for (const Request::Chosen& chosen : request.codes) claimed = claimed || claims(chosen, letter);
    if (claimed) continue;
    constexpr double kPerSubroutine = 100.0;  // L100 is the first, L101 calls it once
    const double value = request[letter];
    if (letter == 'L' && value >= kPerSubroutine && std::fmod(value, kPerSubroutine) == 0.0) {
      context.fail(request.word(letter).column,
                   fmt::format("L{} starts a Fadal subroutine (format 1), which is not supported; "
                               "output the program in format 2",
                               value));
    }
    const std::string users = users_of(letter);
    context.fail(request.word(letter).column,
                 users.empty()
                     ? fmt::format("no supported code uses the {} word", letter)
                     : fmt::format("{} word without a code that uses it ({})", letter, users));
  }
}

void add_code(const Context& context, Request& request, const Word& word, double value,
              int& m_codes_seen) {
  if (word.letter == 'M' && ++m_codes_seen > kMaxMCodes) {
    context.fail(word.column, fmt::format("more than {} M codes in one block", kMaxMCodes));
  }
  const Code& code = look_up(context, word.letter, value, word.column);
  choose(context, request, word.letter, code, word.column);
}

}  // namespace

void resolve(Block& block, const Parameters& parameters, int modal_motion, bool has_vectors,
             const std::string& file, Request& request) {
  const Context context{file, block.line};
  request.clear();
  request.line = block.line;
  int m_codes_seen = 0;
  for (Word& word : block.words) {
    const double value = evaluate(word.value, block, parameters, file);
    if (word.letter == 'G' || word.letter == 'M') {
      add_code(context, request, word, value, m_codes_seen);
    } else {
      request.set(word.letter, value, word.column);
    }
  }
  has_vectors = has_vectors_after(request, has_vectors);
  request.motion = choose_motion(context, request, modal_motion, has_vectors);
  check_claims(context, request, has_vectors);
}

void check_codes(const Block& block, const std::string& file) {
  const Context context{file, block.line};
  Request request;
  int m_codes_seen = 0;
  for (const Word& word : block.words) {
    const bool is_code = word.letter == 'G' || word.letter == 'M';
    if (is_code && word.value.is_constant()) {
      add_code(context, request, word, word.value.number, m_codes_seen);
    }
  }
}

}  // namespace servomill::controllers
