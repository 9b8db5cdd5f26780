// SPDX-License-Identifier: Apache-2.0
// `--json FILE` of the commands whose result is one page: the page goes to standard output, the JSON into
// FILE; with - the JSON is printed instead of the page.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "plvo/base/status.hpp"
#include "plvo/cli/options/arguments.hpp"
#include "plvo/hal/log.hpp"

namespace plvo::cli {

void add_json_option(CLI::App& command, std::string& file);

// Escapes all that is not ASCII: a reader gets the text back as it was, and no terminal obeys it. Bytes that
// are not UTF-8 become U+FFFD. kIo as LineFile.
Status write_json(const std::string& file, const nlohmann::ordered_json& json);

// page: called where it is printed. aside: on standard error, for another output has standard output. Where
// one of the two cannot be written, the other still is.
Status write_result(const std::string& file, const nlohmann::ordered_json& json,
                    const std::function<std::string()>& page, bool aside = false);

// Names the files that a command wrote, in one line; standard output and options that were not given ("") are
// left out. Nothing is said where no file is left.
void tell_written(Log& log, const std::vector<std::string>& files);

}  // namespace plvo::cli
