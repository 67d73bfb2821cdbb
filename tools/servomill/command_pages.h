/// The texts of --help in other forms: manual pages, and the completion of shells.
#pragma once

#include <boost/program_options.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace servomill::tools {

/// First arguments of a command that ask for another form of its help. They are not for users.
inline constexpr std::string_view kManualPage = "--manual-page";  // then the summary of the command
inline constexpr std::string_view kComplete = "--complete";  // then the words after the command

/// Texts of one command, as --help shows them.
struct CommandTexts {
  std::string command;      // "run"; empty: the program itself
  std::string synopsis;     // behind the name
  std::string description;  // paragraphs, between empty lines; indented lines stay as they are
  std::string words;        // what words stand for
  const boost::program_options::options_description& options;
};

/// A page for man, in roff: title, texts, exit status.
std::string manual_page(const CommandTexts& texts, std::string_view summary);

/// Candidates for the last of the words after a command, one a line: the word, a tab, what it is.
/// The line kFiles stands for names of files.
std::string candidates(const CommandTexts& texts, const std::vector<std::string>& line);
inline constexpr std::string_view kFiles = ":files";

/// One line of candidates.
std::string candidate(std::string_view word, std::string_view about);

/// Meaning of each exit status: "0 done, ...".
std::string exit_status_line();

}  // namespace servomill::tools
