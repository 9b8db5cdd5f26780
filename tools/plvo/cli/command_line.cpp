// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/command_line.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <new>
#include <sstream>

#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/common/subcommands.hpp"
#include "plvo/cli/common/version.hpp"
#include "plvo/cli/documentation/help_format.hpp"
#include "plvo/cli/options/usage_error.hpp"
#include "plvo/host/files/reader_limits.hpp"
#ifdef PLVO_HAVE_OPENNI2
#include "plvo/host/standard_streams.hpp"
#include "plvo/openni2/openni2_camera.hpp"
#endif

namespace plvo::cli {

int run_command_line(int argc, const char* const* argv) {
  ignore_broken_outputs();
#ifdef PLVO_HAVE_OPENNI2
  if (const std::optional<int> played = play_oni_if_asked(argc, argv)) return *played;
#endif
  CLI::App app("RGB-D odometry from points and lines: frames in, a trajectory with covariances out.", "plvo");
  app.formatter(make_help_format());
  app.set_help_flag("-h,--help", "Print this help");
  app.set_version_flag("--version", kVersionText, "Print the version, the commit and the build");
  app.footer(kExitCodeHelp);
  app.require_subcommand(1);

  int exit_code = kExitSuccess;
  add_run(app, exit_code);
  add_live(app, exit_code);
  add_record(app, exit_code);
  add_convert(app, exit_code);
  add_info(app, exit_code);
  add_map(app, exit_code);
  add_calibrate(app, exit_code);
  add_eval(app, exit_code);
  add_simulate(app, exit_code);
  add_doctor(app, exit_code);
  add_tilt(app, exit_code);
  add_documentation(app, exit_code);

  hold_standard_streams();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) {
      fail(usage_message(app, error, argc > 1 ? argv[1] : ""));
      return kExitUsage;
    }
    std::ostringstream help;  // help and version are "errors" that end well
    app.exit(error, help, help);
    const Status status = print(help.str());
    return status.ok() ? kExitSuccess : fail(status);
  } catch (const std::bad_alloc&) {
    return fail(
        fmt::format("there is not enough memory: what is read of a file takes up to {} MiB, and more is not "
                    "available (ulimit -v, share/doc/plvo/user/recordings.md#limits)",
                    kMostReaderBytes >> 20));
  } catch (const std::exception& error) {  // a library's
    return fail(error.what());
  }
  return exit_code;
}

}  // namespace plvo::cli
