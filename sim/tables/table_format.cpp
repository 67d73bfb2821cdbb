#include "sim/tables/table_format.h"

#include "plant/vocabulary/units.h"

namespace servomill::sim::tables {
namespace {

// Files for the volumetric compensation of the ISG kernel.
FormatRules exchange(std::string_view document, bool grids) {
  return {.document = document,
          .most_points = 10000,
          .cross = true,
          .power_of_two = false,
          .one_turn = false,
          .wraps = false,
          .direction = DirectionRule::none,
          .length_step = 1e-6 * mm,
          .angle_step = 1e-9,
          .components = true,
          .tool_side = true,
          .grids = grids};
}

// Skew corrections of firmwares: three numbers.
FormatRules skew(std::string_view document) {
  return {.document = document,
          .most_points = 10000,
          .cross = true,
          .power_of_two = false,
          .one_turn = false,
          .wraps = false,
          .direction = DirectionRule::none,
          .length_step = 0.0,
          .angle_step = 1e-8,
          .skew = true};
}

}  // namespace

const FormatRules& rules_of(TableFormat format) {
  static const std::array<FormatRules, kTableFormats.size()> kRules = {{
      {.document = "LinuxCNC, INI Configuration, [JOINT_N]: COMP_FILE, COMP_FILE_TYPE, as read by "
                   "usrmotLoadComp (src/emc/motion/usrmotintf.cc) and EMCMOT_SET_JOINT_COMP "
                   "(src/emc/motion/command.c)",
       .most_points = 256,  // EMCMOT_COMP_SIZE
       .cross = false,
       .power_of_two = false,
       .one_turn = false,
       .wraps = false,
       .direction = DirectionRule::own,
       .length_step = 1e-6 * mm,
       .angle_step = 1e-8 * deg},
      {.document = "HEIDENHAIN, Technical Manual MANUALplus 620 (2012), pages 716 to 718 (columns "
                   "of *.COM and *.CMA); Technical Manual TNC 407/415/425 (1998), pages 151 to 156 "
                   "and 622 (sign, limits)",
       .most_points = 256,
       .cross = true,
       .power_of_two = true,
       .one_turn = true,
       .wraps = true,
       .direction = DirectionRule::own,
       .length_step = 1e-4 * mm,
       .angle_step = 1e-5 * deg},
      {.document = "Siemens, SINUMERIK 840D sl/828D Function Manual Extended Functions (03/2013), "
                   "6FC5397-1BP40-3BA1, K3 Compensations, pages 237 to 268",
       .most_points = 200,  // of a SINUMERIK 828D (page 264)
       .cross = true,
       .power_of_two = false,
       .one_turn = false,
       .wraps = true,
       .direction = DirectionRule::all,
       .length_step = 1e-6 * mm,
       .angle_step = 1e-8 * deg},
      {.document = "RFC 4180; names of ISO 230-1 and ISO 230-7",
       .most_points = 10000,
       .cross = true,
       .power_of_two = false,
       .one_turn = false,
       .wraps = false,
       .direction = DirectionRule::all,
       .length_step = 1e-4 * um,
       .angle_step = 1e-4 * urad,
       .components = true},
      exchange("Beckhoff, TF5280 TwinCAT 3 CNC Volumetric Compensation: ISG CSV format "
               "(296429067.html), Units of measure (296426379.html), List of parameters supported "
               "(296423819.html)",
               true),
      exchange("Beckhoff, TF5280 TwinCAT 3 CNC Volumetric Compensation: Etalon Exchange Format "
               "(296430091.html), variant Vendor; Units of measure (296426379.html)",
               false),
      skew("Marlin, Marlin/src/gcode/calibrate/M852.cpp and skew() in Marlin/src/module/planner.h"),
      skew("Klipper, klippy/extras/skew_correction.py"),
      skew("RepRapFirmware, M556 (duet3d.dozuki.com/Wiki/M556), Move::AxisTransform in "
           "src/Movement/Move.cpp"),
  }};
  return kRules[static_cast<std::size_t>(format)];
}

}  // namespace servomill::sim::tables
