// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/common/result_output.hpp"

#include <nlohmann/json.hpp>

#include "plvo/cli/common/standard_streams.hpp"
#include "plvo/cli/options/arguments.hpp"
#include "plvo/host/files/line_file.hpp"

namespace plvo::cli {

void add_json_option(CLI::App& command, std::string& file) {
  OptionGroup(command).path("--json", file, "The result as JSON; - prints it instead of the text");
}

Status write_result(const std::string& file, const nlohmann::ordered_json& json,
                    const std::function<std::string()>& page) {
  if (!file.empty()) {
    LineFile out;
    if (Status status = out.open(file, json.dump(2)); !status.ok()) return status;
  }
  return is_standard_output(file) ? Status() : print(page());
}

}  // namespace plvo::cli
