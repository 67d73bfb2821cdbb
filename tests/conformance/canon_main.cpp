// Prints the canonical moves of a program, one JSON object a line:
//   canon_main [--tools TABLE] [--subs FOLDER] [--block-delete] PROGRAM
// A fault is the last record. Exit status 2 if there was one.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include "controllers/gcode/canon_json.h"
#include "controllers/gcode/interpreter.h"

namespace {

std::string read_file(const std::string& name) {
  std::ifstream in(name, std::ios::binary);
  if (!in) throw servomill::InputError({name, 0, 0}, "cannot be read");
  return {std::istreambuf_iterator<char>(in), {}};
}

void print_line(const std::string& line) { std::printf("%s\n", line.c_str()); }

void run(int argc, char** argv) {
  servomill::controllers::ProgramSetup setup;
  std::string program;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool has_value = i + 1 < argc;
    if (word == "--tools" && has_value) {
      const std::string table = argv[++i];
      setup.tools = servomill::controllers::ToolTable::parse(read_file(table), table);
    } else if (word == "--subs" && has_value) {
      const std::string folder = argv[++i];
      setup.subroutine_file =
          [folder](const std::string& name) -> std::optional<servomill::controllers::ProgramText> {
        const std::string file = folder + "/" + name + ".ngc";
        if (!std::ifstream(file)) return std::nullopt;
        return servomill::controllers::ProgramText::of_file(file);
      };
    } else if (word == "--block-delete") {
      setup.block_delete = true;
    } else {
      program = word;
    }
  }
  servomill::controllers::Interpreter interpreter(read_file(program), program, setup);
  while (const servomill::Move* move = interpreter.next()) {
    print_line(servomill::controllers::canon_json(*move));
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(argc, argv);
    return 0;
  } catch (const servomill::InputError& error) {
    print_line(servomill::controllers::canon_error_json(error.what()));
    return 2;
  }
}
