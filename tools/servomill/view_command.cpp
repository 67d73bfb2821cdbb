#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/system/program_folder.h"
#include "sim/system/system_error.h"
#include "tools/servomill/command.h"

namespace servomill::tools {
namespace {

namespace fs = std::filesystem;
namespace po = boost::program_options;

constexpr const char* kPage = "servomill.html";
constexpr const char* kServer = "serve.py";

// Folder with the page and its server: that of an installation, or of a build with SERVOMILL_PAGE.
fs::path page_folder() {
  const std::array<fs::path, 2> folders = {sim::system::installed_share() / "page",
                                           sim::system::program_folder() / "page"};
  for (const fs::path& folder : folders) {
    if (fs::exists(folder / kPage) && fs::exists(folder / kServer)) return folder;
  }
  throw InputError({"servomill view"},
                   "the page of results was left out of this build (-D SERVOMILL_PAGE=ON adds it); "
                   "in the source tree tools/view builds and serves it");
}

// @throws InputError
std::string port_of(const Options& options) {
  constexpr int kMaxPort = 65535;
  const int port = options.get<int>("port");
  if (port >= 0 && port <= kMaxPort) return std::to_string(port);
  throw InputError({"--port"}, fmt::format("{}; must be >= 0 and <= {}", port, kMaxPort));
}

// Replaces this process. Python sees neither modules nor settings of the user.
[[noreturn]] void become(std::vector<std::string> command) {
  std::vector<char*> words;
  for (std::string& word : command) words.push_back(word.data());
  words.push_back(nullptr);
  std::fflush(stdout);
  ::execvp(words.front(), words.data());
  throw sim::system::SystemError(command.front(), "cannot be started", std::strerror(errno));
}

}  // namespace

int view_command(const Arguments& arguments) {
  Options options(
      "view", "OUT.h5... [--no-browser]",
      "Shows result files in the browser: signals, path, circles, comparison, sweeps, budgets,\n"
      "frequency responses. Press Ctrl-C to end. Only the page and these files are served, only\n"
      "to this computer (127.0.0.1), at an address that cannot be guessed; nothing is loaded from\n"
      "elsewhere. The page (servomill.html in share/servomill/page) also works by itself: open it\n"
      "and drop files on it.",
      "OUT.h5...");
  options.add()("no-browser", "prints the address instead of opening the browser");
  options.add()("port", po::value<int>()->default_value(0)->value_name("N"),
                "port of the address; 0: any free port");
  if (!options.parse(arguments)) return kDone;
  const std::vector<std::string> files = options.words();
  if (files.empty()) {
    throw InputError({"servomill view"}, "expected result files OUT.h5..., got none; see --help");
  }
  const fs::path folder = page_folder();
  std::vector<std::string> command = {
      "python3", "-I", "-B", (folder / kServer).string(), "--port", port_of(options)};
  if (options.has("no-browser")) command.emplace_back("--no-browser");
  command.emplace_back("--");
  command.push_back((folder / kPage).string());
  command.insert(command.end(), files.begin(), files.end());
  become(std::move(command));
}

}  // namespace servomill::tools
