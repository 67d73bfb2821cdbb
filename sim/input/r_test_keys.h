/// Reads what a quantity asks of a ball in the spindle.
#pragma once

#include "plant/kinematics/chain.h"
#include "sim/config/reader.h"

namespace servomill::sim::evaluation {
struct QuantityEntry;
}  // namespace servomill::sim::evaluation

namespace servomill::sim::model {
struct QuantitySpec;
}  // namespace servomill::sim::model

namespace servomill::sim::input {

/// Keys sections or bar, tcp_is_known and error of a [[quantity]].
/// @param layout  of the machine; empty where that could not be read: no error is then looked up
void read_r_test(config::Reader& table, const evaluation::QuantityEntry& entry,
                 const JointLayout& layout, model::QuantitySpec& spec);

}  // namespace servomill::sim::input
