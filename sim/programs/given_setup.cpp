#include "sim/programs/given_setup.h"

#include "sim/model/machine.h"
#include "sim/programs/compensate/work_knowledge.h"

namespace servomill::sim::programs {

GivenSetup given_setup(const std::string& program_file, const ProgramInputs& inputs,
                       const std::vector<std::string>& work_offsets,
                       const std::vector<std::string>& tool_lengths, const JointLayout* layout) {
  GivenSetup out;
  controllers::ProgramText program = controllers::ProgramText::of_file(program_file);
  out.given.has_machine = layout != nullptr;
  out.setup = program_setup(inputs, program_file);
  out.language = controllers::translation::language_of(program, out.setup.reader);
  if (!inputs.parameter_file.empty()) {
    // M140 MB MAX is read as G28
    out.given.has_stored_places =
        out.language != controllers::translation::Language::conversational;
    for (AxisFlags& axes : out.given.work_offset) axes.fill(true);
  }
  const GivenWorkOffsets offsets = programs::work_offsets(work_offsets, layout);
  for (std::size_t k = 0; k < offsets.size(); ++k) {
    if (!offsets[k]) continue;
    out.setup.work_offset[k] = offsets[k]->words;
    out.setup.work_rotation[k] = offsets[k]->rotation;
    for (std::size_t i = 0; i < kAxisWords; ++i) {
      out.given.work_offset[k][i] = out.given.work_offset[k][i] || offsets[k]->given[i];
    }
  }
  for (const std::string& text : tool_lengths) add_tool_length(text, out.setup.tools);
  for (const auto& [number, tool] : out.setup.tools.entries()) {
    out.given.tool_lengths.insert(number);
  }
  return out;
}

}  // namespace servomill::sim::programs
