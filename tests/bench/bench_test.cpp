// SPDX-License-Identifier: Apache-2.0
// Tests plvo_bench through the command line, with sequences of a few frames and plvo's own systems: the
// layout of its tables, the remaining work after an interruption, and the list of jobs.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "command.hpp"
#include "numbered_sequence.hpp"
#include "table_cells.hpp"
#include "temporary_folder.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::cells_of;
using test::CommandResult;
using test::read_file;
using test::run_command;
using test::TemporaryFolder;
using test::write_file;

const std::string kBench = PLVO_BENCH_BINARY;
constexpr int kFrames = 3;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::stringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> rows_with(const std::string& text, const std::string& what) {
  std::vector<std::string> rows;
  for (const std::string& line : lines_of(text))
    if (line.find(what) != std::string::npos) rows.push_back(line);
  return rows;
}

std::string lighting(const fs::path& out) {
  return kBench + " lighting --out " + out.string() +
         " --sites bare --seeds 1 --systems plvo-points,plvo-both --frames " + std::to_string(kFrames);
}

// Renders two sequences once for all tests.
class Bench : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    const auto listed = lines_of(run_command(lighting(out()) + " --list-jobs").out);
    ASSERT_EQ(listed.size(), 2U);
    // Run one of the two jobs separately, as another machine would, and the rest by the command itself.
    EXPECT_EQ(run_command(listed[1]).exit_code, 0);
    left_after_one_ = lines_of(run_command(lighting(out()) + " --list-jobs").out);
    EXPECT_EQ(left_after_one_, std::vector<std::string>{listed[0]});
    lighting_ = run_command(lighting(out()));
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static fs::path out() { return *folder_ / "lighting"; }
  static std::string rendered(const std::string& light) {
    return (out() / "sequences" / ("bare_" + light + "_1_" + std::to_string(kFrames) + "f")).string();
  }

  static std::unique_ptr<TemporaryFolder> folder_;
  static std::vector<std::string> left_after_one_;
  static CommandResult lighting_;
};
std::unique_ptr<TemporaryFolder> Bench::folder_;
std::vector<std::string> Bench::left_after_one_;
CommandResult Bench::lighting_;

TEST_F(Bench, LightingHasARowForEachSiteAndLight) {
  ASSERT_EQ(lighting_.exit_code, 0) << lighting_.err;
  // The finished sequence is not processed again.
  EXPECT_EQ(rows_with(lighting_.err, "[1/1] bare_constant").size(), 1U) << lighting_.err;
  const auto lines = lines_of(lighting_.out);
  ASSERT_GE(lines.size(), 7U);
  EXPECT_EQ(lines[0], "| site | light | path m | plvo-points | plvo-both |");
  EXPECT_EQ(lines[1], "|---|---|---:|---:|---:|");
  EXPECT_EQ(lines[2].rfind("| bare | constant | ", 0), 0U) << lines[2];
  EXPECT_EQ(lines[3].rfind("| bare | varying | ", 0), 0U) << lines[3];
  EXPECT_EQ(lines[4].rfind("| mean | constant | ", 0), 0U) << lines[4];
  EXPECT_EQ(lines[6].rfind("| mean | varying / constant | ", 0), 0U) << lines[6];
  EXPECT_EQ(lighting_.out, read_file(out() / "lighting.md"));
  EXPECT_EQ(lines_of(read_file(out() / "lighting.csv")).size(), 1U + 2 * 2);
  EXPECT_TRUE(run_command(lighting(out()) + " --list-jobs").out.empty());
}

// Rendering and measuring may be separate, and the images may be in any folder.
TEST_F(Bench, RendersWithoutMeasuring) {
  const fs::path results = *folder_ / "apart";
  const fs::path sequences = *folder_ / "elsewhere";
  const std::string command =
      kBench + " lighting --sites bare --seeds 1 --lights constant --frames 2 --out " + results.string() +
      " --sequences " + sequences.string() + " --systems plvo-points";
  const CommandResult rendered = run_command(command + " --render-only");
  ASSERT_EQ(rendered.exit_code, 0) << rendered.err;
  EXPECT_TRUE(rendered.out.empty()) << rendered.out;
  const fs::path images = sequences / "bare_constant_1_2f" / "rgb.txt";
  ASSERT_TRUE(fs::exists(images));
  const auto written = fs::last_write_time(images);
  EXPECT_TRUE(run_command(command + " --render-only --list-jobs").out.empty());
  EXPECT_EQ(run_command(command + " --render-only --discard-images").exit_code, 2);

  const CommandResult measured = run_command(command);
  ASSERT_EQ(measured.exit_code, 0) << measured.err;
  EXPECT_EQ(rows_with(measured.out, "| bare | constant |").size(), 2U) << measured.out;
  EXPECT_EQ(fs::last_write_time(images), written);
  EXPECT_FALSE(fs::exists(results / "sequences"));
}

