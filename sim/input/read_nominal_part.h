/// Reads the part as it should be.
#pragma once

#include <memory>

#include "sim/config/reader.h"
#include "sim/evaluation/nominal_part.h"
#include "sim/input/input_files.h"

namespace servomill::sim::input {

/// Keys of [part]: `stl`, a file, and, in a document that needs no other file, `stl_base64`, its
/// bytes. Nothing without `stl`.
/// @throws InputError if the file cannot be read or bounds no body
std::shared_ptr<const evaluation::NominalPart> read_nominal_part(config::Reader& part,
                                                                 InputFiles& files);

}  // namespace servomill::sim::input
