#include <fmt/format.h>

#include <Eigen/Core>
#include <array>

#include "sim/readings/columns.h"
#include "sim/readings/read_rows.h"

namespace servomill::sim::readings {
namespace {

constexpr std::array<std::string_view, 3> kCoordinates = {"X", "Y", "Z"};

}  // namespace

void read_balls(Artefact& artefact, std::vector<Fault>& faults) {
  const Table table = read_table(artefact.file);
  bool complete = table.find("sphere") != nullptr;
  for (const std::string_view name : kCoordinates) {
    const Column* column = table.find(name);
    complete = complete && column != nullptr && column->unit.quantity == config::kLength;
  }
  if (!complete) {
    faults.push_back({{table.file}, "must have the columns sphere, X_mm, Y_mm and Z_mm"});
    return;
  }
  for (const Row& row : table.rows) {
    Ball ball;
    ball.name = table.text(row, *table.find("sphere"));
    for (int k = 0; k < 3; ++k) {
      const Column& column = *table.find(kCoordinates[std::size_t(k)]);
      const auto number = table.number(row, column, faults);
      if (!number) faults.push_back({table.place(row, column), column.written + " is empty"});
      ball.centre[k] = number.value_or(0.0);
    }
    if (artefact.find(ball.name)) {
      faults.push_back({{table.file, row.line}, fmt::format("sphere {} appears twice", ball.name)});
    }
    artefact.balls.push_back(std::move(ball));
  }
}

void require_balls(const Artefact& artefact, const Group& group, std::vector<Fault>& faults) {
  if (artefact.balls.empty()) return;  // a fault was found
  std::vector<std::string_view> names;
  for (const Ball& ball : artefact.balls) names.emplace_back(ball.name);
  for (const std::string& name : group.spheres) {
    if (artefact.find(name)) continue;
    faults.push_back({{group.file},
                      fmt::format("sphere {} is not among the balls of \"{}\" ({}){}", name,
                                  artefact.name, artefact.file, did_you_mean(name, names))});
  }
}

}  // namespace servomill::sim::readings
