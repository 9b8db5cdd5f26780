// SPDX-License-Identifier: Apache-2.0
// Tests names and texts from outside that would control a terminal, fake a row or end a page: they are shown
// escaped, and files are read back with the original names.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "plvo/host/printable.hpp"
#include "plvo_command.hpp"
#include "simulated_sequence.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::read_file;

constexpr int kNamedFrames = 4;
// ESC, a newline, CSI as C1 in UTF-8 and as a byte, and what HTML takes for the begin of a comment.
const std::string kHostile = "a\x1b[31mb\nlost 0\u009b32m\x9b<!--<script>";
const std::string kShown = "a\\x1b[31mb\\nlost 0\\u009b32m\\x9b<!--<script>";

std::string quoted(const std::string& word) { return '\'' + word + '\''; }

void expect_harmless(const std::string& text) { EXPECT_EQ(text, printable_lines(text)); }
void expect_one_line(const std::string& text) {
  expect_harmless(text);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
}

class CliHostileNames : public test::PlvoCommand {
 protected:
  CliHostileNames() : recording_((folder_ / kHostile).string()) {
    fs::copy(test::simulated_sequence<kNamedFrames>(), recording_, fs::copy_options::recursive);
  }
  static CommandResult plvo(const std::string& arguments) {
    const CommandResult r = PlvoCommand::plvo(arguments);
    expect_harmless(r.out);
    expect_harmless(r.err);
    return r;
  }
  const std::string recording_;
};

TEST_F(CliHostileNames, EscapesTheNameOfAFolder) {
  const CommandResult r =
      plvo("run " + quoted(recording_) + " --json " + path("json") + " --report " + path("page"));
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_EQ(r.out.rfind(kShown + '\n', 0), 0u) << r.out;
  // JSON cannot hold the byte that is not UTF-8.
  std::string name = kHostile;
  name.replace(name.find('\x9b', name.find("32m")), 1, "\uFFFD");
  EXPECT_EQ(nlohmann::json::parse(read_file(folder_ / "json"))["camera"], name);
  expect_harmless(read_file(folder_ / "json"));
  const std::string page = read_file(folder_ / "page");
  EXPECT_EQ(page.find("<!--<script>"), std::string::npos);
  EXPECT_EQ(page.find('\x1b'), std::string::npos);

  const CommandResult made =
      plvo("simulate --scene bare --size 96x64 --frames 1 --out " + quoted(path("new" + kHostile)));
  EXPECT_EQ(made.exit_code, 0) << made.err;
  expect_one_line(made.out);
  EXPECT_NE(made.out.find("new" + kShown), std::string::npos) << made.out;
}

TEST_F(CliHostileNames, APathThatIsNotThere) {
  const std::string nothing = quoted(path("no" + kHostile));
  for (const std::string& words :
       {"run " + nothing, "run " + nothing + "/x.bag", "eval --est x --gt " + nothing,
        "calibrate " + nothing + " --out " + path("c.yaml"),
        "run " + quoted(recording_) + " --calibration " + nothing,
        "run " + quoted(recording_) + " --out " + quoted(path("no" + kHostile) + "/t"),
        "live --device " + quoted(path("no" + kHostile) + ".bag"),
        "record " + quoted(recording_) + " --device " + quoted(path("no" + kHostile) + ".bag")}) {
    const CommandResult r = plvo(words);
    EXPECT_NE(r.exit_code, 0) << words;
    expect_one_line(r.err);
    EXPECT_NE(r.err.find("\\x1b[31m"), std::string::npos) << r.err;
  }
}

TEST_F(CliHostileNames, EscapesWordsOfTheCommandLine) {
  const std::string word = quoted(kHostile);
  for (const std::string& words : {word, "run --" + kHostile, "run --frames " + word, "run x y" + kHostile,
                                   "run " + word + " --camera-model " + word}) {
    const CommandResult r = plvo(words.find('\'') == std::string::npos ? quoted(words) : words);
    EXPECT_EQ(r.exit_code, 2) << words;
    expect_one_line(r.err);
    EXPECT_NE(r.err.find("\\x1b[31m"), std::string::npos) << r.err;
  }
  // A shortened quotation ends with a complete character.
  const CommandResult cut = plvo("run x --frames " + std::string(39, 'x') + "äöüäöüäöüäöüäöüäöüäöüäöüäöü");
  EXPECT_NE(cut.err.find("...'"), std::string::npos) << cut.err;
  EXPECT_EQ(cut.err.find("\\x"), std::string::npos) << cut.err;
}

TEST_F(CliHostileNames, EscapesKeysOfACalibration) {
  test::write_file(folder_ / "c.txt", "fx: 131\n" + std::string("k\x1b[31m\u009b: 3\n"));
  test::write_file(folder_ / "c.yaml", std::string("fx: 131\nmodel: \"\x1b[31m\"\n"));
  for (const char* file : {"c.txt", "c.yaml"}) {
    const CommandResult r = plvo("run " + quoted(recording_) + " --calibration " + path(file));
    EXPECT_EQ(r.exit_code, 1) << r.err;
    expect_one_line(r.err);
  }
}

TEST_F(CliHostileNames, EscapesFileNamesInTheStatistics) {
  const fs::path list = fs::path(recording_) / "rgb.txt",
                 image = fs::directory_iterator(list.parent_path() / "rgb")->path();
  std::string text = read_file(list);
  text.replace(text.find(image.filename().string()), image.filename().string().size(),
               "x\x1b[31m\u009b\x9b.png");
  test::write_file(list, text);
  test::write_file(image.parent_path() / "x\x1b[31m\u009b\x9b.png", "no image");
  const CommandResult r = plvo("run " + quoted(recording_) + " --quiet --stats -");
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_NE(r.out.find("rgb/x\\x1b[31m\\u009b\\x9b.png"), std::string::npos) << "the reason: " << r.out;
  EXPECT_EQ(std::count(r.out.begin(), r.out.end(), '\n'), 1 + kNamedFrames) << r.out;
  expect_one_line(r.err);
}

}  // namespace
}  // namespace plvo
