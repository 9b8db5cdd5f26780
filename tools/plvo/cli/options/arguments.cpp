// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/options/arguments.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>

#include "plvo/cli/common/exit_code.hpp"
#include "plvo/host/number_text.hpp"

namespace plvo::cli {
namespace {

constexpr std::size_t kLongestQuote = 80;

std::string words_of(const NumberRange& range) {
  return range.min_excluded ? fmt::format("a number above {} and up to {}", range.min, range.max)
                            : fmt::format("a number from {} to {}", range.min, range.max);
}

// A plus sign is allowed.
template <typename Number>
bool parse(std::string_view text, Number& value) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  return parse_whole_text(text, value);
}

}  // namespace

std::string any_of(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 < words.size() ? ", " : " or ";
    text += words[i];
  }
  return text;
}

std::string type_of(const std::vector<std::string>& words) { return CLI::detail::join(words, "|"); }

std::string expected(std::string_view what, std::string_view text) {
  std::string_view quote = text.substr(0, kLongestQuote);
  // Not within a character of UTF-8.
  while (quote.size() < text.size() && (static_cast<unsigned char>(text[quote.size()]) & 0xc0U) == 0x80U &&
         !quote.empty())
    quote.remove_suffix(1);
  return fmt::format("expected {}, not '{}{}'", what, quote, quote.size() < text.size() ? "..." : "");
}

std::string read_number(const std::string& text, const NumberRange& range, double& value) {
  double number = 0;
  // The comparison also refuses what is not a number.
  const bool inside = parse(text, number) && number <= range.max &&
                      (range.min_excluded ? number > range.min : number >= range.min);
  if (!inside) return expected(words_of(range), text);
  value = number;
  return {};
}

std::string read_whole(const std::string& text, std::uint64_t min, std::uint64_t max, std::uint64_t& value) {
  std::uint64_t number = 0;
  if (!parse(text, number) || number < min || number > max)
    return expected(fmt::format("a whole number from {} to {}", min, max), text);
  value = number;
  return {};
}

CLI::App& add_command(CLI::App& app, const std::string& name, const std::string& what,
                      const std::string& help) {
  CLI::App* command = app.add_subcommand(name, what);
  command->footer(help + (help.empty() ? "" : "\n") + kExitCodeHelp);
  return *command;
}

void on_command(CLI::App& command, int& exit_code, std::function<int()> work) {
  command.callback([&exit_code, work = std::move(work)] { exit_code = work(); });
}

CLI::Option* OptionGroup::add(const std::string& option, const std::string& type, const std::string& what,
                              Reader read) {
  CLI::callback_t read_all = [option, read = std::move(read)](const CLI::results_t& texts) {
    for (const std::string& text : texts)
      if (const std::string wrong = read(text); !wrong.empty()) throw CLI::ValidationError(option, wrong);
    return true;
  };
  return command_.add_option(option, std::move(read_all), what)->type_name(type)->group(name_);
}

CLI::Option* OptionGroup::path(const std::string& option, std::string& value, const std::string& what,
                               const std::string& type) {
  return add(option, type, what, [&value](const std::string& text) -> std::string {
    value = text;
    return text.empty() ? "expected a path, not an empty word" : "";
  });
}

CLI::Option* OptionGroup::flag(const std::string& option, bool& value, const std::string& what) {
  return command_.add_flag(option, value, what)->disable_flag_override()->group(name_);
}

void require(CLI::Option* option) { option->required(); }
void repeatable(CLI::Option* option) {
  option->expected(1, CLI::detail::expected_max_vector_size)->allow_extra_args(false);
}
void takes_values(CLI::Option* option, int least, int most) { option->expected(least, most); }
void takes_words(CLI::Option* words, int most) { words->expected(1, most)->allow_extra_args(); }

void refuse_command(const std::string& why) { throw CLI::RequiredError(why, CLI::ExitCodes::RequiredError); }

void refuse(const std::string& option, const std::string& why) { throw CLI::ValidationError(option, why); }

void refuse_options(const CLI::App& command, std::initializer_list<const char*> options,
                    const std::string& why) {
  for (const char* option : options)
    if (given(command, option)) refuse(option, why);
}

void refuse_group(const CLI::App& command, const std::string& group, const std::string& why) {
  for (const CLI::Option* option : command.get_options())
    if (option->get_group() == group && option->count() > 0) refuse(option->get_name(), why);
}

bool given(const CLI::App& command, const char* option) {
  const CLI::Option* found = command.get_option_no_throw(option);
  return found != nullptr && found->count() > 0;
}

}  // namespace plvo::cli
