#include "strategies/none.h"

namespace servomill::strategies {
namespace {

std::unique_ptr<Strategy> make(const Parameters&, Action, const IdentifiedMachine&) {
  return std::make_unique<Strategy>();
}

}  // namespace

Entry none_entry() {
  Entry entry = {"none", "changes nothing", {}, make};
  entry.reads_errors = false;
  entry.acts = false;
  return entry;
}

}  // namespace servomill::strategies
