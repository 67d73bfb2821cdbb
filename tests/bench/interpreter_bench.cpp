/// Interpretation of a long program of five axes, each line with F, as a CAM system writes it:
/// lines a second without records (`interpret`) and with those of `servomill canon` (`canon`).
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <string>

#include "controllers/gcode/canon_json.h"
#include "controllers/gcode/interpreter.h"

namespace servomill::controllers {
namespace {

constexpr int kLines = 100'000;

const std::string& program() {
  static const std::string kText = [] {
    std::string text = "G21 G90 G94 G17 G40 G49 G64 P0.01\nG0 X0 Y0 Z0 A0 C0\nF3000\n";
    for (int i = 1; i <= kLines; ++i) {
      const double s = 0.05 * i;  // mm along a wavy path
      text += fmt::format("G1 X{:.4f} Y{:.4f} Z{:.4f} A{:.4f} C{:.4f} F{}\n", s, std::sin(s),
                          0.3 * std::cos(0.2 * s), 20.0 * std::sin(0.01 * s), 0.5 * s,
                          2000 + 500 * (i % 4));
    }
    return text + "M2\n";
  }();
  return kText;
}

void interpret_program(benchmark::State& state) {
  double last = 0.0;
  for (auto _ : state) {
    Interpreter interpreter(program(), "bench.ngc", {});
    while (const Move* move = interpreter.next()) last += move->end_machine[0];
  }
  benchmark::DoNotOptimize(last);
  state.SetItemsProcessed(state.iterations() * kLines);
}
BENCHMARK(interpret_program)->Name("interpret")->Unit(benchmark::kMillisecond);

void canon_of_program(benchmark::State& state) {
  std::size_t bytes = 0;
  for (auto _ : state) {
    Interpreter interpreter(program(), "bench.ngc", {});
    std::string lines;
    while (const Move* move = interpreter.next()) {
      lines.clear();
      add_canon_json(*move, lines);
      bytes += lines.size();
    }
  }
  benchmark::DoNotOptimize(bytes);
  state.SetItemsProcessed(state.iterations() * kLines);
}
BENCHMARK(canon_of_program)->Name("canon")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace servomill::controllers
