// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/documentation/command_text.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>

namespace plvo::cli {
namespace {

OptionText describe_option(const CLI::Option& option) {
  OptionText text;
  text.positional = option.get_positional();
  for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  if (text.positional) text.names = {option.get_name(true)};
  if (option.get_items_expected_max() > 0) text.type = option.get_type_name();
  text.what = option.get_description();
  text.group = option.get_group();
  text.required = option.get_required();
  return text;
}

}  // namespace

std::vector<std::string> OptionText::choices() const {
  // Values are written in small letters, what the user replaces by a value of his own in capitals.
  const bool values =
      !type.empty() && std::none_of(type.begin(), type.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
  return values ? CLI::detail::split(type, '|') : std::vector<std::string>();
}

bool OptionText::takes_file() const { return type.find("FILE") != std::string::npos; }
bool OptionText::takes_folder() const { return type == "DIR"; }

CommandText describe(const CLI::App& command) {
  CommandText text{command.get_name(), command.get_description(), command.get_footer(), {}};
  for (const CLI::Option* option : command.get_options()) text.options.push_back(describe_option(*option));
  return text;
}

std::vector<CommandText> describe_commands(const CLI::App& app) {
  std::vector<CommandText> commands;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    if (!command->get_group().empty()) commands.push_back(describe(*command));
  return commands;
}

}  // namespace plvo::cli
