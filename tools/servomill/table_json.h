/// Compensation tables that were written, as JSON.
#pragma once

#include <string>
#include <vector>

namespace servomill::sim::tables {
struct TableExport;
struct TableVerification;
}  // namespace servomill::sim::tables

namespace servomill::tools {

/// One object: the tables with their points, what they leave, how they were verified.
/// @param files  that were written
std::string tables_json(const sim::tables::TableExport& tables,
                        const sim::tables::TableVerification& verified,
                        const std::vector<std::string>& files);

}  // namespace servomill::tools
