// SPDX-License-Identifier: Apache-2.0
// plvo_bench detectors: compares our segments and keypoints with those of OpenCV's detectors. See
// docs/results/README.md.
#include <fmt/core.h>

#include <memory>

#include "plvo/bench/commands.hpp"
#include "plvo/bench/detectors/compare.hpp"
#include "plvo/bench/jobs/campaign.hpp"
#include "plvo/bench/jobs/result.hpp"
#include "plvo/bench/sequences/named_folder.hpp"
#include "plvo/bench/table.hpp"
#include "plvo/host/standard_streams.hpp"

namespace plvo::bench {
namespace {

struct DetectorsArguments {
  std::filesystem::path out;
  std::vector<std::string> scenes = {"corridor", "staircase", "hall", "desk", "bare"};
  std::vector<std::string> folders;
  JobOptions measuring;
  DetectorCapacity capacity;
  ScoreOptions score;
};

void add_rows(const std::string& sequence, const std::vector<NamedScore>& scores, std::size_t views,
              bool segments, Table& table) {
  for (const NamedScore& named : scores) {
    const Score& score = named.score;
    std::vector<std::string> row = {sequence,
                                    named.detector,
                                    cell(static_cast<double>(score.features) / static_cast<double>(views), 0),
                                    cell(score.again.percent(), 1),
                                    cell(score.again_aside.percent(), 1),
                                    cell(median(score.again_px), 2)};
    if (segments)
      row.insert(row.end(), {cell(score.recall.percent(), 1), cell(median(score.recall_px), 2),
                             cell(score.precision.percent(), 1), cell(score.precision_aside.percent(), 1)});
    row.push_back(cell(time_ratio(score, scores.front().score), 2));
    table.rows.push_back(row);
  }
}

// Holds the views of one sequence at a time: the images of all sequences would need much memory.
Status compare_one(ViewSequence& sequence, const DetectorsArguments& arguments, Table& segments,
                   Table& points) {
  if (sequence.views.size() <= arguments.score.gap)
    return {StatusCode::kTooFewFeatures,
            fmt::format("{}: only {} frames with a true pose, --gap is {}", sequence.name,
                        sequence.views.size(), arguments.score.gap)};
  DetectorCapacity capacity = arguments.capacity;
  capacity.width = sequence.views.front().width;
  capacity.height = sequence.views.front().height;
  const DetectorComparison comparison = compare_detectors(sequence, capacity, arguments.score);
  add_rows(sequence.name, comparison.segments, sequence.views.size(), true, segments);
  add_rows(sequence.name, comparison.points, sequence.views.size(), false, points);
  print_to_stderr(fmt::format("{}: {} views\n", sequence.name, sequence.views.size()));
  return {};
}

Status run_detectors(const DetectorsArguments& arguments) {
  std::vector<SceneName> scenes;
  for (const std::string& name : arguments.scenes) {
    scenes.emplace_back();
    if (Status status = parse_scene(name, scenes.back()); !status.ok()) return status;
  }
  std::vector<NamedFolder> folders;
  if (Status status = name_folders(arguments.folders, folders); !status.ok()) return status;
  if (Status status = make_out(arguments.out); !status.ok()) return status;
  Table segments, points;
  segments.header = {"sequence", "segments", "a frame",     "again %", "aside %", "px",
                     "recall %", "px",       "precision %", "aside %", "CPU ×"};
  points.header = {"sequence", "keypoints", "a frame", "again %", "aside %", "px", "CPU ×"};
  segments.text_columns = points.text_columns = 2;
  for (const SceneName scene : scenes) {
    ViewSequence sequence;
    if (Status status = render_views(scene, static_cast<int>(arguments.measuring.frames), sequence);
        !status.ok())
      return status;
    if (Status status = compare_one(sequence, arguments, segments, points); !status.ok()) return status;
  }
  for (const NamedFolder& folder : folders) {
    ViewSequence sequence;
    if (Status status = read_views(folder, arguments.measuring, sequence); !status.ok()) return status;
    if (Status status = compare_one(sequence, arguments, segments, points); !status.ok()) return status;
  }
  const std::string text = fmt::format(
      "Of each sequence {} frames at most. CPU ×: over our time in the same picture, the median over "
      "the pictures.\n\n{}\n{}\n{}\n",
      arguments.measuring.frames, to_markdown(segments), to_markdown(points), describe_host().to_line());
  if (Status status = write_text(arguments.out / "detectors.md", text); !status.ok()) return status;
  return print(text);
}

}  // namespace

void add_detectors(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<DetectorsArguments>();
  arguments->measuring.frames = 60;
  CLI::App* command =
      app.add_subcommand("detectors", "Our segments and keypoints beside those of OpenCV's detectors");
  command
      ->add_option(
          "folders", arguments->folders,
          "Recorded sequences in TUM's layout with true poses: no recall, no precision (default: none)")
      ->type_name("DIR[=MODEL]");
  command->add_option("--out", arguments->out, "For detectors.md")->required()->type_name("DIR");
  add_list(*command, "--scenes", arguments->scenes, "Rendered scenes");
  command
      ->add_option("--segments", arguments->capacity.segments,
                   "At most so many of each: the longest (default 256)")
      ->check(CLI::Range(1, 60000).description(""))
      ->type_name("NUMBER");
  command
      ->add_option("--keypoints", arguments->capacity.keypoints,
                   "At most so many of each: the strongest (default 400)")
      ->check(CLI::Range(1, 60000).description(""))
      ->type_name("NUMBER");
  command->add_option("--min-length", arguments->score.min_length_px, "Of a segment, in pixels (default 20)")
      ->check(CLI::PositiveNumber.description(""))
      ->type_name("NUMBER");
  command
      ->add_option("--gap", arguments->score.gap, "A feature is looked for so many frames later (default 5)")
      ->check(CLI::PositiveNumber.description(""))
      ->type_name("NUMBER");
  command
      ->add_option("--tolerance", arguments->score.tolerance_px,
                   "Pixels that it may lie off there (default 2)")
      ->check(CLI::PositiveNumber.description(""))
      ->type_name("NUMBER");
  add_measuring_options(*command, arguments->measuring);
  command->callback([arguments, &exit_code] { exit_code = finish(run_detectors(*arguments)); });
}

}  // namespace plvo::bench
