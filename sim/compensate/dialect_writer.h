/// Writes a corrected program in straight blocks for another control than LinuxCNC.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/compensate/dialect.h"
#include "sim/compensate/program_writer.h"
#include "sim/compensate/walk.h"

namespace servomill::sim {

/// Millimetres, absolute, in the coordinates of the work system itself: rotation, G92, G52, inches,
/// increments and planes are in the numbers. Comments, tools, spindle, coolant, dwell, stops and
/// work systems are said in the words of the dialect; what it has no words for is refused.
class DialectWriter final : public ProgramWriter {
 public:
  DialectWriter(Walk& walk, Summary& summary, Dialect dialect, std::string file);
  ~DialectWriter() override;

  void write(const controllers::ExecutedBlock& block) override;
  std::string finish(const std::vector<std::string>& header) override;

 private:
  using Block = controllers::ExecutedBlock;

  void check_codes(const Block& block) const;
  void say(const Block& block);
  void say_modes(const Block& block, const Step& step);
  void say_other(const Move& move);
  void say_step(const Block& block, const Step& step);
  void note_what_became_numbers(const Block& block);

  Walk& walk_;
  Summary& summary_;
  Dialect dialect_;
  std::string file_, name_;
  std::vector<std::string> lines_;
  std::unique_ptr<DialectPrinter> printer_;
  int work_system_ = 0, tool_offset_ = 0, tool_ = 0, coolant_ = 0;
  double rpm_ = 0.0;
  std::string path_;        // code in force
  bool says_path_ = false;  // the program has said how it is to be followed
  bool must_name_Z_ = false;
};

}  // namespace servomill::sim
