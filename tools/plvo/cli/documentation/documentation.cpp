// SPDX-License-Identifier: Apache-2.0
// plvo completion and plvo man: what an installation puts beside the program. The help does not list them.
#include <CLI/CLI.hpp>
#include <memory>

#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/common/subcommands.hpp"
#include "plvo/cli/documentation/command_text.hpp"
#include "plvo/cli/options/arguments.hpp"
#include "plvo/host/standard_streams.hpp"

namespace plvo::cli {
namespace {

int print_or_fail(const std::string& text) {
  const Status status = print(text);
  return status.ok() ? kExitSuccess : fail(status);
}

}  // namespace

void add_documentation(CLI::App& app, int& exit_code) {
  using Script = std::string (*)(const CLI::App&);
  auto script = std::make_shared<Script>(nullptr);
  CLI::App& completion = add_command(app, "completion", "Print the completion script of a shell");
  completion.group("");
  require(OptionGroup(completion)
              .choice("shell", *script,
                      Choices<Script>{
                          {"bash", bash_completion}, {"zsh", zsh_completion}, {"fish", fish_completion}},
                      "Which shell"));
  on_command(completion, exit_code, [&app, script] { return print_or_fail((*script)(app)); });

  Choices<std::string> names;
  for (const CommandText& command : describe_commands(app)) names.emplace_back(command.name, command.name);
  auto name = std::make_shared<std::string>();
  CLI::App& man = add_command(app, "man", "Print a manual page");
  man.group("");
  OptionGroup(man).choice("command", *name, names, "The command to document; without it, the program");
  on_command(man, exit_code, [&app, name] { return print_or_fail(man_page(app, *name)); });
}

}  // namespace plvo::cli
