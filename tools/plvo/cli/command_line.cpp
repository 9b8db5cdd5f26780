// SPDX-License-Identifier: Apache-2.0
#include "plvo/cli/command_line.hpp"

#include <exception>

#include "plvo/cli/common/exit_code.hpp"
#include "plvo/cli/common/subcommands.hpp"
#ifdef PLVO_HAVE_OPENNI2
#include "plvo/openni2/openni2_camera.hpp"
#endif

namespace plvo::cli {

int run_command_line(int argc, const char* const* argv) {
#ifdef PLVO_HAVE_OPENNI2
  if (const std::optional<int> played = play_oni_if_asked(argc, argv)) return *played;
#endif
  CLI::App app("RGB-D odometry from points and lines: frames in, a trajectory with covariances out.", "plvo");
  app.set_version_flag("--version", "plvo " PLVO_VERSION);
  app.footer(kExitCodeHelp);
  app.require_subcommand(1);

  int exit_code = kExitSuccess;
  add_run(app, exit_code);
  add_live(app, exit_code);
  add_record(app, exit_code);
  add_eval(app, exit_code);
  add_simulate(app, exit_code);
  add_doctor(app, exit_code);
  add_tilt(app, exit_code);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitSuccess : kExitUsage;  // help and version are "errors" that end well
  } catch (const std::exception& error) {                     // out of memory, a library's exception
    return fail(error.what());
  }
  return exit_code;
}

}  // namespace plvo::cli
