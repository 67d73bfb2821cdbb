#include "strategies/parabolic.h"

#include "strategies/linearisation.h"

namespace servomill::strategies {
namespace {

std::unique_ptr<Strategy> make(const Parameters& p, Action, const IdentifiedMachine& identified) {
  return make_error_model(plant::ErrorShape::parabolic, p, identified);
}

}  // namespace

Entry parabolic_entry() {
  Entry entry = {"parabolic",
                 "linearises moves with rotary axes using the error model 4 a t (1 - t)",
                 error_model_specs(), make};
  entry.reads_errors = false;
  return entry;
}

}  // namespace servomill::strategies
