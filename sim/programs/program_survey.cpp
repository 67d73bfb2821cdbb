#include "sim/programs/program_survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "controllers/gcode/interpreter.h"
#include "controllers/gcode/modal_groups.h"
#include "controllers/gcode/readers/plane_frame.h"
#include "controllers/gcode/request.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "sim/input/machine_description.h"
#include "sim/model/machine.h"
#include "sim/programs/compensate/work_knowledge.h"
#include "sim/programs/given_setup.h"
#include "sim/programs/line_stage.h"
#include "sim/programs/program_duration.h"
#include "sim/programs/travel_check.h"

namespace servomill::sim::programs {
namespace {

using controllers::ExecutedBlock;
using controllers::Group;
using controllers::ProgramSetup;
using controllers::ProgramText;
using controllers::translation::Language;

struct SurveyInputs : GivenSetup {
  std::shared_ptr<const model::MachineSettings> machine;
};

SurveyInputs read_inputs(const SurveyRequest& request) {
  SurveyInputs out;
  if (!request.inputs.machine.empty()) {
    out.machine = input::read_machine_description(request.inputs.machine).machine;
  }
  const JointLayout* layout = out.machine ? &out.machine->chain.layout : nullptr;
  static_cast<GivenSetup&>(out) = given_setup(request.program_file, request.inputs,
                                              request.work_offsets, request.tool_lengths, layout);
  return out;
}

void note_first(std::vector<FirstUse>& uses, const std::string& word, int line) {
  const auto is_same = [&](const FirstUse& use) { return use.word == word; };
  if (std::none_of(uses.begin(), uses.end(), is_same)) uses.push_back({word, line});
}

// One pass over a program, line by line.
class Surveyor {
 public:
  Surveyor(const SurveyInputs& inputs, ProgramSurvey& out)
      : inputs_(inputs),
        out_(out),
        positions_(inputs.given, inputs.setup.start),
        language_(inputs.language) {
    if (!inputs.machine) return;
    duration_ = std::make_unique<ProgramDuration>(*inputs.machine);
    travel_.emplace(*inputs.machine);
  }

  void add(const ExecutedBlock& block) {
    note_words(block);
    note_tools(block);
    positions_.begin_line(block);
    if (duration_ && !block.unknown_moves.empty()) {
      duration_->add_unknown_moves(block.unknown_moves, block.line);
    }
    const Move* last = nullptr;
    for (const Move& move : block.moves) {
      if (is_motion(move.kind)) last = &move;
    }
    for (const Move& move : block.moves) add_move(move, block, &move == last);
  }

  void finish() {
    if (!duration_) return;
    duration_->finish();
    out_.outside_travel = travel_->faults(out_.file);
    out_.cycle_time =
        CycleTime{inputs_.machine->name, duration_->duration(),       why_time_is_unknown(),
                  duration_->left_out(), duration_->unknown_dwells(), duration_->unknown_moves()};
  }

 private:
  std::string why_time_is_unknown() const {
    if (!duration_->why_unknown().empty()) return duration_->why_unknown();
    if (out_.read_to > 0) return fmt::format("the program is read up to line {}", out_.read_to);
    const bool is_empty = duration_->duration() == 0.0 && !duration_->left_out().empty();
    return is_empty ? "every move is from or to an unknown position" : "";
  }

  void add_move(const Move& move, const ExecutedBlock& block, bool is_last) {
    if (move.kind == MoveKind::tool) ++out_.tool_changes;
    if (move.kind == MoveKind::stop) ++out_.stops;
    if (!is_motion(move.kind)) {
      if (duration_ && move.kind != MoveKind::message) duration_->add_other(move);
      return;
    }
    MoveKnowledge known = positions_.next(move, block, is_last);
    hide_compensated(block, known);
    if (travel_) travel_->add(move, known, *block.file);
    out_.extent.add(move, known);
    if (duration_) duration_->add(move, known.distance_is_known);
    if (known.is_place) return;
    note_first(out_.work_systems, system_name(out_, known.work_system),
               work_system_lines_[known.work_system]);
    if (!block.frame->is_translation_known) {
      out_.unknown_systems.insert(block.frame->additional_system);
    }
    if (block.state->controls_tip() && out_.tcp_controlled == 0) out_.tcp_controlled = move.line;
  }

