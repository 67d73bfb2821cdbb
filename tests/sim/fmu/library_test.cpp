/// The shared library of exported axes next to a run, through the functions of FMI 2.0.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "sim/fmu/axis_variables.h"
#include "sim/fmu/library/fmi2_functions.h"
#include "sim/model/scenario.h"
#include "tests/sim/fmu/exported.h"
#include "tests/sim/fmu/recorded.h"

namespace servomill::sim::fmu::library_test {
namespace {

using Instantiate = fmi2Component(fmi2String, fmi2Type, fmi2String, fmi2String,
                                  const fmi2CallbackFunctions*, fmi2Boolean, fmi2Boolean);
using GetReal = fmi2Status(fmi2Component, const unsigned*, std::size_t, double*);
using SetReal = fmi2Status(fmi2Component, const unsigned*, std::size_t, const double*);
using DoStep = fmi2Status(fmi2Component, double, double, int);

// The library with one instance; a failure is thrown.
class Drive {
 public:
  Drive(const AxisConstants& axis, double setpoint)
      : folder_(std::filesystem::path(testing::TempDir()) / "fmu_library_test") {
    std::filesystem::create_directories(folder_);
    const std::string text = text_of(axis);
    std::ofstream(folder_ / kConstantsFile) << text;
    if (library_ == nullptr) throw std::runtime_error(dlerror());
    Instantiate* const instantiate = function<Instantiate>("fmi2Instantiate");
    const fmi2CallbackFunctions callbacks{};
    drive_ = instantiate("drive", fmi2CoSimulation, token_of(text).c_str(),
                         ("file://" + folder_.string()).c_str(), &callbacks, 0, 0);
    if (drive_ == nullptr) throw std::runtime_error("no instance");
    set("position_setpoint", setpoint);
    expect(function<fmi2Status(fmi2Component)>("fmi2EnterInitializationMode")(drive_));
    expect(function<fmi2Status(fmi2Component)>("fmi2ExitInitializationMode")(drive_));
  }
  ~Drive() {
    if (drive_ != nullptr) function<void(fmi2Component)>("fmi2FreeInstance")(drive_);
    dlclose(library_);
    std::filesystem::remove_all(folder_);
  }
  Drive(const Drive&) = delete;
  Drive& operator=(const Drive&) = delete;

  void set(const char* name, double value) {
    const unsigned reference = reference_of(name);
    expect(set_real_(drive_, &reference, 1, &value));
  }
  double get(const char* name) {
    const unsigned reference = reference_of(name);
    double value = 0.0;
    expect(get_real_(drive_, &reference, 1, &value));
    return value;
  }
  void step(double from, double to) { expect(do_step_(drive_, from, to - from, 1)); }

 private:
  template <class Signature>
  Signature* function(const char* name) const {
    return reinterpret_cast<Signature*>(dlsym(library_, name));
  }
  static void expect(fmi2Status status) {
    if (status != fmi2OK) throw std::runtime_error("the library has refused a call");
  }

  std::filesystem::path folder_;
  void* library_ = dlopen(SERVOMILL_AXIS_LIBRARY, RTLD_NOW | RTLD_LOCAL);
  fmi2Component drive_ = nullptr;
  GetReal* get_real_ = function<GetReal>("fmi2GetReal");
  SetReal* set_real_ = function<SetReal>("fmi2SetReal");
  DoStep* do_step_ = function<DoStep>("fmi2DoStep");
};

TEST(Library, GivesTheBitsOfARun) {
  const model::Scenario scenario = rich_scenario();
  const Recorded recorded = recorded_of(scenario, "plain");
  const records::Series& servo = recorded.result.servo;
  constexpr int kJoint = 1;
  const std::size_t x = *servo.column("true_linear", 'Y'), i = *servo.column("current_linear", 'Y');
  Drive drive(exported_axis(scenario, kJoint, 0), at_rest(recorded, kJoint).setpoint);
  const auto seconds = [&](Tick n) { return scenario.machine.nc.periods.seconds(n); };
  Tick now = 0;
  for (std::size_t row = 0; row < servo.rows(); ++row) {
    for (const Tick end = static_cast<Tick>(row) * scenario.record_period; now < end;) {
      const AxisInputs in = inputs_at(recorded, now, kJoint);
      drive.set("position_setpoint", in.setpoint);
      drive.set("velocity_setpoint", in.velocity);
      drive.set("acceleration_setpoint", in.acceleration);
      const Tick next = std::min((now / kPosition + 1) * kPosition, end);
      drive.step(seconds(now), seconds(next));
      now = next;
    }
    ASSERT_EQ(drive.get("position") / mm, servo.at(row, x)) << row;
    ASSERT_EQ(drive.get("current"), servo.at(row, i)) << row;
  }
}

}  // namespace
}  // namespace servomill::sim::fmu::library_test
