#include "sim/records/nexus.h"

#include <cassert>

#include "sim/records/hdf5_dataset.h"
#include "sim/records/hdf5_group.h"

namespace servomill::sim::records {
namespace {

// Texts in place of a unit, of lists whose values differ in unit, are none.
bool is_unit(const std::string& units) {
  return !units.empty() && units != "1" && units != "unknown" && !units.starts_with("as ");
}

std::string bracketed(const std::string& units) { return " [" + units + "]"; }

void label(Hdf5Group& group, const std::string& name) {
  Hdf5Dataset dataset = group.dataset(name);
  const std::string units = dataset.text("units"), long_name = dataset.text("long_name");
  const std::string label = labelled({units, unlabelled(long_name, units)});
  // what several groups share is written once
  if (label != long_name) dataset.attribute("long_name", label);
}

}  // namespace

std::string labelled(const Meaning& meaning) {
  return is_unit(meaning.units) ? meaning.long_name + bracketed(meaning.units) : meaning.long_name;
}

std::string unlabelled(std::string_view label, const std::string& units) {
  const std::string unit = bracketed(units);
  if (is_unit(units) && label.ends_with(unit)) label.remove_suffix(unit.size());
  return std::string(label);
}

void make_nexus_group(Hdf5Group& group, const std::string& nx_class, const std::string& shown) {
  group.attribute("NX_class", nx_class);
  if (!shown.empty()) group.attribute("default", shown);
}

void make_nexus_data(Hdf5Group& group, const Plot& plot) {
  assert(!plot.axes.empty());
  make_nexus_group(group, "NXdata");
  group.attribute("signal", plot.signal);
  group.attribute("axes", plot.axes);
  if (!plot.others.empty()) group.attribute("auxiliary_signals", plot.others);
  if (plot.is_logarithmic) {  // as silx and H5Web have it
    group.attribute("SILX_style", R"({"axes_scale_type": ["log"], "signal_scale_type": "log"})");
  }
  label(group, plot.signal);
  for (const std::string& name : plot.others) label(group, name);
  for (std::size_t dimension = 0; dimension < plot.axes.size(); ++dimension) {
    const std::string& axis = plot.axes[dimension];
    if (axis == kNoAxis) continue;
    group.attribute(axis + "_indices", static_cast<int>(dimension));
    label(group, axis);
  }
}

}  // namespace servomill::sim::records
