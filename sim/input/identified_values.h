/// Values of a machine file that were identified: its table [identified].
///
/// ```toml
/// based_on = "start_machine.toml"        # the machine that was started from
/// [axis.X]
/// moving_mass = "95.11 kg"               # +- 1.2 kg (k = 2)
/// [axis.X.friction]
/// coulomb = "19.98 N"                    # +- 0.4 N (k = 2)
/// [identified]
/// keys = ["axis.X.moving_mass", "axis.X.friction.coulomb"]
/// units = ["kg", "N"]
/// values = [95.11, 19.98]
/// covariance = [[0.36, 0.01], [0.01, 0.04]]
/// unidentifiable = ["axis.X.gravity_load"]
/// ```
/// (This example is also a test: IdentifiedFileTest.ReadsTheExampleOfItsHeader.)
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "sim/config/reader.h"

namespace servomill::sim::input {

/// Unit of a number without one, such as a ratio.
inline constexpr std::string_view kPlainNumber = "1";

struct IdentifiedValues {
  std::vector<std::string> keys;            // of the machine, dotted: "axis.X.friction.coulomb"
  std::vector<std::string> units;           // one a key: "N"; "1": a plain number
  std::vector<double> values;               // in these units
  Eigen::MatrixXd covariance;               // in products of these units
  std::vector<std::string> unidentifiable;  // keys whose value is the one that was started from
};

/// Values and their covariance of the table `identified` of a machine file. Its values are those
/// that the file itself sets. Nothing where there is no such table.
/// @param machine  all keys of the file; the others are left alone
std::optional<IdentifiedValues> read_identified(config::Reader& machine);

/// Value at a dotted key, items of lists as "value_um[3]", of lists in
/// lists as "value_um[3][0]"; nullptr: there is none.
const config::Value* value_at(const config::Value& root, std::string_view key);

/// True if a value is a number, in its own unit or that of its key, and the same as one in `unit`
/// but for rounding.
bool is_same_number(const config::Value& value, std::string_view key, double number,
                    const std::string& unit);

/// The lines of the table, with as many digits as it takes to read the same bits again.
std::string table_lines(const IdentifiedValues& identified);

/// Keys, units, values and covariance of a table alone, not compared with anything.
IdentifiedValues read_identified_table(config::Reader& table);

}  // namespace servomill::sim::input
