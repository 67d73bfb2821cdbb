// Words that no function of their block reads, and words that are passed over.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/siemens/codes.h"
#include "controllers/siemens/translator.h"

namespace servomill::controllers::siemens {
namespace {

struct Word {
  const std::optional<Number>* number;
  std::string_view name;
  bool is_read;
  std::string_view where;  // it is read
};

bool is_call_of_program(const Call& call) { return !has_text_only(call.name); }

}  // namespace

// A word that would be read nowhere means something else than the programmer intended.
void Translator::refuse_unread(const Block& block) {
  const Code* action = codes_[static_cast<std::size_t>(Group::action)];
  const bool is_chuck = action != nullptr && action->name == "G63";
  const bool is_pole = action != nullptr && action->name.starts_with("G11");
  const bool is_rotation = action != nullptr && action->name.ends_with("ROT");
  const bool is_path = (action == nullptr || is_chuck) && moves(block);
  const bool is_work = is_path && codes_[static_cast<std::size_t>(Group::suppression)] == nullptr;
  const MotionCode code = is_chuck ? MotionCode::line : modes_.motion;
  const bool is_thread = is_work && code == MotionCode::thread;
  const bool is_through = is_work && code == MotionCode::through_point;
  const bool is_arc =
      is_work && (code == MotionCode::clockwise || code == MotionCode::counterclockwise);
  const bool is_polar = is_pole || (is_work && !is_thread && !is_through);
  const bool is_element = is_work && !is_thread && !is_chuck;
  const bool has_corner = block.RND || block.CHR || block.CHF;
  const Word words[] = {
      {&block.AP, "AP", is_polar, "G0 to G3, CT or G110 to G112"},
      {&block.RP, "RP", is_polar, "G0 to G3, CT or G110 to G112"},
      {&block.RPL, "RPL", is_rotation, "ROT or AROT"},
      {&block.centre[0], "I", is_arc || is_thread, "G2, G3 or thread cutting"},
      {&block.centre[1], "J", is_arc || is_thread, "G2, G3 or thread cutting"},
      {&block.centre[2], "K", is_arc || is_thread, "G2, G3 or thread cutting"},
      {&block.through[0], "I1", is_through, "CIP"},
      {&block.through[1], "J1", is_through, "CIP"},
      {&block.through[2], "K1", is_through, "CIP"},
      {&block.CR, "CR", is_arc, "G2 or G3"},
      {&block.AR, "AR", is_arc, "G2 or G3"},
      {&block.TURN, "TURN", is_arc, "G2 or G3"},
      {&block.RND, "RND", is_element, "a move in the plane with G1 to G3, CIP or CT"},
      {&block.CHR, "CHR", is_element, "a move in the plane with G1 to G3, CIP or CT"},
      {&block.CHF, "CHF", is_element, "a move in the plane with G1 to G3, CIP or CT"},
      {&block.FRC, "FRC", has_corner, "RND, CHR or CHF"},
  };
  for (const Word& one : words) {
    if (!*one.number || one.is_read) continue;
    fail((*one.number)->place,
         fmt::format("{} has no effect in this block; it requires {}", one.name, one.where));
  }
  const int corners =
      int{block.RND.has_value()} + int{block.CHR.has_value()} + int{block.CHF.has_value()};
  if (corners > 1) fail("RND, CHR and CHF are mutually exclusive; program one of them");
  refuse_unread_call(block, is_path);
}

void Translator::refuse_unread_call(const Block& block, bool is_path) {
  const auto call = std::find_if(block.calls.begin(), block.calls.end(), is_call_of_program);
  const bool has_call = call != block.calls.end() || block.L;
  if (block.P && (!has_call || block.is_modal_call)) {
    fail(
        block.P->place,
        "P, the number of repetitions, requires a subprogram call in the same block, as in L10 P3");
  }
  if (block.is_modal_call && is_path) {
    fail("MCALL must be in a block without axis words");
  }
  if (!has_call || !is_path) return;
  const bool is_known = block.L || is_cycle(call->name) || find_program(call->name) != nullptr;
  if (!is_known) return;  // as a call that is refused by its name
  fail(block.L ? block.L->place : call->place,
       "a cycle or subprogram call must be in a block without axis words");
}

// Functions that are not supported unless they are switched off.
void Translator::refuse_switched_on(const Block& block) const {
  for (const auto& one : block.direction) {
    if (!one) continue;
    fail(one->place,
         "A3=, B3=, C3=: tool directions are not supported; post-process to rotary axes");
  }
  if (block.RNDM && block.RNDM->value != 0.0) {
    fail(block.RNDM->place, "RNDM: modal rounding is not supported; program RND in each block");
  }
  if (block.FRCM && block.FRCM->value != 0.0) {
    fail(block.FRCM->place, "FRCM is not supported; program FRC in each block");
  }
  if (block.DISC && block.DISC->value != 0.0) {
    fail(block.DISC->place, "DISC: overshoot at outside corners is not supported; use DISC=0");
  }
  for (const Code& code : block.codes) {
    if (code.arguments.empty() || takes_names(code.name)) continue;
    const bool is_first = code.name == "SETMS" || code.name == "TRAORI";
    if (is_first && code.arguments == "1") continue;
    fail(code.place, fmt::format("{0}({1}): {2}", code.name, code.arguments,
                                 code.name == "SETMS"    ? "a second spindle is not supported"
                                 : code.name == "TRAORI" ? "only the first transformation is "
                                                           "supported, without parameters"
                                                         : "parameters are not allowed"));
  }
}

void Translator::warn_of_settings(const Block& block) {
  for (const Code& one : block.settings) {
    warn_once(one.name, fmt::format("{}: {}", one.name, warning_of(one.name)));
  }
  if (block.has("ORIWKS")) {
    warn_once("ORIWKS",
              "ORIWKS: treated as ORIAXES, linear interpolation of the rotary axes; the tool "
              "leaves the plane of its start and end orientation");
  }
}

// Between RND and the next element: F and M functions of the corner are those of the block before
// or after it. Fundamentals 07/2010 (6FC5398-1BP40-0BA0) p. 282
void Translator::warn_of_corner() {
  warn_once("corner",
            "F or an M function in the block of RND, CHF or CHR: treated as effective after the "
            "corner, as with MD20201 bit 0 = 1; FRC sets the feed rate of the corner");
}

// [F] "Chamfer, rounding": the control inserts nothing then.
void Translator::count_block_behind_corner() {
  constexpr int kLargest = 3;
  if (!path_.has_corner() || ++blocks_behind_corner_ <= kLargest) return;
  fail(
      "RND, CHF and CHR allow at most three following blocks without motion in the plane: the "
      "control inserts nothing otherwise; program the next element earlier");
}

}  // namespace servomill::controllers::siemens
