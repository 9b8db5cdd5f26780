// SPDX-License-Identifier: Apache-2.0
// How `--help` looks: two columns that fit a terminal of 80.
#pragma once

#include <memory>

namespace CLI {
class FormatterBase;
}

namespace plvo::cli {

std::shared_ptr<CLI::FormatterBase> make_help_format();

}  // namespace plvo::cli
