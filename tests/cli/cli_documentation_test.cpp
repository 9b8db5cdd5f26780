// SPDX-License-Identifier: Apache-2.0
// Help, man pages and shell completion are made from the same definitions and must agree.
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "command.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

using test::CommandResult;
using test::run_command;
using test::TemporaryFolder;
using test::write_file;

const std::vector<std::string> kCommands = {"run",       "live", "record",   "convert", "info", "map",
                                            "calibrate", "eval", "simulate", "doctor",  "tilt"};

std::string printed(const std::string& arguments) {
  const CommandResult r = run_command(PLVO_BINARY " " + arguments);
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_EQ(r.err, "");
  return r.out;
}

// Returns the words at the start of the lines of a help page: "  --out FILE   …".
std::set<std::string> options_in_help(const std::string& command) {
  std::set<std::string> options;
  std::istringstream lines(printed(command + " --help"));
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("  --", 0) == 0) options.insert(line.substr(2, line.find_first_of(" \n", 3) - 2));
  }
  return options;
}

TEST(CliDocumentation, EveryOptionIsInEveryText) {
  const std::string bash = printed("completion bash"), zsh = printed("completion zsh"),
                    fish = printed("completion fish");
  for (const std::string& command : kCommands) {
    const std::set<std::string> options = options_in_help(command);
    EXPECT_GE(options.size(), command == "map" ? 1u : command == "tilt" ? 2u : 3u) << command;
    const std::string man = printed("man " + command);
    for (const std::string& option : options) {
      SCOPED_TRACE(command + ' ' + option);
      std::string name;
      for (char c : option) name += c == '-' ? "\\-" : std::string(1, c);
      EXPECT_NE(man.find("\\fB" + name + "\\fR"), std::string::npos);
      EXPECT_NE(bash.find(option), std::string::npos);
      EXPECT_NE(zsh.find('\'' + option + '['), std::string::npos);
      EXPECT_NE(fish.find("__fish_seen_subcommand_from " + command + "' -l " + option.substr(2) + ' '),
                std::string::npos);
    }
    EXPECT_NE(printed("man").find("plvo\\-" + command), std::string::npos);
  }
  EXPECT_EQ(run_command(PLVO_BINARY " completion csh").exit_code, 2);
  EXPECT_EQ(run_command(PLVO_BINARY " man fly").exit_code, 2);
  EXPECT_NE(printed("man").find("/usr/share/doc/plvo/"), std::string::npos) << "the installed files";
  EXPECT_NE(printed("man live").find("/etc/default/plvo\\-live"), std::string::npos);
}

TEST(CliDocumentation, HelpFitsATerminal) {
  for (const std::string& command : kCommands) {
    std::istringstream lines(printed(command + " --help"));
    for (std::string line; std::getline(lines, line);)
      EXPECT_LE(line.size(), 100u) << command << ": " << line;
  }
}

// Asks bash itself for completions, as the Tab key does.
class BashCompletion : public ::testing::Test {
 protected:
  BashCompletion() {
    write_file(folder_ / "plvo.bash", printed("completion bash"));
    write_file(folder_ / "sequence file.txt", "");
    std::filesystem::create_directory(folder_ / "sequences");
  }
  // Returns the completions offered for the last of these words.
  std::set<std::string> offered(const std::string& words) const {
    write_file(folder_ / "ask.sh", "cd " + folder_.path().string() + "\n. ./plvo.bash\nCOMP_WORDS=(plvo " +
                                       words +
                                       ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_plvo\nprintf '%s\\n' "
                                       "\"${COMPREPLY[@]}\"\n");
    const CommandResult r = run_command("bash " + (folder_ / "ask.sh").string());
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_EQ(r.err, "") << r.err;
    std::set<std::string> result;
    std::istringstream lines(r.out);
    for (std::string line; std::getline(lines, line);)
      if (!line.empty()) result.insert(line);
    return result;
  }
  TemporaryFolder folder_;
};

TEST_F(BashCompletion, OffersCommandsOptionsValuesAndFiles) {
  using Words = std::set<std::string>;
  EXPECT_EQ(offered("re"), Words{"record"});
  EXPECT_EQ(offered("s"), Words{"simulate"});
  EXPECT_EQ(offered("run --feat"), Words{"--features"});
  EXPECT_EQ(offered("run --features ''"), (Words{"points", "lines", "both"}));
  EXPECT_EQ(offered("run --camera-model tum-"), (Words{"tum-fr1", "tum-fr2", "tum-fr3"}));
  EXPECT_EQ(offered("tilt --led blink-g"), Words{"blink-green"});
  EXPECT_EQ(offered("run --out seq"), (Words{"sequence file.txt", "sequences"}));
  EXPECT_EQ(offered("run --overlay seq"), Words{"sequences"});
  EXPECT_EQ(offered("run --fx ''"), Words{});
  EXPECT_EQ(offered("run seq"), (Words{"sequence file.txt", "sequences"}));
}

// The other shells only check the syntax of their scripts.
TEST(CliDocumentation, ZshAndFishUnderstandTheirScripts) {
  const TemporaryFolder folder;
  bool any = false;
  for (const auto& [shell, check] : {std::pair("zsh", "zsh -n"), std::pair("fish", "fish --no-execute")}) {
    if (run_command(std::string("command -v ") + shell).exit_code != 0) continue;
    any = true;
    write_file(folder / shell, printed(std::string("completion ") + shell));
    const CommandResult r = run_command(std::string(check) + ' ' + (folder / shell).string());
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_EQ(r.err, "");
  }
  if (!any) GTEST_SKIP() << "neither zsh nor fish is installed";
}

TEST(CliDocumentation, ManPagesAreFaultlessTroff) {
  if (run_command("command -v groff").exit_code != 0) GTEST_SKIP() << "groff is not installed";
  const TemporaryFolder folder;
  for (const std::string& command : kCommands) {
    write_file(folder / "page.1", printed("man " + command));
    const CommandResult r = run_command("groff -man -Tutf8 -ww -z " + (folder / "page.1").string());
    EXPECT_EQ(r.exit_code, 0);
    EXPECT_EQ(r.err, "") << command;
  }
}

}  // namespace
}  // namespace plvo
