/// Blocks as a control reads them: what LinuxCNC refuses, or would read in another way, becomes a
/// block, or several, that say the same to LinuxCNC. So the interpreter knows one language only,
/// and whoever writes the program again writes it in full.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controllers/gcode/block.h"
#include "controllers/gcode/decimal_point.h"
#include "controllers/gcode/modal_state.h"
#include "controllers/gcode/reader.h"
#include "controllers/gcode/readers/block_words.h"
#include "controllers/gcode/readers/differences.h"
#include "controllers/gcode/readers/plane_frame.h"

namespace servomill::controllers {

class PossibleReaders;

/// The user's choices about the control.
struct ReadingOptions {
  Reader reader = Reader::any;
  DecimalPoint decimal_point = DecimalPoint::unset;
  std::optional<double> feed;  // m/s, of moves before any F
  bool accepts_unknown_dwells = false;
  bool accepts_unknown_positions = false;
  bool accepts_unknown_feeds = false;
  std::set<int> ignored_codes = {};  // as of ProgramSetup
  std::function<void(int)> refuses_code = {};
  bool is_trial = false;  // as of ProgramSetup
  /// The controls that would read the whole program; nullptr if nobody can tell.
  std::function<const PossibleReaders*()> possible_readers = {};
  std::function<double(int D)> radius_of = {};  // m, of a tool; 0: unknown
};

/// Reported once in a program.
struct ReadingNote {
  int column = 0;
  std::string text;
};

/// Words of canned cycles that a control keeps until G80, in program units.
struct KeptCycle {
  std::array<std::optional<double>, 4> values;  // of R, the normal axis, P (s) and Q
  bool is_incremental = false;                  // the mode that they were given in
  double r_level = 0.0, bottom_level = 0.0;     // of R and the normal axis, program coordinates
};

/// Modes of a control that LinuxCNC does not have.
struct ReadingMemory {
  int pending_motion = -1;        // tenths of a motion code that LinuxCNC's state lacks; -1: none
  bool is_pending_known = false;  // why was said
  bool has_zero_feed = false;     // F0 is in force
  int motion_before_cycle = -1;   // G0 ... G3, group 01, while a cycle is in force
  bool is_in_cycle = false;
  KeptCycle cycle;
  bool has_retract_mode = false;                         // G98 or G99 was read
  std::optional<double> diameter_offset, length_offset;  // D, H before the block that uses them
  PlaneFrame frame;
  Eigen::Vector3d before_rotation = Eigen::Vector3d::Zero();  // program coordinates; m
  PolarMode polar;
  std::map<int, AxisWords> additional_offsets;  // of G54.1, by P
  // From where a corner ended to the end of its line, program units: the next block under G91
  // counts from there
  Eigen::Vector3d behind_corner = Eigen::Vector3d::Zero();
  int power_changes = 0;                       // feeds that change S without an M code
  bool is_idle_beam = false;                   // M3 or M4 with S0, no other since
  int lone_G53_line = 0, lone_G53_column = 0;  // without axis words, no work offset since; 0: none
  int first_left_out = -1;                     // tenths of the first M code that was left out
  bool has_any_mode() const {
    return pending_motion >= 0 || is_in_cycle || frame.is_active() || polar.is_on ||
           lone_G53_line > 0 || is_idle_beam || !behind_corner.isZero(0.0);
  }
};

/// M97 P L of the block.
struct LocalCall {
  int block_number = 0;
  int repeats = 1;
  int column = 0;
};

/// The corner from a block to the next one.
struct CornerToNext {
  BlockWord size;  // letter R or C
  std::string next_line;
  Block next;           // parsed from it, with its pieces
  bool is_next = true;  // false: no block follows, or its words are no plain numbers
};

class BlockReading {
 public:
  using Evaluate = BlockWords::Evaluate;

  BlockReading(const ReadingOptions& options, std::map<int, AxisWords> additional_offsets);

  /// Returns false for the many blocks that no rule of a control concerns.
  bool concerns(const Block& block, const ModalState& state) const;

  /// Reads a block. `lines`, `applied` and `local_call` are about this block.
  /// @param line  that the block, with its pieces, was parsed from
  /// @return true if `lines` take its place
  /// @throws InputError for what two controls read differently, and for what none can be simulated
  bool read(std::string_view line, const std::string& file, const Block& block,
            const ModalState& state, const Evaluate& evaluate);

  const std::vector<std::string>& lines() const { return lines_; }
  const std::vector<AppliedRule>& applied() const { return applied_; }
  const std::vector<ReadingNote>& notes() const { return notes_; }
  /// P of the block, of a dwell or a canned cycle, is in an unknown unit.
  bool has_unknown_dwell() const { return has_unknown_dwell_; }
  /// F of the block only holds the place of a feed that no block gives.
  bool has_unknown_feed() const { return has_unknown_feed_; }
  /// The cycle of the block goes to its hole below R, and then rises.
  bool positions_below_r() const { return positions_below_r_; }
  const std::optional<LocalCall>& local_call() const { return local_call_; }
  const PlaneFrame& frame() const { return memory_.frame; }
  /// Column in the line as written.
  int original_column(std::size_t nth_line, int column) const;
  /// The corner of the block that is read next, or none.
  void round_corner(std::optional<CornerToNext> corner) { corner_ = std::move(corner); }
  /// The block that is read next calls again (L of M98 and M97): its other words have acted.
  void call_again(bool is_again) { calls_again_ = is_again; }
  /// Forgets what the block read last has changed, because it failed.
  void roll_back() { memory_ = before_; }

 private:
  friend class ReadingStep;

  ReadingOptions options_;
  ReadingMemory memory_, before_;
  std::vector<std::string> lines_;
  std::size_t edited_line_ = 0;  // of `lines_`; the others are all the work of a rule
  int cause_column_ = 0;         // of those
  bool calls_again_ = false;
  std::optional<BlockWords> words_;
  std::vector<AppliedRule> applied_;
  std::vector<ReadingNote> notes_;
  bool has_unknown_dwell_ = false, has_unknown_feed_ = false;
  bool positions_below_r_ = false;
  std::optional<LocalCall> local_call_;
  std::optional<CornerToNext> corner_;
  std::optional<BlockWords> next_words_;  // of the block behind the corner
};

}  // namespace servomill::controllers
