// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/common/usage_error.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "plvo/cli/common/arguments.hpp"

namespace plvo::cli {
namespace {

// Levenshtein's distance: letters to insert, delete or replace.
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, replaced}));
    }
  }
  return row.back();
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates) {
  const std::string meant = nearest(word, candidates);
  return meant.empty() ? "" : fmt::format("; did you mean {}?", meant);
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    if (!command->get_group().empty()) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::string unknown_word(const CLI::App& command) {
  const std::vector<std::string> words = command.remaining();
  const auto option = std::find_if(words.begin(), words.end(),
                                   [](const std::string& word) { return word.size() > 1 && word[0] == '-'; });
  if (option != words.end()) {
    const std::string name = option->substr(0, option->find('='));
    return fmt::format("there is no option {}{}", name, did_you_mean(name, option_names(command)));
  }
  return fmt::format("'{}' is one word too many", words.empty() ? "" : words.front());
}

std::string no_command(const CLI::App& app, const std::string& first) {
  const std::vector<std::string> names = command_names(app);
  if (first.empty()) return "a command is needed: " + any_of(names);
  if (first[0] == '-') return fmt::format("there is no option {}", first);
  const std::string meant = did_you_mean(first, names);
  return fmt::format("there is no command '{}'{}", first,
                     meant.empty() ? "; choose " + any_of(names) : meant);
}

}  // namespace

std::string nearest(const std::string& word, const std::vector<std::string>& candidates) {
  constexpr std::size_t kLongest = 64;
  std::string best;
  if (word.size() > kLongest) return best;
  std::size_t fewest = std::min<std::size_t>(2, word.size() / 3) + 1;  // one letter in three, two at most
  for (const std::string& candidate : candidates) {
    const std::size_t letters = distance(word, candidate);
    if (letters >= fewest) continue;
    fewest = letters;
    best = candidate;
  }
  return best;
}

std::string usage_message(const CLI::App& app, const CLI::ParseError& error, const std::string& first) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  if (chosen.empty()) return no_command(app, first) + " (see plvo --help)";
  const CLI::App& command = *chosen.front();
  const bool surplus = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  return fmt::format("{}: {} (see plvo {} --help)", command.get_name(),
                     surplus ? unknown_word(command) : error.what(), command.get_name());
}

}  // namespace plvo::cli
