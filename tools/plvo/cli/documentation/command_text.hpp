// SPDX-License-Identifier: Apache-2.0
// What the program's commands and options are called and mean, taken from their definitions: the one source
// of the man pages and of the shells' completion.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace plvo::cli {

struct OptionText {
  std::vector<std::string> names;  // "-h", "--help"; of a positional its name alone
  std::string type;                // "FILE", "points|lines|both"; empty for a flag
  std::string what;
  std::string group;  // heading in the help
  bool positional = false, required = false;

  // The values of a choice; empty where the type is none.
  std::vector<std::string> choices() const;
  bool takes_file() const;
  bool takes_folder() const;  // a folder alone
};

struct CommandText {
  std::string name, what, help;
  std::vector<OptionText> options;
};

CommandText describe(const CLI::App& command);
// Those that the help lists.
std::vector<CommandText> describe_commands(const CLI::App& app);

std::string bash_completion(const CLI::App& app);
std::string zsh_completion(const CLI::App& app);
std::string fish_completion(const CLI::App& app);

// In the language of man(7). command: its name; empty for the page of the program.
std::string man_page(const CLI::App& app, const std::string& command);

}  // namespace plvo::cli
