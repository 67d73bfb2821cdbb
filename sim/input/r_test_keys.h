/// Reads what a quantity asks of a ball in the spindle.
#pragma once

#include "plant/kinematics/chain.h"
#include "sim/config/reader.h"

namespace servomill::sim {

struct QuantityEntry;
struct QuantitySpec;

/// Keys sections or bar, tcp_is_known and error of a [[quantity]].
/// @param layout  of the machine; empty where that could not be read: no error is then looked up
void read_r_test(Reader& table, const QuantityEntry& entry, const JointLayout& layout,
                 QuantitySpec& spec);

}  // namespace servomill::sim