TEST_F(Bench, ComparisonHasARowForEachSystemAndForIdentity) {
  const fs::path results = *folder_ / "run";
  const CommandResult run = run_command(kBench + " run " + rendered("constant") + ' ' + rendered("varying") +
                                        " --systems ours --repeats 2 --jobs 2 --out " + results.string());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(lines_of(run.out)[0].rfind("| sequence | system | mm/s |", 0), 0U);
  EXPECT_EQ(rows_with(run.out, "| zero motion |").size(), 2U);
  for (const char* system : {"plvo-points", "plvo-lines", "plvo-both"})
    EXPECT_EQ(rows_with(run.out, std::string("| ") + system + " |").size(), 2U) << run.out;
  const auto csv = lines_of(read_file(results / "comparison.csv"));
  ASSERT_EQ(csv.size(), 1U + 2 * 4);
  for (const std::string& line : csv)
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), std::count(csv[0].begin(), csv[0].end(), ','))
        << line;

  const json all = json::parse(read_file(results / "comparison.json"));
  ASSERT_EQ(all["results"].size(), 2U * 2 * 3);
  for (const json& result : all["results"]) {
    EXPECT_EQ(result["frames"], kFrames);
    EXPECT_GT(result["cpu_median_ms"], 0);
    EXPECT_GT(result["peak_mb"], result["growth_mb"]);
    EXPECT_TRUE(result["estimate"]["rpe_second_mm"].is_null())
        << "a tenth of a second has no pair a second apart";
    if (result["system"] == "plvo-points") {
      EXPECT_LT(result["estimate"]["rpe_frame_mm"], result["identity"]["rpe_frame_mm"]);
    }
  }
  EXPECT_FALSE(all["host"]["cpu"].get<std::string>().empty());
  EXPECT_NE(read_file(results / "comparison.html").find("<td class=\"t\">plvo-both</td>"), std::string::npos);
}

TEST_F(Bench, ResumesAfterAnInterruption) {
  const fs::path results = *folder_ / "resumed";
  const std::string command =
      kBench + " run " + rendered("constant") + " --systems ours --out " + results.string();
  const std::string list = command + " --list-jobs";
  EXPECT_EQ(lines_of(run_command(list).out).size(), 3U);
  ASSERT_EQ(run_command(command).exit_code, 0);
  EXPECT_TRUE(run_command(list).out.empty());

  // One result is missing, and one was truncated by a full disk.
  const auto job = [&](const std::string& system) {
    return results / "jobs" / (fs::path(rendered("constant")).filename().string() + '.' + system + ".0.json");
  };
  ASSERT_TRUE(fs::remove(job("plvo-lines")));
  write_file(job("plvo-both"), read_file(job("plvo-both")).substr(0, 100));
  const std::string kept = read_file(job("plvo-points"));
  const auto left = lines_of(run_command(list).out);
  ASSERT_EQ(left.size(), 2U);
  EXPECT_NE(left[0].find("plvo-lines"), std::string::npos);
  EXPECT_NE(left[1].find("plvo-both"), std::string::npos);
  EXPECT_EQ(run_command(left[0]).exit_code, 0);
  const CommandResult again = run_command(command);
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_EQ(rows_with(again.err, "[1/1]").size(), 1U) << again.err;
  EXPECT_EQ(read_file(job("plvo-points")), kept);

  // Other options require another measurement.
  EXPECT_EQ(lines_of(run_command(list + " --frames 2").out).size(), 3U);
}

TEST_F(Bench, Table2WeightsItsMeanByFrames) {
  const fs::path results = *folder_ / "tum";
  const CommandResult run = run_command(kBench + " tum " + rendered("constant") + ' ' + rendered("varying") +
                                        " --systems plvo-points --out " + results.string());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(rows_with(run.out, "| mean, weighted by frames |").size(), 2U) << run.out;
  EXPECT_EQ(rows_with(run.out, "| zero motion |").size(), 3U) << run.out;
  double sum = 0;  // the sequences have the same length
  const json all = json::parse(read_file(results / "table2.json"));
  for (const json& result : all["results"]) sum += result["estimate"]["rpe_frame_mm"].get<double>();
  const auto mean = rows_with(read_file(results / "table2.csv"), "\"mean, weighted by frames\",plvo-points,");
  ASSERT_EQ(mean.size(), 1U);
  const std::string rest =
      mean[0].substr(mean[0].find("plvo-points,6,") + std::string("plvo-points,6,").size());
  EXPECT_NEAR(std::stod(rest.substr(rest.find(',') + 1)), sum / 2, 1e-5);
}

