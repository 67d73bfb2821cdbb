/// CL data as comma-separated values (the form is described in cl_data.h).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "controllers/gcode/cl_data.h"

namespace servomill::controllers {

/// As read_cl_data, whatever the name of the file.
ClData read_cl_csv(std::string_view text, const std::string& file,
                   std::vector<Warning>* of_refused);

}  // namespace servomill::controllers
