// Blocks with '/', about which the operator's switch decides: what follows is written for both of
// its positions, and verified for both.
#include <fmt/format.h>

#include <algorithm>

#include "controllers/gcode/modal_state.h"
#include "controllers/gcode/request.h"
#include "plant/vocabulary/input_error.h"
#include "sim/programs/compensate/dialect_writer.h"
#include "sim/programs/compensate/edited_line.h"
#include "sim/programs/compensate/line_tokens.h"

namespace servomill::sim::programs {
namespace {

using controllers::Group;

constexpr auto kZ = static_cast<std::size_t>(2);
constexpr std::string_view kUnwrittenSlash =
    "blocks with '/' are undocumented for this control; remove the slash, or omit these blocks "
    "with --block-delete";

// Whole parts of a program depend on these.
bool decides_about_the_rest(const controllers::ExecutedBlock& block) {
  if (block.call_depth > 0 || block.is_repeated || block.request == nullptr) return true;
  if (block.block->o_word.flow != controllers::Flow::none) return true;
  if (!block.block->assignments.empty() || block.request->has('T')) return true;
  return std::any_of(block.moves.begin(), block.moves.end(), [](const Move& move) {
    return move.kind == MoveKind::tool || move.kind == MoveKind::end ||
           (move.kind == MoveKind::stop && move.number > 1);
  });
}

bool acts(const controllers::ExecutedBlock& block) {
  return std::any_of(block.moves.begin(), block.moves.end(), [](const Move& move) {
    return is_motion(move.kind) || move.kind == MoveKind::dwell;
  });
}

}  // namespace

void DialectWriter::refuse_slash(const Block& block) const {
  if (printer_->has_optional_blocks() && !decides_about_the_rest(block)) return;
  const int column = static_cast<int>(block.text.find('/')) + 1;
  throw InputError({file_, block.line, column},
                   std::string(printer_->has_optional_blocks() ? kSlash : kUnwrittenSlash));
}

void DialectWriter::write_optional(const Block& block) {
  if (block.request == nullptr && block.moves.empty()) return write_always(block);  // a comment
  refuse_slash(block);
  if (acts(block)) restate_spindle_and_coolant();
  printer_->end_smoothing();
  const AxisFlags known = out_known_, moved_before = is_optional_;
  const std::optional<double> height = has_optional_height_ ? skipped_height_ : height_;
  const int coolant = skipped_coolant_;
  const std::string path = path_;
  is_optional_ = {};
  has_optional_height_ = false;
  printer_->begin_optional();
  writes_optional_ = true;
  write_always(block);
  writes_optional_ = false;
  printer_->end_smoothing();
  printer_->end_optional();

  // either the state before or that behind
  for (std::size_t i = 0; i < known.size(); ++i) {
    is_optional_[i] = is_optional_[i] || moved_before[i];
    out_known_[i] = out_known_[i] && known[i];
  }
  skipped_coolant_ = coolant;
  has_optional_height_ = is_optional_[kZ];
  skipped_height_ = height;
  if (path_ != path) path_.clear();
}

void DialectWriter::restate_coolant() {
  if ((skipped_coolant_ & ~coolant_) != 0) {
    throw Unsayable{"needs the coolant that a block with '/' has switched off; remove the slash"};
  }
  for (const auto& [bit, code] :
       {std::pair(controllers::kMist, 7), std::pair(controllers::kFlood, 8)}) {
    if ((coolant_ & bit) == 0) continue;
    const bool is_optional = (skipped_coolant_ & bit) == 0;
    if (is_optional) printer_->begin_optional();
    printer_->coolant(code);
    if (is_optional) printer_->end_optional();
  }
}

// Two heights are possible behind blocks with '/' that move Z: it must be up from both, or from
// neither.
bool DialectWriter::rises(double height) const {
  const bool is_up = height_ && height > *height_;
  if (!has_optional_height_) return is_up;
  const bool is_up_if_skipped = skipped_height_ && height > *skipped_height_;
  if (is_up == is_up_if_skipped) return is_up;
  throw Unsayable{
      "moves Z and other axes by rapid, up or down depending on blocks with '/'; program Z in a "
      "separate rapid before"};
}

}  // namespace servomill::sim::programs
