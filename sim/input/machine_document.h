/// From the files of a machine to the one document that it is read from.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/config/document.h"
#include "sim/input/identified_values.h"
#include "sim/input/input_files.h"

namespace servomill::sim::input {

/// A machine file merged with those that it is based on.
struct MachineDocument {
  config::Document document;                   // without `based_on` and [identified]
  std::optional<IdentifiedValues> identified;  // of the file itself, not of those below it
  std::vector<std::string> files;              // all that were read, the file itself first
};

/// @param at  where the file was named; without a file: the complaint stands in `path`
/// @throws InputError if a file cannot be read, is no machine file, or its [identified] is wrong
MachineDocument machine_document(const std::string& path, InputFiles& files, const Place& at = {});

/// The same of a text as if `path` held it.
MachineDocument machine_document_of_text(const std::string& text, const std::string& path,
                                         InputFiles& files);

/// True if a file, or one that it is based on, describes the structure of a machine: it is none of
/// a scenario. Files that cannot be read describe nothing.
bool is_machine_file(const std::string& path);

}  // namespace servomill::sim::input
