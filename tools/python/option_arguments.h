/// Keyword arguments of Python as options of a command, so that both read them alike.
#pragma once

#include <pybind11/pybind11.h>

#include <set>
#include <string>
#include <vector>

#include "tools/servomill/command.h"

namespace servomill::python {

/// "tolerance='1 um', max_block=0.5, work_offset=[...], correct_rapids=True" as "--tolerance=1 um",
/// "--max-block=0.5", one --work-offset for each, "--correct-rapids". None and False: not given. A
/// dictionary is one KEY=VALUE for each entry.
/// @param without  options of the command that mean nothing to a function, beside force, help and
///                 quiet
/// @throws InputError for one of these
tools::Arguments arguments_of(const std::string& word, const pybind11::kwargs& options,
                              const std::set<std::string>& without = {});

/// The values of a dictionary as --set takes them: KEY=VALUE with TOML.
std::vector<std::string> changes_of(const pybind11::object& set);

}  // namespace servomill::python
