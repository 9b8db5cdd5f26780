// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/documentation/help_format.hpp"

#include <CLI/CLI.hpp>
#include <sstream>

namespace plvo::cli {
namespace {

constexpr std::size_t kLeft = 30;       // columns of names
constexpr std::size_t kHelpWidth = 80;  // columns of a line

class HelpFormat final : public CLI::Formatter {
 public:
  HelpFormat() { column_width(kLeft); }

  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    std::string text = CLI::Formatter::make_help(app, std::move(name), mode);
    for (std::size_t at = 0; (at = text.find("\n\n\n", at)) != std::string::npos;) text.erase(at, 1);
    return text;
  }

  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    std::string line = "  " + make_option_name(option, is_positional) + make_option_opts(option);
    if (line.size() + 2 > kLeft) {
      line += '\n';
      line.append(kLeft, ' ');
    } else {
      line.resize(kLeft, ' ');
    }
    std::size_t column = kLeft;
    std::istringstream words(make_option_desc(option));
    for (std::string word; words >> word;) {
      if (column > kLeft && column + 1 + word.size() > kHelpWidth) {
        line += '\n';
        line.append(kLeft, ' ');
        column = kLeft;
      }
      if (column > kLeft) line += ' ';
      line += word;
      column += word.size() + 1;
    }
    return line + '\n';
  }

  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text;
    if (option->get_items_expected_max() > 0) text += ' ' + option->get_type_name();
    if (option->get_items_expected_max() > 1 && option->get_allow_extra_args()) text += " ...";
    return option->get_required() ? text + " (required)" : text;
  }
};

}  // namespace

std::shared_ptr<CLI::FormatterBase> make_help_format() { return std::make_shared<HelpFormat>(); }

}  // namespace plvo::cli