  // The path of a tool of unknown radius is off the programmed one in the plane.
  void hide_compensated(const ExecutedBlock& block, MoveKnowledge& known) {
    const controllers::Compensation& compensation = block.state->compensation;
    const bool is_hidden = compensation.is_on && compensation.is_radius_unknown;
    if (!is_hidden && !is_begin_hidden_) return;
    if (is_hidden && out_.unknown_radius == 0) out_.unknown_radius = block.line;
    known.distance_is_known = false;
    for (std::size_t i = 0; i < kLinearJoints; ++i) {
      if (i == static_cast<std::size_t>(block.state->normal_axis)) continue;
      if (is_hidden) known.end_work_is_known[i] = known.end_machine_is_known[i] = false;
      if (is_begin_hidden_) known.begin_work_is_known[i] = known.begin_machine_is_known[i] = false;
    }
    is_begin_hidden_ = is_hidden;
  }

  void note_words(const ExecutedBlock& block) {
    const int additional = block.frame->additional_system;
    if (additional != std::exchange(additional_system_, additional)) {
      work_system_lines_.try_emplace(kAdditionalSystem + additional, block.line);
    }
    if (block.request == nullptr) return;
    const auto& words = *block.request;
    const int units = words.code(Group::g_units);
    if (units >= 0 && language_ != Language::siemens) {
      const std::string of_conversation = units == 200 ? "BEGIN PGM INCH" : "BEGIN PGM MM";
      note_first(out_.units,
                 language_ == Language::conversational ? of_conversation
                                                       : controllers::code_name('G', units),
                 block.line);
    }
    const int code = words.code(Group::g_non_modal);
    if (code == 100 || code == 520 || code == 920) {
      const bool is_zero = language_ == Language::siemens && code == 100;
      note_first(out_.shifts, is_zero ? "G500" : controllers::code_name('G', code), block.line);
    }
    const bool is_retract = language_ == Language::conversational && code == 280;  // M140 MB MAX
    if (is_retract && out_.unknown_retract == 0) out_.unknown_retract = block.line;
    if (words.code(Group::g_work_system) < 0) return;
    work_system_lines_.try_emplace(block.state->work_system, block.line);
  }

  SurveyedTool& tool(int number, int line) {
    const auto [found, is_new] = out_.tools.try_emplace(number);
    SurveyedTool& tool = found->second;
    if (!is_new) return tool;
    tool.first_line = line;
    const auto* entry = inputs_.setup.tools.entry_of(number);
    tool.is_in_table = entry != nullptr;
    if (entry == nullptr) return tool;
    tool.length = entry->offset[index_of(Axis::Z)];
    if (entry->diameter > 0.0) tool.diameter = entry->diameter;
    return tool;
  }

  void note_tools(const ExecutedBlock& block) {
    const auto& state = *block.state;
    if (block.request != nullptr && block.request->has('T') && state.selected_tool > 0) {
      tool(state.selected_tool, block.line);
    }
    for (const Move& move : block.moves) {
      if (move.kind == MoveKind::tool && move.number > 0) {
        tool(move.number, block.line).is_loaded = true;
      }
    }
    if (state.tool_offset_number > 0) {
      tool(state.tool_offset_number, block.line).uses_length = true;
    }
    if (block.request == nullptr || block.request->code(Group::g_cutter_compensation) < 0) return;
    if (!state.compensation.is_on) return;
    const bool has_D = block.request->has('D');
    const int number = has_D ? static_cast<int>(std::lround((*block.request)['D'])) : state.tool;
    const int code = block.request->code(Group::g_cutter_compensation);
    const bool is_table = code == 410 || code == 420;  // G41.1 and G42.1 say the diameter
    if (is_table && number > 0) tool(number, block.line).uses_diameter = true;
  }