TEST_F(Bench, CameraModelCanBeGivenForEachFolder) {
  const auto trajectory = [&](const std::string& model) {
    const fs::path results = *folder_ / ("camera" + model);
    const CommandResult run = run_command(kBench + " run " + rendered("constant") + model +
                                          " --systems plvo-points --out " + results.string());
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return read_file(results / "jobs" /
                     (fs::path(rendered("constant")).filename().string() + ".plvo-points.0.txt"));
  };
  EXPECT_NE(trajectory(""), trajectory("=tum-fr1"));
  const CommandResult unknown =
      run_command(kBench + " run " + rendered("constant") + "=tum-fr9 --out " + (*folder_ / "bad").string());
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_NE(unknown.err.find("tum-fr1"), std::string::npos) << unknown.err;
}

TEST_F(Bench, FoldersOfNumberedFramesHaveTheirOwnTruth) {
  const test::NumberedSequence sequence;
  ASSERT_TRUE(sequence.good());
  const fs::path results = *folder_ / "numbered";
  const CommandResult run =
      run_command(kBench + " run " + sequence.tum().string() + ' ' + sequence.seven_scenes().string() + ' ' +
                  sequence.scannet().string() + " --systems plvo-both --out " + results.string());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json all = json::parse(read_file(results / "comparison.json"));
  ASSERT_EQ(all["results"].size(), 3U);
  for (const json& result : all["results"])
    EXPECT_NEAR(result["estimate"]["rpe_frame_mm"].get<double>(),
                all["results"][0]["estimate"]["rpe_frame_mm"].get<double>(), 1e-4);
}

TEST_F(Bench, SequenceStatisticsUseTheTruePose) {
  const CommandResult table = run_command(std::string(PLVO_STATISTICS_BINARY) + ' ' + rendered("constant"));
  ASSERT_EQ(table.exit_code, 0) << table.err;
  const auto value = [](const std::string& row) { return std::stod(row.substr(row.find(" | ") + 3)); };
  const auto lines = lines_of(table.out);
  const auto warped = std::find_if(lines.begin(), lines.end(), [](const std::string& line) {
    return line.rfind("| warped by the true pose: grey levels, 90 %", 0) == 0;
  });
  ASSERT_LT(warped, lines.end() - 1) << table.out;
  EXPECT_LT(value(warped[0]), 0.7 * value(warped[1])) << table.out;
  const auto planes = rows_with(table.out, "at 2.5–3 m");  // the paper gives 22.1 mm, a ratio of 0.55
  ASSERT_EQ(planes.size(), 1U);
  EXPECT_NEAR(value(planes[0]), 12.2, 2) << table.out;
  EXPECT_EQ(run_command(std::string(PLVO_STATISTICS_BINARY) + " /no/such/folder").exit_code, 1);
  EXPECT_EQ(run_command(PLVO_STATISTICS_BINARY).exit_code, 2);
}

// The rows of instructions name functions of the core; a renamed function would be counted as 0.
TEST_F(Bench, StagesCountTimeAndInstructions) {
  const fs::path results = *folder_ / "stages";
  const CommandResult run =
      run_command(kBench + " stages " + rendered("constant") + " --instructions --out " + results.string());
  if (run.err.find("needs valgrind") != std::string::npos) GTEST_SKIP() << run.err;
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(read_file(results / "stages.md"), run.out);
  EXPECT_EQ(lines_of(run.out)[0], fs::path(rendered("constant")).filename().string() + ": 2 frames, 0 lost");
  for (const char* stage : {"image", "points", "lines", "matching", "motion"})
    EXPECT_GE(rows_with(run.out, std::string("| ") + stage + " | ").size(), 3U) << run.out;
  // In a slow sequence the images are aligned directly and the keyframe stays, so no descriptors are made or
  // matched; the test below uses other images.
  const auto zero_rows = rows_with(run.out, "| 0.00 | 0.0 |");
  EXPECT_EQ(zero_rows.size(), rows_with(run.out, "| by descriptor | 0.00 |").size() +
                                  rows_with(run.out, "| smooth | 0.00 |").size())
      << run.out;
  EXPECT_EQ(rows_with(run.out, "| 100.0 |").size(), 1U) << run.out;
  // No function of a row calls that of another: otherwise the rest would be negative.
  const auto rest = rows_with(run.out, "| rest |");
  ASSERT_EQ(rest.size(), 1U);
  EXPECT_LT(std::stod(cells_of(rest[0])[3]), 10) << run.out;
  EXPECT_EQ(run_command(kBench + " stages --image moon --out " + results.string()).exit_code, 2);
}

