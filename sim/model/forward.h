/// Names of what a scenario and a machine consist of, for headers that only pass them on.
#pragma once

namespace servomill::sim::model {

// sim/model/machine.h
struct LoopPeriods;
struct MachineSettings;
struct NcSettings;
struct NominalFilter;

// sim/model/scenario.h
struct CaseSpec;
struct CuttingSpec;
struct ProgramSpec;
struct RecordedRunSpec;
struct Scenario;
struct StrategySpec;

// sim/model/design.h
struct SweepDesign;

// sim/model/quantity_spec.h
struct QuantitySpec;

// sim/model/heat.h, machine_test.h, working_day.h
struct HeatSettings;
struct MachineTest;
struct WorkingDay;

}  // namespace servomill::sim::model
