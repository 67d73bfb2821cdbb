#include "strategies/harmonic.h"

#include "strategies/linearisation.h"

namespace servomill::strategies {
namespace {

std::unique_ptr<Strategy> make(const Parameters& p, Action, const IdentifiedMachine& identified) {
  return make_error_model(plant::ErrorShape::harmonic, p, identified);
}

}  // namespace

Entry harmonic_entry() {
  Entry entry = {"harmonic", "linearises moves with rotary axes using the error model a sin(pi t)",
                 error_model_specs(), make};
  entry.reads_errors = false;
  return entry;
}

}  // namespace servomill::strategies
