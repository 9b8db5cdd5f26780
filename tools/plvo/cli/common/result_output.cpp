// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/common/result_output.hpp"

#include <nlohmann/json.hpp>

#include "plvo/cli/options/arguments.hpp"
#include "plvo/host/files/line_file.hpp"
#include "plvo/host/standard_streams.hpp"

namespace plvo::cli {

void add_json_option(CLI::App& command, std::string& file) {
  OptionGroup(command).path("--json", file, "The result as JSON; - prints it instead of the text");
}

Status write_json(const std::string& file, const nlohmann::ordered_json& json) {
  LineFile out;
  return out.open(file, json.dump(2, ' ', true, nlohmann::ordered_json::error_handler_t::replace));
}

Status write_result(const std::string& file, const nlohmann::ordered_json& json,
                    const std::function<std::string()>& page, bool aside) {
  const Status written = file.empty() ? Status() : write_json(file, json);
  if (is_standard_output(file)) return written;
  Status printed;
  if (aside) {
    print_to_stderr(page());
  } else {
    printed = print(page());
  }
  return written.ok() ? printed : written;
}

void tell_written(Log& log, const std::vector<std::string>& files) {
  std::string list;
  for (const std::string& file : files)
    if (!file.empty() && !is_standard_output(file)) list += (list.empty() ? "wrote " : ", ") + file;
  if (!list.empty()) log.write(LogLevel::kInfo, list);
}

}  // namespace plvo::cli
