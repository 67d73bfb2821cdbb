/// Writes a corrected program for another control than LinuxCNC.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/programs/compensate/dialect.h"
#include "sim/programs/compensate/program_corrector.h"
#include "sim/programs/compensate/program_writer.h"

namespace servomill::sim::programs {

/// Absolute positions in the coordinates of the work system itself: rotation, G92, G52, increments
/// and planes are in the numbers. Comments, tools, spindle, coolant, dwell, stops and work systems
/// become words of the dialect; what it has no words for is refused.
/// - The header brings the control into one state whatever was in force, and retracts; the end
///   stops the coolant, retracts and stops the spindle.
/// - A position that nothing has named is unknown: a move to it is written wherever it ends. After
///   a tool change everything is unknown, after M0, M1 and M60 the positions are.
/// - Before Z moves behind a tool change, and before it goes down behind a stop, rapids bring the
///   other axes back to where the program has them.
/// - A rapid in Z and other axes becomes two: Z first where it goes up, last where it goes down or
///   comes from an unknown height. After a stop the height is that before it, in case that nobody
///   has jogged. Axes may run at their own rates (Fanuc LRP, No. 1401#1, = 0;
///   B-63844EN/02 p. 48).
class DialectWriter final : public ProgramWriter {
 public:
  DialectWriter(ProgramCorrector& corrector, Summary& summary, const DialectSettings& settings,
                std::string file);
  ~DialectWriter() override;

  void write(const controllers::ExecutedBlock& block) override;
  std::string finish(const std::vector<std::string>& header) override;
  std::vector<std::string> assumptions() const override { return printer_->assumptions(); }
  std::vector<std::string> warnings() const override;
  std::string rounding() const override;

 private:
  using Block = controllers::ExecutedBlock;
  using Words = std::vector<std::pair<Axis, double>>;

  void check_codes(const Block& block);
  void refuse_slash(const Block& block) const;
  void write_always(const Block& block);
  void write_optional(const Block& block);
  void note_what_became_numbers(const Block& block);
  void note_unit(const Block& block);

  // of one block
  void write_moves(const Block& block);
  void write_other(const Move& move, const Block& block, std::size_t i);
  void write_stop(int number);
  void write_end();
  void change_tool(int number, const Block& block);
  void forget_positions();
  void lose_axes();
  void find_axis(std::size_t axis);
  void restate_spindle_and_coolant();
  void restate_coolant();
  bool rises(double height) const;

  // motion
  void write_reference(const Move& move, const Block& block, bool is_last);
  void restate_axes(const Move& move, const Block& block);
  std::vector<Axis> lost_axes(const Move& move, const Block& block) const;
  std::vector<Axis> unnamed_lost(const AxisFlags& is_lost, const Block& block) const;
  void refuse_doubtful_axes(double height, const Block& block) const;
  bool is_restated_with(Axis one, Axis other) const;
  void write_restated(const std::vector<Axis>& axes);
  void write_rapid_back(const std::vector<Axis>& axes);
  void write_step(const Block& block, const Step& step);
  void write_path_mode(const Block& block, const Move& move);
  DialectMotion motion_of(const Block& block, const Step& step) const;
  void set_feed(DialectMotion& motion, const Step& step, const FittedBlock& fitted) const;
  void write_rapid(DialectMotion motion, double height);
  void name_end(DialectMotion& motion, const AxisWords& target) const;
  void check_place(const Step& step, const AxisWords& on_grid) const;
  Words words_of(const Step& step, const AxisWords& target, const AxisWords& at) const;
  AxisWords on_grid(const AxisWords& target) const;
  std::optional<DialectArc> arc_of(const Step& step, const FittedBlock& fitted,
                                   const AxisWords& origin, const AxisWords& from,
                                   const AxisWords& to) const;
  bool takes_arcs(const DialectMotion& motion, const Step& step, const AxisWords& origin) const;

  ProgramCorrector& corrector_;
  Summary& summary_;
  DialectSettings settings_;
  std::string file_;
  std::vector<std::string> lines_;
  std::unique_ptr<DialectPrinter> printer_;
  std::optional<double> height_;  // m: machine coordinate of Z, where known if nobody jogs
  AxisFlags out_known_{};         // axes that a block has named since positions were lost
  AxisFlags is_lost_{};  // axes that a tool change or a stop may have moved, not named since
  /// In which coordinates an axis has been written last. 0: those of the machine
  std::array<int, kAxisWords> system_{};
  /// Axes that blocks with '/' have moved: where they are is the operator's word. Named, they are
  /// written.
  AxisFlags is_optional_{};
  AxisFlags skipped_lost_{};              // is_lost_ without the blocks with '/'
  std::optional<double> skipped_height_;  // m: height_ without the blocks with '/'
  bool writes_optional_ = false;          // a block with '/'
  bool has_optional_height_ = false;      // those have moved Z
  int skipped_coolant_ = 0;               // coolant_ without the blocks with '/'
  int tool_ = 0, coolant_ = 0, direction_ = 0;
  std::optional<int> known_coolant_ = 0;
  double rpm_ = 0.0;
  std::optional<bool> is_inch_;  // as the first motion finds it
  bool says_path_ = false;       // the program has named how it is to be followed
  std::string path_;             // code in force
  bool has_ended_ = false;
  std::size_t arcs_to_lines_ = 0;  // outside the XY plane
  bool has_overrides_ = false, moves_work_systems_ = false, has_pallets_ = false;
};

}  // namespace servomill::sim::programs
