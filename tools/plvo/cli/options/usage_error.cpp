// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/options/usage_error.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "plvo/cli/options/arguments.hpp"

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

// Returns the first of the unused words that looks like an option; empty if there is none.
std::string unknown_option(const CLI::App& command) {
  const std::vector<std::string> words = command.remaining();
  const auto option = std::find_if(words.begin(), words.end(), [](const std::string& word) {
    return word.size() > 1 && word[0] == '-' && word != "--";
  });
  if (option == words.end()) return {};
  const std::string name = option->substr(0, option->find('='));
  return fmt::format("there is no option {}{}", name, did_you_mean(name, option_names(command)));
}

// The words after "--" are left with the application.
std::string surplus_word(const CLI::App& app, const CLI::App& command) {
  std::vector<std::string> words = command.remaining();
  for (const std::string& word : app.remaining()) words.push_back(word);
  std::erase(words, "--");
  return fmt::format("'{}' is one word too many", words.empty() ? "" : words.front());
}

// "DIR|FILE.oni" in words.
std::string words_of_type(const std::string& type) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= type.size();) {
    const std::size_t end = std::min(type.find('|', begin), type.size());
    words.push_back(type.substr(begin, end - begin));
    begin = end + 1;
  }
  return any_of(words);
}

std::string wrong_count(const CLI::Option& option) {
  const std::string name = option.get_name();
  const int least = option.get_items_expected_min(), most = option.get_items_expected_max();
  const std::size_t given = option.results().size();
  if (given == 0)
    return fmt::format("{}: a value is missing: {}", name, words_of_type(option.get_type_name()));
  if (most == 1) return fmt::format("{}: may be given once, not {} times", name, given);
  return least == most ? fmt::format("{}: takes {} values, not {}", name, most, given)
                       : fmt::format("{}: takes {} to {} values, not {}", name, least, most, given);
}

// The library's own sentences begin with the option's name, and speak to programmers.
std::string own_words(const CLI::App& command, const CLI::ParseError& error) {
  const std::string text = error.what();
  const bool count = dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr;
  const auto begins_with = [&text](const std::string& name, const char* next) {
    return text.rfind(name + next, 0) == 0;
  };
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_name();
    for (const std::string& bare : option->get_lnames())
      if (begins_with(bare, " was given a disallowed flag override"))
        return fmt::format("{}: is a switch and takes no value", name);
    if (count && begins_with(name, ": ")) return wrong_count(*option);
  }
  return text;
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
  const bool missing = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
  // What is missing may only be misspelt.
  std::string wrong = surplus || missing ? unknown_option(command) : "";
  if (wrong.empty()) wrong = surplus ? surplus_word(app, command) : own_words(command, error);
  return fmt::format("{}: {} (see plvo {} --help)", command.get_name(), wrong, command.get_name());
}

}  // namespace plvo::cli
