// SPDX-License-Identifier: Apache-2.0
// Pages for man: plvo(1), plvo-run(1) and so on. CLI11 makes none. help2man reads what --help prints: it
// names the page of a subcommand PLVO(1), runs the exit codes together, and would have to run a cross-built
// program under emulation by scripts of its own. What stands here is made from the same descriptions as the
// completion.
#include <fmt/core.h>

#include <algorithm>

#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/documentation/command_text.hpp"

namespace plvo::cli {
namespace {

// Characters that troff takes for its own.
std::string escaped(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool line_begins = i == 0 || text[i - 1] == '\n';
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
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

std::string capitals(std::string text) {
  for (char& c : text) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return text;
}

std::string header(const std::string& name, const std::string& what) {
  return fmt::format(".TH \"{}\" 1 \"\" \"plvo {}\" \"plvo manual\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n",
                     capitals(name), PLVO_VERSION, escaped(name), escaped(what));
}

std::string option_entry(const OptionText& option) {
  std::string names;
  for (const std::string& name : option.names)
    names += (names.empty() ? "" : ", ") + ("\\fB" + escaped(name) + "\\fR");
  if (option.positional) names = "\\fI" + escaped(option.names.front()) + "\\fR";
  if (!option.type.empty()) names += " \\fI" + escaped(option.type) + "\\fR";
  return ".TP\n" + names + '\n' + escaped(option.what) + (option.required ? " (required)" : "") + '\n';
}

std::string options(const CommandText& command) {
  std::vector<std::string> groups;
  for (const OptionText& option : command.options)
    if (std::find(groups.begin(), groups.end(), option.group) == groups.end()) groups.push_back(option.group);
  std::string text = ".SH OPTIONS\n";
  for (const std::string& group : groups) {
    if (group != groups.front()) text += ".SS \"" + escaped(group) + "\"\n";
    for (const OptionText& option : command.options)
      if (option.group == group) text += option_entry(option);
  }
  return text;
}

// Examples and notes, as they stand.
std::string notes(std::string help) {
  const std::size_t codes = help.find(kExitCodeHelp);
  if (codes != std::string::npos) help.erase(codes);
  while (!help.empty() && help.back() == '\n') help.pop_back();
  return help.empty() ? "" : ".SH NOTES\n.nf\n" + escaped(help) + "\n.fi\n";
}

std::string exit_codes() {
  return std::string(".SH EXIT STATUS\n.nf\n") + escaped(kExitCodeHelp) + "\n.fi\n";
}

// What the Debian packages install. Another prefix than /usr has all but those in /etc and of systemd.
struct InstalledFile {
  const char *path, *what;
};
constexpr InstalledFile kProgramFiles[] = {
    {"/usr/share/doc/plvo/", "the pages that messages name; user/start.md is the first"},
    {"/usr/lib/udev/rules.d/60-plvo-rgbd.rules", "gives sensors on USB to the group video"},
    {"/usr/share/bash-completion/completions/plvo", "completion for bash; fish and zsh have their own"},
};
constexpr InstalledFile kLiveFiles[] = {
    {"/usr/lib/systemd/system/plvo-live.service", "the service: systemctl enable \\-\\-now plvo\\-live"},
    {"/etc/default/plvo-live", "its options"},
};

template <std::size_t N>
std::string installed_files(const InstalledFile (&files)[N]) {
  std::string text = ".SH FILES\nOf the package plvo\\-tools:\n";
  for (const InstalledFile& file : files)
    text += fmt::format(".TP\n\\fI{}\\fR\n{}\n", escaped(file.path), file.what);
  return text;
}

std::string program_page(const CLI::App& app) {
  const CommandText program = describe(app);
  std::string text =
      header("plvo", program.what) + ".B plvo\n\\fICOMMAND\\fR [\\fIOPTIONS\\fR]\n.SH COMMANDS\n";
  for (const CommandText& command : describe_commands(app))
    text += fmt::format(".TP\n\\fBplvo\\-{}\\fR(1)\n{}\n", command.name, escaped(command.what));
  return text + options(program) + exit_codes() + installed_files(kProgramFiles);
}

}  // namespace

std::string man_page(const CLI::App& app, const std::string& name) {
  if (name.empty()) return program_page(app);
  for (const CommandText& command : describe_commands(app)) {
    if (command.name != name) continue;
    std::string text = header("plvo-" + name, command.what) + ".B plvo " + name + "\n[\\fIOPTIONS\\fR]";
    for (const OptionText& option : command.options)
      if (option.positional)
        text += (option.required ? " \\fI" : " [\\fI") + escaped(option.names.front()) +
                (option.required ? "\\fR" : "\\fR]");
    return text + '\n' + options(command) + notes(command.help) + exit_codes() +
           (name == "live" ? installed_files(kLiveFiles) : "") + ".SH SEE ALSO\n\\fBplvo\\fR(1)\n";
  }
  return {};
}

}  // namespace plvo::cli
