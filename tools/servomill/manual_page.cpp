#include <fmt/format.h>

#include <array>
#include <sstream>

#include "sim/version.h"
#include "tools/servomill/command_pages.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;

struct ExitStatus {
  int status;
  std::string_view meaning;
};
constexpr std::array<ExitStatus, 5> kExitStatuses = {{{0, "done"},
                                                      {1, "ran but the machine stopped"},
                                                      {2, "the input is wrong"},
                                                      {3, "the system failed"},
                                                      {130, "interrupted"}}};

struct InstalledFile {
  std::string_view name, contents;
};
constexpr std::array<InstalledFile, 4> kInstalledFiles = {{
    {"share/servomill/scenarios/",
     "scenarios, machines, programs and readings; servomill list "
     "scenarios prints the names that commands take"},
    {"share/servomill/page/servomill.html",
     "the page of results, which a browser also opens "
     "without servomill view"},
    {"share/doc/servomill/examples/plugin/", "a strategy as a shared library, to begin with"},
    {"share/doc/servomill/examples/notebooks/",
     "with the Python module: the paper in ten cells, a "
     "measured machine, a strategy of one's own"},
}};

// Text that roff prints as it is.
std::string escaped(std::string_view text) {
  std::string out;
  if (!text.empty() && (text.front() == '.' || text.front() == '\'')) out = "\\&";
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
  }
  return out;
}

// Paragraphs are filled; indented lines are examples and lists, and stay.
std::string body(const std::string& text) {
  std::string out;
  bool is_literal = false, is_new = false;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const bool is_indented = line.starts_with(' ');
    if (is_literal && !line.empty() && !is_indented) {
      out += ".EE\n";
      is_literal = false;
    }
    if (line.empty()) {
      is_new = true;
      continue;
    }
    if (is_new) out += is_literal ? "\n" : ".PP\n";
    if (is_indented && !is_literal) {
      out += ".EX\n";
      is_literal = true;
    }
    is_new = false;
    out += escaped(line) + "\n";
  }
  return is_literal ? out + ".EE\n" : out;
}

// "-o [ --output ]" in bold, the value in italics.
std::string option_entry(const po::option_description& option) {
  std::string name = fmt::format("\\fB\\-\\-{}\\fR", escaped(option.long_name()));
  const std::string both = option.format_name();
  if (both.size() > 2 && both[1] != '-') {
    name = fmt::format("\\fB\\-{}\\fR, {}", both[1], name);
  }
  const std::string value = option.format_parameter();
  if (!value.empty()) name += fmt::format(" \\fI{}\\fR", escaped(value));
  std::string text;
  std::istringstream lines(option.description());
  for (std::string line; std::getline(lines, line);) {
    text += (text.empty() ? "" : ".br\n") + escaped(line) + "\n";
  }
  return fmt::format(".TP\n{}\n{}", name, text);
}

}  // namespace

std::string exit_status_line() {
  std::string out = "Exit status:";
  for (const ExitStatus& one : kExitStatuses) {
    out += fmt::format("{} {} {}", one.status == 0 ? "" : ",", one.status, one.meaning);
  }
  return out + ".";
}

std::string manual_page(const CommandTexts& texts, std::string_view summary) {
  const bool is_program = texts.command.empty();
  const std::string name = is_program ? "servomill" : "servomill-" + texts.command;
  const std::string call = is_program ? "servomill" : "servomill " + texts.command;
  std::string upper = name;
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string out = fmt::format(".TH {} 1 \"\" \"servomill {}\" \"User Commands\"\n",
                                escaped(upper), sim::kVersion);
  out += fmt::format(".SH NAME\n{} \\- {}\n", escaped(name), escaped(summary));
  out += fmt::format(".SH SYNOPSIS\n.B {}\n{}\n", escaped(call), escaped(texts.synopsis));
  out += ".SH DESCRIPTION\n" + body(texts.description);
  if (!texts.options.options().empty()) {
    out += ".SH OPTIONS\n";
    for (const auto& option : texts.options.options()) out += option_entry(*option);
  }
  out += ".SH EXIT STATUS\n";
  for (const ExitStatus& one : kExitStatuses) {
    out += fmt::format(".TP\n.B {}\n{}\n", one.status, escaped(one.meaning));
  }
  if (is_program) {
    out += ".SH FILES\nIn the prefix of the installation (/usr, /usr/local):\n";
    for (const InstalledFile& one : kInstalledFiles) {
      out += fmt::format(".TP\n.I {}\n{}\n", escaped(one.name), escaped(one.contents));
    }
  }
  return out + (is_program ? "" : ".SH SEE ALSO\n.BR servomill (1)\n");
}

}  // namespace servomill::tools
