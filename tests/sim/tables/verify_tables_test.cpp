// Written tables are read back as the control documents them and compared with the error model.
#include "sim/tables/verify_tables.h"

#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>

#include "sim/model/machine.h"
#include "tests/sim/tables/rich_tables.h"

namespace servomill::sim::tables::verify_tables_test {
namespace {

TEST(VerifyTables, EveryFormatHoldsTheErrorModel) {
  for (const TableFormat format :
       {TableFormat::linuxcnc, TableFormat::heidenhain, TableFormat::siemens, TableFormat::csv,
        TableFormat::isg, TableFormat::etalon}) {
    for (const int type : {0, 1}) {
      if (type == 1 && format != TableFormat::linuxcnc) continue;
      const TableExport tables = rich_tables(format, type);
      const auto files = table_files(tables);
      ASSERT_EQ(fault_of(tables, files), "verified") << name_of(format);
      const TableVerification verified = verify_tables(tables, files);
      EXPECT_GE(verified.positions, 8000U) << name_of(format);
      // interpolation over 10 mm of a wave of 60 mm and 10 um: (2 pi 10/60)^2 / 8 of it
      EXPECT_GT(verified.length, 1.0 * um) << name_of(format);
      EXPECT_LT(verified.length, 2.0 * um) << name_of(format);
      EXPECT_GT(verified.angle, 0.1 * urad) << name_of(format);
      EXPECT_LT(verified.angle, 4.0 * urad) << name_of(format);
    }
  }
}

TEST(VerifyTables, OnChainsOfAnyOrderAndSense) {
  for (const char* structure : {"[w X Y b Z t]", "[w C' A' Y b X Z t]", "[w Y b X Z B t]"}) {
    for (const plant::Sense sense : {plant::Sense::tool, plant::Sense::table}) {
      model::MachineSettings machine = machine_of(structure);
      for (auto& axis : machine.chain.axes) axis.sense = sense;
      plant::ErrorModel errors = rich_model();
      if (!machine.chain.layout.joint_of(Axis::C)) errors.component("ECC"_err) = {};
      if (machine.chain.layout.joint_of(Axis::B)) {
        errors.component("EBB"_err) = plant::harmonic(100.0 * urad, 360.0 * deg, 0.4);
      }
      for (const TableFormat format : {TableFormat::linuxcnc, TableFormat::heidenhain,
                                       TableFormat::siemens, TableFormat::csv}) {
        const TableExport tables = export_tables(machine, errors, rich_request(format));
        EXPECT_EQ(fault_of(tables, table_files(tables)), "verified")
            << structure << " " << name_of(format);
      }
    }
  }
}

// Errors of any size, kind and place on machines of any order.
plant::ErrorModel random_model(boost::random::mt19937& engine, const JointLayout& layout) {
  boost::random::uniform_real_distribution<double> part(-1.0, 1.0);
  plant::ErrorModel errors;
  for (const auto& axis : layout.axis) {
    if (!axis) continue;
    const double travel = is_linear(*axis) ? 0.2 : 6.0;  // m, rad
    for (const Axis direction : kAllAxes) {
      const double size = 20e-6 * part(engine);  // m, rad
      plant::ErrorFunction error;
      const bool repeats = !is_linear(*axis);  // after one turn
      if (part(engine) > 0.0) error = plant::polynomial({size, repeats ? 0.0 : size / travel});
      const double period = repeats ? 120.0 * deg : 0.4 * travel;
      if (part(engine) > 0.0) error = error + plant::harmonic(size, period, part(engine));
      if (part(engine) > 0.6) error = error + plant::reversal({0.3 * size}, 1e-3 * travel);
      errors.component({direction, *axis, false}) = error;
      const plant::ErrorName location{direction, *axis, true};
      if (!plant::why_meaningless(location, layout)) errors.location(location) = size;
    }
  }
  return errors;
}

TEST(VerifyTables, RandomModelsAreVerified) {
  boost::random::mt19937 engine(3);
  constexpr int kModels = 5;
  for (int n = 0; n < kModels; ++n) {
    for (const char* structure : {"[w X b Y Z t]", "[w C' A' Y b X Z t]", "[w Y b X Z B t]"}) {
      const model::MachineSettings machine = machine_of(structure);
      const plant::ErrorModel errors = random_model(engine, machine.chain.layout);
      for (const TableFormat format :
           {TableFormat::linuxcnc, TableFormat::heidenhain, TableFormat::siemens, TableFormat::csv,
            TableFormat::isg, TableFormat::etalon}) {
        const TableExport tables = export_tables(machine, errors, rich_request(format));
        ASSERT_EQ(fault_of(tables, table_files(tables)), "verified")
            << structure << " " << name_of(format) << " " << n;
      }
    }
  }
}

TEST(VerifyTables, AnErrorThatDoesNotRepeatIsRefusedForATableThatDoes) {
  plant::ErrorModel errors;
  errors.component("ECC"_err) = plant::polynomial({0.0, 1e-5});  // 62.8 urad a turn
  for (const TableFormat format : {TableFormat::siemens, TableFormat::heidenhain}) {
    try {
      export_tables(machine_of("[w C' X b Y Z t]"), errors, request_of(format));
      FAIL() << name_of(format);
    } catch (const InputError& error) {
      EXPECT_EQ(error.faults()[0].message,
                "the error of C after one revolution differs by 62.83 urad from that at the start, "
                "but the table is periodic; set --travel C=FROM:TO, or use a periodic error");
    }
    TableRequest limited = request_of(format);
    limited.axes[4].from = 0.0;
    limited.axes[4].to = 270.0 * deg;
    limited.axes[3] = limited.axes[4];
    const TableExport tables = export_tables(machine_of("[w C' X b Y Z t]"), errors, limited);
    EXPECT_EQ(fault_of(tables, table_files(tables)), "verified");
  }
}

}  // namespace
}  // namespace servomill::sim::tables::verify_tables_test
