// Tools: T, D, M6.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/siemens/codes.h"
#include "controllers/siemens/translator.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::siemens {
namespace {

constexpr int kMaxTools = 32000;
constexpr int kFirstNamed = 30001;  // numbers of tools that only have names

}  // namespace

// T names the next tool and M6 changes it (MD22550 = 1), or T changes it at once (MD22550 = 0),
// which is taken for programs without any M6. [F] "Tool change"
void Translator::tools(const Block& block) {
  if (block.tool) next_tool_ = tool_number(block);
  const bool has_M6 = std::any_of(block.functions.begin(), block.functions.end(),
                                  [](const Function& one) { return one.number == 6; });
  const bool changes_at_once = block.tool && !files_.front()->changes_tools_by_M6();
  if (changes_at_once) {
    warn_once("T", "T is treated as a tool change: the program has no M6 (MD22550 = 0)");
  }
  if ((has_M6 || changes_at_once) && next_tool_ >= 0) change_tool(next_tool_);
  if (has_M6 && next_tool_ < 0) {
    warn_once("M6", "M6 without a preceding T is ignored: the tool remains in the spindle");
  }
  if (block.D) {
    constexpr int kMaxEdges = 99;
    const double edge = block.D->value;
    if (edge != std::floor(edge) || edge < 0.0 || edge > kMaxEdges) {
      fail(block.D->place, fmt::format("D{:g}: must be an integer from 0 to {}", edge, kMaxEdges));
    }
    is_edge_programmed_ = true;
    set_edge(static_cast<int>(edge), block.D->place);
  }
}

int Translator::tool_number(const Block& block) {
  const Value& value = *block.tool;
  if (value.text) return named_tool(*value.text, block.tool_place);
  const double number = value.number;
  if (number != std::floor(number) || number < 0.0 || number > kMaxTools) {
    fail(block.tool_place,
         fmt::format("T{:g}: must be an integer from 0 to {}", number, kMaxTools));
  }
  return static_cast<int>(number);
}

// T="MILL 10": the names are those of the control's tool management. Without any table here, each
// name is a tool of unknown length, with a number that no program writes.
int Translator::named_tool(const std::string& name, const Place& place) {
  const bool is_number =
      !name.empty() && name.size() < 6 && name.find_first_not_of("0123456789") == name.npos;
  if (is_number && std::stoi(name) <= kMaxTools) return std::stoi(name);
  if (name.empty()) return 0;
  if (!setup_.tools.empty()) {
    fail(place,
         fmt::format("T=\"{}\": tool names are not supported with --tools; use the tool number",
                     name));
  }
  const auto [found, is_new] =
      tool_names_.try_emplace(capitals(name), kFirstNamed + static_cast<int>(tool_names_.size()));
  if (is_new) {
    warn_once("tool " + name,
              fmt::format(
                  "T=\"{}\": treated as tool {} of unknown length; pass a tool table with --tools",
                  name, found->second));
  }
  return found->second;
}

// Cutting edge D1 is selected with the tool: MD20270 = 1, as delivered.
void Translator::change_tool(int number) {
  require_no_compensation("a tool change");
  if (is_tcp_) fail("a tool change is not allowed with TRAORI; cancel it with TRAFOOF");
  if (!plane_line_.empty())
    fail("a tool change is not allowed in a plane of CYCLE800; program CYCLE800() first");
  const bool is_same = has_tool_ && number == tool_;
  next_tool_ = number;
  tool_ = number;
  has_tool_ = true;
  is_edge_programmed_ = false;
  path_.flush();
  if (!is_same) {
    spindle_ = 0;
    lines_.put(fmt::format("T{} M6", number), place_);
    work_[2].reset();
    edge_ = -1;
  }
  set_edge(static_cast<int>(setting("$MC_CUTTING_EDGE_DEFAULT", 1.0)), place_);
}

void Translator::set_edge(int edge, const Place& place) {
  if (edge > 1 && setup_.tools.entry_of(tool_) != nullptr) {
    fail(place, fmt::format("D{}: the tool table has only one cutting edge per tool, D1", edge));
  }
  if (edge > 1) {
    warn_once(
        fmt::format("D{}", edge),
        fmt::format("D{}: the length of this cutting edge is unknown; that of D1 is used", edge));
  }
  // all edges have the length of D1 here
  if (edge == edge_ || (edge > 0 && edge_ > 0)) {
    edge_ = edge;
    return;
  }
  require_no_compensation("D");
  if (is_tcp_) fail(place, "D is not allowed with TRAORI; cancel it with TRAFOOF");
  edge_ = edge;
  path_.flush();
  put_length();
}

double Translator::tool_length() const {
  const ToolEntry* tool = setup_.tools.entry_of(tool_);
  return tool != nullptr && edge_ != 0 ? tool->offset[2] / mm : 0.0;
}

// The length acts along the axis across the working plane (SD42940 = 0), or along Z whatever the
// plane (SD42940 = 17). Contours with arcs in G18 and G19 need the latter, holes along Y or X the
// former, which G-code does not have.
void Translator::check_length_axis(bool is_hole) {
  if (modes_.normal == 2 || tool_length() == 0.0) return;
  const bool is_along_Z = setting("$SC_TOOL_LENGTH_CONST", is_hole ? 0.0 : 17.0) == 17.0;
  const std::string which = fmt::format("G{} with an active tool length", 19 - modes_.normal);
  if (!is_along_Z) {
    fail(
        fmt::format("{}: it acts along {} (SD42940 = 0), which is not supported; pass --parameter "
                    "'$SC_TOOL_LENGTH_CONST=17' if it remains along Z on the machine",
                    which, "XYZ"[modes_.normal]));
  }
  warn_once("plane", which + ": it remains along Z (SD42940 = 17)");
}

void Translator::put_length() {
  const bool is_known = edge_ > 0 && tool_ != 0 && setup_.tools.find(tool_) != nullptr;
  if (is_tcp_) {
    lines_.put(fmt::format("G43.4 H{}", tool_), place_);
  } else {
    path_.flush();
    lines_.put(is_known ? fmt::format("G43 H{}", tool_) : "G49", place_);
  }
  if (!is_tcp_) work_[2].reset();
  if (edge_ <= 0 || tool_ == 0 || is_known || !setup_.tools.empty()) return;
  warn_once("length", fmt::format("the length of tool {} is unknown, so machine Z is treated as "
                                  "the TCP position; pass a tool table with --tools",
                                  tool_));
}

double Translator::tool_radius() {
  const ToolEntry* tool = setup_.tools.find(tool_);
  if (tool == nullptr || edge_ == 0) {
    fail(
        fmt::format("G41 and G42: the radius of tool {} is unknown; pass a tool table with "
                    "--tools",
                    tool_));
  }
  return tool->diameter / 2.0 / mm;
}

// A survey that lacks the radius follows the programmed contour.
bool Translator::survey_knows_no_radius() {
  const bool is_unknown =
      setup_.tools.find(tool_) != nullptr && setup_.tools.entry_of(tool_) == nullptr;
  if (is_unknown) {
    warn_once("radius",
              fmt::format("G41 and G42: the radius of tool {} is unknown; the path is the "
                          "programmed contour; pass a tool table with --tools",
                          tool_));
  }
  return is_unknown;
}

}  // namespace servomill::controllers::siemens
