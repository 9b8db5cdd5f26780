// SPDX-License-Identifier: Apache-2.0
// Completion for bash, zsh and fish.
#include <fmt/core.h>

#include "plvo/cli/documentation/command_text.hpp"

namespace plvo::cli {
namespace {

std::string joined(const std::vector<std::string>& words, const char* between = " ") {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

std::string option_words(const CommandText& command) {
  std::vector<std::string> words;
  for (const OptionText& option : command.options)
    if (!option.positional) words.insert(words.end(), option.names.begin(), option.names.end());
  return joined(words);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

// Inside single quotes of a Bourne shell.
std::string shell_quoted(const std::string& text) { return '\'' + replaced(text, "'", "'\\''") + '\''; }

// What bash does after an option.
std::string bash_values(const OptionText& option) {
  const char* files =
      "compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen {} -- \"$current\")";
  if (const auto choices = option.choices(); !choices.empty())
    return fmt::format("mapfile -t COMPREPLY < <(compgen -W '{}' -- \"$current\")", joined(choices));
  if (option.takes_folder()) return fmt::format(fmt::runtime(files), "-d");
  if (option.takes_file()) return fmt::format(fmt::runtime(files), "-f");
  return ":";  // a number, an address: nobody can guess it
}

// The last part of a specification of zsh's _arguments: "message:action".
std::string zsh_values(const OptionText& option) {
  const std::string name = replaced(option.type, ":", "\\:");
  if (const auto choices = option.choices(); !choices.empty()) return ":value:(" + joined(choices) + ')';
  if (option.takes_folder()) return ':' + name + ":_files -/";
  if (option.takes_file()) return ':' + name + ":_files";
  return option.type.empty() ? "" : ':' + name + ": ";
}

std::string zsh_option(const OptionText& option, const std::string& name) {
  std::string what = replaced(replaced(option.what, "[", "\\["), "]", "\\]");
  return shell_quoted(name + '[' + replaced(what, ":", "\\:") + ']' + zsh_values(option));
}

std::string fish_option(const OptionText& option, const std::string& condition) {
  std::string line = "complete -c plvo -n " + shell_quoted(condition);
  for (const std::string& name : option.names)
    line += name.rfind("--", 0) == 0 ? " -l " + name.substr(2) : " -s " + name.substr(1);
  line += " -d \"" + replaced(replaced(option.what, "\\", "\\\\"), "\"", "\\\"") + '"';
  if (const auto choices = option.choices(); !choices.empty())
    return line + " -x -a '" + joined(choices) + "'\n";
  if (option.takes_folder()) return line + " -x -a '(__fish_complete_directories)'\n";
  if (option.takes_file()) return line + " -r -F\n";
  return line + (option.type.empty() ? "\n" : " -x\n");
}

}  // namespace

std::string bash_completion(const CLI::App& app) {
  const std::vector<CommandText> commands = describe_commands(app);
  std::vector<std::string> names;
  for (const CommandText& command : commands) names.push_back(command.name);
  std::string text = fmt::format(
      R"(# bash completion for plvo; made by: plvo completion bash
_plvo() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}} command= words= i
  for ((i = 1; i < COMP_CWORD; i++)); do
    case ${{COMP_WORDS[i]}} in
      {}) command=${{COMP_WORDS[i]}}; break ;;
    esac
  done
  COMPREPLY=()
  case "$command $previous" in
)",
      joined(names, "|"));
  for (const CommandText& command : commands)
    for (const OptionText& option : command.options)
      if (!option.positional && !option.type.empty())
        text += fmt::format("    '{} {}') {}; return ;;\n", command.name, option.names.back(),
                            bash_values(option));
  text += fmt::format("  esac\n  case $command in\n    '') words='{} {}' ;;\n", joined(names),
                      option_words(describe(app)));
  for (const CommandText& command : commands)
    text += fmt::format("    {}) words='{}' ;;\n", command.name, option_words(command));
  return text + R"(  esac
  if [[ -z $command || $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  else
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
  fi
}
complete -F _plvo plvo
)";
}

std::string zsh_completion(const CLI::App& app) {
  std::string text =
      "#compdef plvo\n# zsh completion for plvo; made by: plvo completion zsh\n_plvo() {\n  local -a "
      "commands=(\n";
  const std::vector<CommandText> commands = describe_commands(app);
  for (const CommandText& command : commands)
    text += "    " + shell_quoted(command.name + ':' + command.what) + '\n';
  text += "  )\n  if (( CURRENT == 2 )); then\n    _describe command commands\n    _arguments";
  for (const OptionText& option : describe(app).options)
    for (const std::string& name : option.names) text += ' ' + zsh_option(option, name);
  text +=
      "\n    return\n  fi\n  local command=$words[2]\n  shift words\n  (( CURRENT-- ))\n  case $command in\n";
  for (const CommandText& command : commands) {
    text += "    " + command.name + ") _arguments";
    for (const OptionText& option : command.options)
      for (const std::string& name : option.names)
        text += " \\\n      " +
                (option.positional ? shell_quoted("*" + zsh_values(option)) : zsh_option(option, name));
    text += " ;;\n";
  }
  return text + "  esac\n}\n_plvo \"$@\"\n";
}

std::string fish_completion(const CLI::App& app) {
  std::string text =
      "# fish completion for plvo; made by: plvo completion fish\ncomplete -c plvo -n __fish_use_subcommand "
      "-f\n";
  const std::vector<CommandText> commands = describe_commands(app);
  for (const CommandText& command : commands)
    text += fmt::format("complete -c plvo -n __fish_use_subcommand -a {} -d {}\n", command.name,
                        '"' + replaced(command.what, "\"", "\\\"") + '"');
  for (const OptionText& option : describe(app).options) text += fish_option(option, "__fish_use_subcommand");
  for (const CommandText& command : commands)
    for (const OptionText& option : command.options)
      if (!option.positional) text += fish_option(option, "__fish_seen_subcommand_from " + command.name);
  return text;
}

}  // namespace plvo::cli