  const SurveyInputs& inputs_;
  ProgramSurvey& out_;
  KnownPositions positions_;
  std::unique_ptr<ProgramDuration> duration_;
  std::optional<TravelCheck> travel_;
  std::map<int, int> work_system_lines_;  // by MoveKnowledge::work_system; 0: at the start
  int additional_system_ = 0;
  Language language_;
  bool is_begin_hidden_ = false;  // of the next move: that of a tool of unknown radius
};

void survey_moves(const SurveyInputs& inputs, ProgramSurvey& out) {
  Surveyor surveyor(inputs, out);
  LineStage lines(out.file);
  try {  // a program of Siemens is refused before its first block
    controllers::Interpreter interpreter(ProgramText::of_file(out.file), inputs.setup);
    while (const auto block = interpreter.next_block()) {
      throw_if_interrupted();
      lines.at(block->line);
      surveyor.add(*block);
    }
  } catch (const InputError& error) {
    out.read_to = error.faults().front().place.line;
  }
  surveyor.finish();
}

ReaderVerdict verdict(std::size_t reader, const ProgramSetup& setup, const std::string& file) {
  ReaderVerdict out{controllers::kReaders[reader], {}};
  ProgramSetup own = setup;
  own.reader = static_cast<controllers::Reader>(reader);
  own.takes_five_axis_codes = own.reader != controllers::Reader::linuxcnc;
  // the control is set to one of them, and reads the program either way; the reader that is chosen
  // counts as it is
  if (own.decimal_point == controllers::DecimalPoint::unset && own.reader != setup.reader) {
    own.decimal_point = controllers::DecimalPoint::calculator;
  }
  try {
    controllers::Interpreter interpreter(ProgramText::of_file(file), std::move(own));
    LineStage lines(file);
    while (const Move* move = interpreter.next()) {
      throw_if_interrupted();
      lines.at(move->line);
    }
  } catch (const InputError& error) {
    out.stop = error.faults().front();
  }
  return out;
}

}  // namespace

std::string system_name(const ProgramSurvey& survey, int system) {
  if (survey.language == Language::conversational) return fmt::format("preset {}", system);
  constexpr int kLastNamed = 4;  // G54 ... G57, then G505 ... G509
  const bool is_numbered = survey.language == Language::siemens && system > kLastNamed;
  return is_numbered ? fmt::format("G50{}", system) : work_system_name(system);
}

ProgramSurvey survey_program(const SurveyRequest& request) {
  SurveyInputs inputs = read_inputs(request);
  ProgramSurvey out;
  out.file = request.program_file;
  out.language = inputs.language;
  out.has_tool_table = !inputs.setup.tools.empty();
  inputs.setup.start[index_of(Axis::Z)] = kSomeHeight;
  inputs.setup.tools.take_any_number();
  inputs.setup.accepts_unknown_dwells = inputs.setup.accepts_unknown_positions = true;
  inputs.setup.accepts_unknown_feeds = true;
  inputs.setup.probed = std::make_shared<controllers::AssumedContact>();
  Stage parts("parts", 2.0, Steps::unlike);  // moves, controls that read it
  survey_moves(inputs, out);
  parts.advance();
  // every control has a tool table of its own: without one here, no number stops a reader
  ProgramSetup setup = program_setup(request.inputs, request.program_file);
  for (const std::string& text : request.tool_lengths) add_tool_length(text, setup.tools);
  if (setup.tools.empty()) setup.tools.take_any_number();
  setup.accepts_unknown_positions = true;
  setup.probed = inputs.setup.probed;
  using controllers::Reader;
  Stage stage("controls", static_cast<double>(controllers::kReaders.size()), Steps::unlike);
  for (std::size_t k = 0; k < controllers::kReaders.size(); ++k) {
    const auto reader = static_cast<Reader>(k);
    stage.reach(static_cast<double>(k));
    const bool is_of_other =
        (reader == Reader::heidenhain && inputs.language != Language::conversational) ||
        (reader == Reader::siemens && inputs.language != Language::siemens);
    if (reader == Reader::any || is_of_other) continue;
    out.readers.push_back(verdict(k, setup, out.file));
  }
  return out;
}

}  // namespace servomill::sim::programs
