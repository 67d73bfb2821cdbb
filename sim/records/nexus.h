/// NeXus attributes of the groups of a file that is being written. Viewers that know them (H5Web,
/// silx, nexusformat) open the file on its default plot and draw groups over their axes.
///
/// Source: NeXus manual v2024.02, sections "Rules for Storing Data Items in NeXus Files" ("Find the
/// plottable data", version 3) and base class NXdata (signal, axes, AXISNAME_indices,
/// auxiliary_signals).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace servomill::sim::records {

class Hdf5Group;  // sim/records/hdf5_group.h
struct Meaning;   // sim/records/meaning.h

/// Dimension of a plotted signal that has no numeric axis, as that of the letters "XYZ".
inline constexpr const char* kNoAxis = ".";

/// Content of a plot: names of datasets in one group.
struct Plot {
  std::string signal;
  std::vector<std::string> axes;    ///< one a dimension of the signal, or kNoAxis
  std::vector<std::string> others;  ///< drawn with the signal: of its shape and unit
  bool is_logarithmic = false;      ///< in both directions
};

/// Marks a group as NXroot (the root), NXentry (a group of the root), NXsubentry (a part of an
/// entry that stands for itself, such as a case) or NXcollection (anything else). With `shown`, the
/// default plot is in that child; the chain from the root ends at an NXdata group.
void make_nexus_group(Hdf5Group& group, const std::string& nx_class, const std::string& shown = "");

/// Marks a group that viewers draw. They label with `long_name` alone, so it gets the unit in
/// brackets: "contour error [um]".
/// @pre signal, axes and others exist in the group
void make_nexus_data(Hdf5Group& group, const Plot& plot);

/// Long name with its unit, and without; a name without unit is itself.
std::string labelled(const Meaning& meaning);
std::string unlabelled(std::string_view label, const std::string& units);

}  // namespace servomill::sim::records