// The bounds of the page on the images that cost a detector most.
TEST_F(Bench, NoStageTakesMoreInstructionsThanThePageSays) {
  std::map<std::string, double> bounds;
  const std::string page = read_file(PLVO_PERFORMANCE_PAGE);
  for (const std::string& row : lines_of(page.substr(page.find("| | at most |")))) {
    const auto cells = cells_of(row);
    if (cells.size() == 2 && cells[1].find_first_not_of("0123456789") == std::string::npos)
      bounds[cells[0]] = std::stod(cells[1]);
  }
  ASSERT_EQ(bounds.size(), 6U);
  double by_descriptor = 0;
  for (const std::string image : {"own", "noise", "stripes", "checkerboard"}) {
    SCOPED_TRACE(image);
    const CommandResult run =
        run_command(kBench + " stages " + rendered("constant") + " --instructions --image " + image +
                    " --out " + (*folder_ / image).string());
    if (run.err.find("needs valgrind") != std::string::npos) GTEST_SKIP() << run.err;
    ASSERT_EQ(run.exit_code, 0) << run.err;
    std::map<std::string, double> sums;
    for (const std::string& row : lines_of(run.out.substr(run.out.find("| stage | step |")))) {
      const auto cells = cells_of(row);
      if (cells.size() == 4 && bounds.count(cells[0]) > 0) sums[cells[0]] += std::stod(cells[2]);
      if (cells.size() == 4 && cells[1] == "by descriptor") by_descriptor += std::stod(cells[2]);
    }
    EXPECT_EQ(sums.size(), bounds.size());
    for (const auto& [stage, sum] : sums) EXPECT_LE(sum, bounds[stage]) << stage;
  }
  EXPECT_GT(by_descriptor, 0);
}

TEST_F(Bench, UnwritableOutputIsAnError) {
  for (const std::string& words : {lighting(*folder_ / "listed") + " --list-jobs", kBench + " --help"}) {
    const CommandResult r = run_command("sh -c '" + words + " >/dev/full'");
    EXPECT_EQ(r.exit_code, 1) << r.err;
    EXPECT_NE(r.err.find("plvo_bench: error: cannot write standard output"), std::string::npos) << r.err;
  }
  // Results are written at once: they are complete or absent.
  const fs::path limited = *folder_ / "limited";
  const CommandResult r = run_command("prlimit --fsize=600 " + kBench + " run " + rendered("constant") +
                                      " --systems plvo-points --out " + limited.string());
  EXPECT_EQ(r.exit_code, 1) << r.err;
  EXPECT_NE(r.err.find("plvo_bench: error: "), std::string::npos) << r.err;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(limited))
    EXPECT_NE(entry.path().extension(), ".part") << entry.path();
}

TEST_F(Bench, NamesAreEscapedForTheTerminal) {
  const fs::path hostile = *folder_ / "sequence\x1b[31m\nx";
  fs::copy(rendered("constant"), hostile, fs::copy_options::recursive);
  const std::string run = kBench + " run '" + hostile.string() + "' --systems plvo-points --out ";
  const CommandResult table = run_command(run + (*folder_ / "hostile").string());
  EXPECT_EQ(table.exit_code, 0) << table.err;
  EXPECT_EQ(rows_with(table.out, "sequence\\x1b[31m\\nx | plvo-points").size(), 1U) << table.out;
  const CommandResult list = run_command(run + (*folder_ / "not_yet").string() + " --list-jobs");
  EXPECT_EQ(list.exit_code, 1);
  EXPECT_NE(list.err.find("rename it"), std::string::npos) << list.err;
  for (const std::string& said : {table.out, table.err, list.out, list.err})
    EXPECT_EQ(said.find('\x1b'), std::string::npos) << said;
}

TEST_F(Bench, RejectsBadInputWithAMessage) {
  const std::string out_option = " --out " + (*folder_ / "bad").string();
  const CommandResult system =
      run_command(kBench + " run " + rendered("constant") + " --systems slam" + out_option);
  EXPECT_EQ(system.exit_code, 1);
  EXPECT_NE(system.err.find("plvo-lines"), std::string::npos) << system.err;
  EXPECT_EQ(run_command(kBench + " run /no/such/folder" + out_option).exit_code, 1);
  EXPECT_EQ(run_command(kBench + " run " + rendered("constant")).exit_code, 2);
  EXPECT_EQ(run_command(kBench + " lighting --sites moon" + out_option).exit_code, 1);

  // The jobs of an unreadable sequence fail, and the table has the others.
  const fs::path broken = *folder_ / "broken";
  fs::create_directory(broken);
  const CommandResult run = run_command(kBench + " run " + broken.string() + ' ' + rendered("constant") +
                                        " --systems plvo-points" + out_option);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("1 of 2 jobs failed"), std::string::npos) << run.err;
  EXPECT_EQ(rows_with(run.out, "| plvo-points |").size(), 1U) << run.out;
}

}  // namespace
}  // namespace plvo
