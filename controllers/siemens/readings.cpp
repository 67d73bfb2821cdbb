// Readings that depend on the control or its settings.
#include <array>

#include "controllers/siemens/siemens.h"

namespace servomill::controllers::siemens {
namespace {

constexpr auto kReadings = std::to_array<Reading>({
    {"a program without M30", "ends with its last block", "840D sl", "from memory"},
    {"G17, G90, G71, G94, G64, a work offset that no block programs",
     "active at the start (factory defaults, except G64)",
     "by machine: MD20150 and the preset work offset",
     "840D sl, Fundamentals, \"G commands\"; from memory"},
    {"T in a program without M6", "changes the tool", "machines with MD22550 = 0",
     "Tool Offset (W1), 6FC5397-0BP10-2BA0, p. 33"},
    {"M6 without D", "selects D1",
     "machines with MD20270 = 1 (--parameter $MC_CUTTING_EDGE_DEFAULT)",
     "Tool Offset (W1), 6FC5397-0BP10-2BA0, p. 13; the default from memory"},
    {"SUPA, G53 and G153 with an active tool length", "the tool length remains active",
     "machines with MD10760 = 0 (--parameter $MN_G53_TOOLCORR)",
     "ISO Dialects Milling 04.07, p. 3-42; the default from memory"},
    {"G18 and G19 with a tool length", "the length remains along Z; holes along Y or X are refused",
     "machines with SD42940 = 17 (--parameter $SC_TOOL_LENGTH_CONST)",
     "NC programming 12/2019, 6FC5398-2EP40-0BA0, p. 750"},
    {"F with G70", "refused, unless the basic unit of the machine is given",
     "by machine: MD10240 (--parameter $MN_SCALING_SYSTEM_IS_METRIC)",
     "802D sl Operation and Programming 06/2006, p. 8-139"},
    {"ROT with several angles", "about Z, the new Y, the new X", "machines with MD10600 = 1",
     "840D sl, Fundamentals, \"Programmable rotation\"; from memory"},
    {"an increment after a change of frame, work offset or tool length", "refused",
     "by machine: SD42440, SD42442", "840D sl, K2 (6FC5397-0BP10-0BA0) p. 1-7"},
    {"TRAORI and TRAFOOF", "the work offset remains active", "by machine: MD10602", "from memory"},
    {"CYCLE800 with _FR", "the retraction before the rotary axes rotate is omitted",
     "by swivel data record", "from memory"},
    {"CYCLE800 with _DIR", "the nearest position of the rotary axes", "by swivel data record",
     "from memory"},
    {"G500", "a zero work offset; the basic frame is assumed to be zero", "by setup",
     "840D sl, Fundamentals, \"Settable work offset\"; from memory"},
    {"F of a block with linear and rotary axes", "the feed of the linear axes",
     "by machine: FGROUP, MD22420", "840D sl, Fundamentals, \"Feedrate\"; from memory"},
    {"T=\"NAME\" without a tool table", "a tool of unknown length, numbered from 30001",
     "every control has its own tool management", "none needed"},
    {"a tool without a tool table", "a tool of unknown length: machine Z is the TCP position",
     "every control has its own tool management", "none needed"},
    {"D2, D3, ... without a tool table", "a cutting edge of unknown length, as D1",
     "every control has its own tool offsets", "none needed"},
    {"G641, G642 and G645", "continuous path as G64; the tolerance comes from CYCLE832",
     "by machine: MD33100", "840D sl, Fundamentals, \"Continuous-path mode\"; from memory"},
    {"COMPON, COMPCURV, COMPCAD, COMPSURF",
     "linear blocks are not compressed; the CYCLE832 tolerance blends them", "by machine: MD20482",
     "840D sl, Fundamentals, \"Compressor functions\"; from memory"},
    {"F and M functions in the block of RND, CHF or CHR", "act after the corner",
     "machines with MD20201 bit 0 = 1", "840D sl Fundamentals 07/2010, 6FC5398-1BP40-0BA0, p. 282"},
    {"ACC, VELOLIM, JERKLIM, OVRRAP, CTOL, ADIS, LIMS and the like", "ignored", "none",
     "none needed"},
    {"ORIWKS", "rotary axes move linearly between blocks", "machines with ORIAXES active",
     "from memory"},
    {"SPOS and M19", "the spindle stops; its orientation is not simulated", "none", "none needed"},
    {"G9", "no exact stop at the end of its block", "none", "none needed"},
    {"RTLIOF", "rapid moves in straight lines", "machines that run RTLION", "from memory"},
    {"M functions of the machine builder, gear stages", "without effect on motion", "by machine",
     "from memory"},
});

}  // namespace

std::span<const Reading> readings() { return kReadings; }

}  // namespace servomill::controllers::siemens
