#include "sim/programs/verification/verification.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/gcode/parameters.h"
#include "controllers/translation/translated_program.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "plant/vocabulary/units.h"
#include "sim/programs/line_stage.h"
#include "sim/programs/verification/linuxcnc_replay.h"
#include "sim/programs/verification/readings.h"

namespace servomill::sim::programs {
namespace {

using controllers::MachineAction;

constexpr std::string_view kRemedy =
    "remove the slash where they must run, or omit these blocks with --block-delete";

std::string line_of(std::string_view text, int number) {
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    if (line == number) {
      const std::string_view one = text.substr(0, end);
      return std::string(one.substr(0, one.find_last_not_of("\r\t ") + 1));
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return {};
}

/// One written program, verified under one setting after the other.
class Verifier {
 public:
  Verifier(const std::string& written, const VerificationRequest& request, Correction& correction)
      : written_(written), request_(request), correction_(correction) {
    options_.is_start_known = request.is_start_known;
    options_.layout = request.layout;
    options_.forgets_positions = request.dialect != Dialect::linuxcnc;
  }

  VerificationReport run() {
    decides_ = has_slash(written_) || (!request_.setup.block_delete && original_has_slash());
    if (!decides_) {
      run_with_switch(request_.setup.block_delete);
      return report_;
    }
    for (const bool skips : {false, true}) run_with_switch(skips);
    return report_;
  }

 private:
  // Tells if the operator's switch may skip a block.
  static bool has_slash(std::string_view text) {
    return text.starts_with('/') || text.find("\n/") != std::string_view::npos;
  }

  bool original_has_slash() const {
    Original original(text(), request_.setup, options_);
    while (original.next() != nullptr) throw_if_interrupted();
    return original.has_optional_blocks();
  }

  // A program that cannot run with the switch in one position is not written for it.
  void require_original(const controllers::ProgramSetup& setup) const {
    try {
      Original original(text(), setup, options_);
      while (original.next() != nullptr) throw_if_interrupted();
    } catch (const InputError& error) {
      Fault fault = error.faults().front();
      fault.message += remedy(setup.block_delete);
      throw InputError({std::move(fault)});
    }
  }

  // Remedy for programs that the operator's switch changes.
  std::string remedy(bool skips_blocks) const {
    if (!decides_) return {};
    return fmt::format("; that is with the blocks with '/' {}: {}",
                       skips_blocks ? "left out" : "run", kRemedy);
  }

  void run_with_switch(bool skips_blocks) {
    controllers::ProgramSetup setup = request_.setup;
    setup.block_delete = skips_blocks;
    skips_ = skips_blocks;
    if (decides_) require_original(setup);
    if (request_.dialect == Dialect::linuxcnc) return run_linuxcnc(setup);
    controllers::ControlSetup control = request_.control;
    control.skips_blocks = skips_blocks;
    ReadingOptions options;
    options.resolution = request_.limits.grid;
    options.has_rotary_axes = request_.layout.has(3) || request_.layout.has(4);
    options.is_endless = request_.is_endless;
    options.without = request_.without;
    const auto readings = readings_of(written_, request_.dialect, control, options);
    std::vector<std::vector<MachineAction>> done;
    Stage stage("settings of the control", static_cast<double>(readings.size()), Steps::unlike);
    for (const Reading& reading : readings) {
      settings_ = reading.settings;
      std::vector<MachineAction> actions = read(reading);
      if (std::find(done.begin(), done.end(), actions) == done.end()) {
        compare(actions, setup);
        done.push_back(std::move(actions));
      }
      stage.advance();
      ++report_.settings;
    }
  }

  // Positions count from the start, so that two starts show what depends on it.
  void run_linuxcnc(controllers::ProgramSetup setup) {
    // what is written needs no tolerance, but for tools that the user's table holds
    controllers::ProgramSetup strict = controllers::translation::gcode_setup(text(), setup);
    if (!setup.tools.empty()) strict.reader = controllers::Reader::linuxcnc;
    const AxisWords given = setup.start;
    AxisWords other = given;
    other += (AxisWords() << 7.3 * mm, -4.1 * mm, 11.9 * mm, 0.3 * deg, -0.7 * deg, 1.1 * deg)
                 .finished();
    Stage stage("starts", 2.0);
    for (const bool is_other : {false, true}) {
      for (int i = 0; i < kAxisWords; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const bool is_free = request_.layout.joint_of(kAllAxes[k]) && !request_.is_start_known[k];
        setup.start[i] = strict.start[i] = is_other && is_free ? other[i] : given[i];
      }
      settings_ = is_other ? "another start" : "the start at zero";
      const auto actions =
          read({"", [&] { return replay_linuxcnc(written_, "written", strict, options_); }});
      compare(actions, setup);
      ++report_.settings;
      stage.advance();
    }
  }

  std::vector<MachineAction> read(const Reading& reading) const {
    try {
      return reading.read();
    } catch (const InputError& error) {
      const Fault& fault = error.faults().front();
      throw InputError(
          {request_.original_file},
          fmt::format(
              "the program written for {} cannot be verified ({}): its line {}, \"{}\": {}{}",
              dialect(), settings_, fault.place.line, line_of(written_, fault.place.line),
              fault.message, remedy(skips_)));
    }
  }

  void compare(const std::vector<MachineAction>& actions, const controllers::ProgramSetup& setup) {
    Original original(text(), setup, options_);
    ComparisonLimits limits = request_.limits;
    limits.grid = written_grid(written_, request_.dialect, limits.grid);
    ReplayComparison comparison(actions, limits, correction_);
    controllers::KnownPosition start;
    for (std::size_t i = 0; i < start.size(); ++i) {
      if (request_.is_start_known[i]) start[i] = setup.start[static_cast<int>(i)];
    }
    comparison.start_at(start);
    const OriginalAction* action = nullptr;
    LineStage lines(request_.original_file);
    try {
      while ((action = original.next()) != nullptr) {
        throw_if_interrupted();
        lines.at(action->move.line);
        comparison.match(*action);
      }
      comparison.finish();
    } catch (const ReplayDifference& difference) {
      const int line = action == nullptr ? original.line() : action->move.line;
      refuse(difference, line, original);
    }
    report_.blocks = std::max(report_.blocks, comparison.blocks());
    report_.largest = std::max(report_.largest, comparison.largest());
  }

  [[noreturn]] void refuse(const ReplayDifference& difference, int line,
                           const Original& original) const {
    const std::string here = line == original.line() ? original.line_text() : original_line(line);
    const std::string there = difference.written_line == 0
                                  ? "its end"
                                  : fmt::format("its line {}, \"{}\"", difference.written_line,
                                                line_of(written_, difference.written_line));
    throw InputError(
        {request_.original_file, line},
        fmt::format("the program written for {} differs in effect from \"{}\": "
                    "{} ({}; {}){}",
                    dialect(), here, difference.why, there, settings_, remedy(skips_)));
  }

  std::string original_line(int number) const {
    controllers::ProgramText program = text();
    std::string_view line;
    while (program.next(line)) {
      if (program.number() == number) return std::string(line);
    }
    return {};
  }

  controllers::ProgramText text() const {
    return request_.original_text
               ? controllers::ProgramText::of_text(*request_.original_text, request_.original_file)
               : controllers::ProgramText::of_file(request_.original_file);
  }

  std::string_view dialect() const { return kDialects[static_cast<std::size_t>(request_.dialect)]; }

  const std::string& written_;
  const VerificationRequest& request_;
  Correction& correction_;
  OriginalOptions options_;
  VerificationReport report_;
  std::string settings_;
  bool decides_ = false, skips_ = false;  // the switch for '/': it matters; its position
};

}  // namespace

std::string VerificationReport::text() const {
  return fmt::format("verified: {} blocks, largest difference {:.2f} um, for {} control settings",
                     blocks, largest / um, settings);
}

controllers::ControlSetup control_setup(const controllers::ProgramSetup& setup,
                                        const std::array<bool, 9>& is_work_system_known,
                                        const AxisFlags6& is_start_known) {
  controllers::ControlSetup out;
  for (int system = 1; system <= 9; ++system) {
    const auto k = static_cast<std::size_t>(system - 1);
    if (!is_work_system_known[k]) continue;
    AxisWords offset = setup.work_offset[k];
    for (const Axis axis : kAllAxes) {
      const int i = index_of(axis);
      const auto stored = setup.stored.find(controllers::parameter::work_offset(system) + i);
      if (offset[i] != 0.0 || stored == setup.stored.end()) continue;
      offset[i] = stored->second * (is_linear(axis) ? mm : deg);
    }
    out.work_offset[k] = offset;  // a rotation is in the numbers of the written program
  }
  for (const auto& [number, tool] : setup.tools.entries()) out.tool_length[number] = tool.offset[2];
  for (std::size_t i = 0; i < out.start.size(); ++i) {
    if (is_start_known[i]) out.start[i] = setup.start[static_cast<int>(i)];
  }
  return out;
}

VerificationReport verify_program(const std::string& written, const VerificationRequest& request,
                                  Correction& correction) {
  return Verifier(written, request, correction).run();
}

}  // namespace servomill::sim::programs
