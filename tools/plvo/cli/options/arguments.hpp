// SPDX-License-Identifier: Apache-2.0
// Options of a command, and how their values are read: strictly, within stated limits, and with a message
// that names what is allowed. The type of a choice lists its values ("points|lines|both"); help, man pages
// and shell completion are made from it.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

// The library behind this: its header is long, and few files here need it.
namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace plvo::cli {

struct NumberRange {
  double min = 0, max = 0;
  bool min_excluded = false;
};
constexpr NumberRange positive(double max) { return {0, max, true}; }

// "one, two or three", for messages.
std::string any_of(const std::vector<std::string>& words);

// "one|two|three", the type of a choice.
std::string type_of(const std::vector<std::string>& words);

// Each reads the whole text or says what was expected instead; empty: it was read.
std::string read_number(const std::string& text, const NumberRange& range, double& value);
std::string read_whole(const std::string& text, std::uint64_t min, std::uint64_t max, std::uint64_t& value);
std::string expected(std::string_view what, std::string_view text);  // "expected …, not '…'"

// A command of the program. help: examples and notes below the options; the exit codes follow
// it by themselves.
CLI::App& add_command(CLI::App& app, const std::string& name, const std::string& what,
                      const std::string& help = "");
// What the command does once its words were read: work() returns the exit code.
void on_command(CLI::App& command, int& exit_code, std::function<int()> work);

template <typename Value>
using Choices = std::vector<std::pair<std::string, Value>>;

class OptionGroup {
 public:
  // Reads one value: empty, or what is wrong with it.
  using Reader = std::function<std::string(const std::string& text)>;

  // name: the heading in the help; "Options" is CLI11's own first group.
  explicit OptionGroup(CLI::App& command, std::string name = "Options")
      : command_(command), name_(std::move(name)) {}

  CLI::Option* add(const std::string& option, const std::string& type, const std::string& what, Reader read);

  // A path: of a file, or as `type` says. The empty word is refused, for it is mostly an unset variable.
  CLI::Option* path(const std::string& option, std::string& value, const std::string& what,
                    const std::string& type = "FILE");
  CLI::Option* flag(const std::string& option, bool& value, const std::string& what);

  // Number: double or std::optional<double>.
  template <typename Number>
  CLI::Option* number(const std::string& option, Number& value, NumberRange range, const std::string& unit,
                      const std::string& what) {
    return add(option, unit, what, [&value, range](const std::string& text) {
      double number = 0;
      std::string wrong = read_number(text, range, number);
      if (wrong.empty()) value = number;
      return wrong;
    });
  }

  // Whole: an unsigned or positive integer, or an optional one.
  template <typename Whole>
  CLI::Option* whole(const std::string& option, Whole& value, std::uint64_t min, std::uint64_t max,
                     const std::string& what) {
    return add(option, "NUMBER", what, [&value, min, max](const std::string& text) {
      std::uint64_t number = 0;
      std::string wrong = read_whole(text, min, max, number);
      if constexpr (std::is_integral_v<Whole>) {
        if (wrong.empty()) value = static_cast<Whole>(number);
      } else if (wrong.empty()) {
        value = number;
      }
      return wrong;
    });
  }

  template <typename Value, typename Choice>
  CLI::Option* choice(const std::string& option, Value& value, const Choices<Choice>& choices,
                      const std::string& what) {
    std::vector<std::string> names;
    for (const auto& [name, meaning] : choices) names.push_back(name);
    return add(option, type_of(names), what,
               [&value, choices, names](const std::string& text) -> std::string {
                 for (const auto& [name, meaning] : choices)
                   if (text == name) {
                     value = meaning;
                     return {};
                   }
                 return expected(any_of(names), text);
               });
  }

 private:
  CLI::App& command_;
  std::string name_;
};

void require(CLI::Option* option);
void repeatable(CLI::Option* option);                         // once for each value
void takes_values(CLI::Option* option, int least, int most);  // after one another
void takes_words(CLI::Option* words, int most);  // of an option without a name: one or more, anywhere

// Wrong usage that no single value shows: ends the command with exit code 2. option: the one to blame.
[[noreturn]] void refuse(const std::string& option, const std::string& why);
[[noreturn]] void refuse_command(const std::string& why);
// The same for options that were given and do not apply: by name, or a whole group of the help.
void refuse_options(const CLI::App& command, std::initializer_list<const char*> options,
                    const std::string& why);
void refuse_group(const CLI::App& command, const std::string& group, const std::string& why);
// False for an option that the command does not have, too.
bool given(const CLI::App& command, const char* option);

}  // namespace plvo::cli
