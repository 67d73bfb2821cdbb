/// The quantity that sim/evaluation/README.md builds step by step.
#include "tests/sim/evaluation/quantity_example.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/evaluation/case_evaluation.h"
#include "sim/model/scenario.h"

namespace servomill::sim::evaluation::quantity_example_test {
namespace {

struct Row {
  double section, rapid, x, y;
};

records::Series series_of(const std::vector<Row>& rows, const char* signal = "tool_deviation") {
  records::Series out(
      {{"section", "1", "", "", ""}, {"rapid", "1", "", "", ""}, {signal, "um", "", "XYZ", "xyz"}});
  for (const Row& row : rows) {
    std::vector<double> to(out.width());
    to[out.column("section", '\0').value()] = row.section;
    to[out.column("rapid", '\0').value()] = row.rapid;
    to[out.column(signal, 'X').value()] = row.x;
    to[out.column(signal, 'Y').value()] = row.y;
    to[out.column(signal, 'Z').value()] = 1e6;  // does not count
    out.append(to);
  }
  return out;
}

QuantityValue value_of(const records::Series& servo, const std::string& statistic,
                       const std::vector<std::string>& sections = {}) {
  const CaseData data{.name = "one", .servo = &servo, .sections = {"", "end"}};
  CaseEvaluation one(data);
  model::QuantitySpec spec;
  spec.statistic = statistic;
  spec.sections = sections;
  return lateral_quantities().front().evaluate(spec, one, nullptr);
}

// Triangles of 3-4-5 and 5-12-13; the last sample is a rapid.
TEST(QuantityExample, IsTheDistanceInThePlane) {
  const records::Series servo = series_of({{0, 0, 3, -4}, {1, 0, 5, 12}, {1, 1, 1e3, 1e3}});
  EXPECT_DOUBLE_EQ(value_of(servo, "max").value, 13.0);
  EXPECT_DOUBLE_EQ(value_of(servo, "mean").value, 9.0);
  EXPECT_DOUBLE_EQ(value_of(servo, "max", {""}).value, 5.0);
}

TEST(QuantityExample, SaysWhyThereIsNone) {
  const records::Series servo = series_of({{0, 0, 3, -4}}, "contour_error");
  const QuantityValue found = value_of(servo, "max");
  EXPECT_TRUE(std::isnan(found.value));
  EXPECT_EQ(found.note, "tool_deviation was not recorded");
}

}  // namespace
}  // namespace servomill::sim::evaluation::quantity_example_test
