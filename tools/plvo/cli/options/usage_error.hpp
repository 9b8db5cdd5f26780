// SPDX-License-Identifier: Apache-2.0
// What is wrong with a command line, in one line that says what would be right.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace plvo::cli {

// "run: --features: expected points, lines or both, not 'circles' (see plvo run --help)". first: the first
// word of the command line, or empty.
std::string usage_message(const CLI::App& app, const CLI::ParseError& error, const std::string& first);

// The candidate that `word` is a misspelling of, or empty.
std::string nearest(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace plvo::cli
