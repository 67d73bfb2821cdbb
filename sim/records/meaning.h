/// Attributes that say what a dataset means.
#pragma once

#include <string>

namespace servomill::sim::records {

/// Description of a dataset, for readers and plots.
struct Meaning {
  std::string units;      // as CF has them: "mm", "s", "1"
  std::string long_name;  // a phrase for the label of a plot
};

}  // namespace servomill::sim::records
