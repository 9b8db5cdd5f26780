// SPDX-License-Identifier: Apache-2.0
// Tests `plvo run` with images scaled down: on request, and because they exceed plvo's limit.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "plvo/replay/images/image_decoder.hpp"
#include "plvo/replay/images/image_writer.hpp"
#include "plvo_command.hpp"

namespace plvo {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::read_file;
using test::write_file;

class CliScale : public test::PlvoCommand {
 protected:
  void simulate(const std::string& name, const std::string& more) const {
    const CommandResult made = plvo("simulate --seed 3 --quiet --out " + path(name) + ' ' + more);
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  CommandResult run(const std::string& name, const std::string& more) const {
    return plvo("run " + path(name) + ' ' + more);
  }
  nlohmann::json eval(const std::string& truth, const std::string& estimate) const {
    const CommandResult r = plvo("eval --gt " + path(truth) + " --est " + path(estimate) + " --json -");
    EXPECT_EQ(r.exit_code, 0) << r.err;
    return nlohmann::json::parse(r.out);
  }
  // Replaces each pixel of 80×64 by a block.
  void magnify(const std::string& name, int factor) const {
    ImageDecoder decoder;
    const int width = 80 * factor, height = 64 * factor;
    std::vector<std::uint8_t> rgb(3 * 80 * 64), large(static_cast<std::size_t>(3 * width * height));
    std::vector<std::uint16_t> depth(80 * 64), large_depth(static_cast<std::size_t>(width * height));
    const auto block = [&](int x, int y) { return static_cast<std::size_t>(y / factor * 80 + x / factor); };
    for (const auto& file : fs::directory_iterator(folder_ / name / "rgb")) {
      ASSERT_TRUE(decoder.decode_rgb(file.path(), 80, 64, rgb).ok());
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
          std::copy_n(&rgb[3 * block(x, y)], 3, &large[static_cast<std::size_t>(3 * (y * width + x))]);
      ASSERT_TRUE(
          write_png(file.path(), ColourView{large.data(), width, height, 3 * width, PixelFormat::kRgb8})
              .ok());
    }
    for (const auto& file : fs::directory_iterator(folder_ / name / "depth")) {
      ASSERT_TRUE(decoder.decode_depth(file.path(), 80, 64, depth).ok());
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
          large_depth[static_cast<std::size_t>(y * width + x)] = depth[block(x, y)];
      ASSERT_TRUE(write_png(file.path(), DepthView{large_depth.data(), width, height, width, 0.0002}).ok());
    }
  }
};

// The same sequence is rendered at 640×480 and at half that size.
TEST_F(CliScale, RecordingOfTwiceTheSizeGivesThePosesOfTheSmallOne) {
  simulate("small", "--scene desk --frames 12 --size 320x240");
  simulate("large", "--scene desk --frames 12 --size 640x480");
  ASSERT_EQ(run("small", "--quiet --out " + path("s")).exit_code, 0);
  const CommandResult r = run("large", "--scale 2 --out " + path("l") + " --json " + path("j"));
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_EQ(r.err, "plvo: wrote " + path("l") + ", " + path("j") + "\n")
      << "and nothing that nobody asked for";
  EXPECT_NE(r.out.find("images                 320x240, scaled down by 2\n"), std::string::npos) << r.out;
  const auto json = nlohmann::json::parse(read_file(folder_ / "j"));
  EXPECT_EQ(json["image"], (nlohmann::json{{"width", 320}, {"height", 240}, {"scaled_down_by", 2}}));
  EXPECT_EQ(json["lost"], 0);
  const auto near = eval("s", "l");
  EXPECT_EQ(near["poses"], 12);
  EXPECT_LT(near["ate_m"]["max"], 0.001);
  EXPECT_GT(near["ate_m"]["identity"]["max"], 0.02) << "the camera moves";
  const double small_m = eval("small/groundtruth.txt", "s")["ate_m"]["rmse"];
  const double large_m = eval("large/groundtruth.txt", "l")["ate_m"]["rmse"];
  EXPECT_LT(large_m, 0.0005);
  EXPECT_LT(large_m, 1.2 * small_m) << "made smaller they are no worse than images of that size";
  EXPECT_NE(run("large", "").out.find("images                 640x480\n"), std::string::npos);
}

TEST_F(CliScale, ReductionRestoresMagnifiedImages) {
  simulate("sequence", "--scene bare --frames 4 --size 80x64");
  ASSERT_EQ(run("sequence", "--quiet --out " + path("a") + " --covariance " + path("ca")).exit_code, 0);
  const std::string calibration = read_file(folder_ / "sequence/calibration.txt");
  magnify("sequence", 4);
  write_file(folder_ / "sequence/calibration.txt", "262.5 262.5 159.5 127.5 5000\nreadout_s 0\n");
  ASSERT_EQ(calibration.rfind("65.625 65.625 39.5 31.5 5000", 0), 0u) << calibration;
  ASSERT_EQ(run("sequence", "--scale 4 --quiet --out " + path("b") + " --covariance " + path("cb")).exit_code,
            0);
  EXPECT_EQ(read_file(folder_ / "a"), read_file(folder_ / "b"));
  EXPECT_EQ(read_file(folder_ / "ca"), read_file(folder_ / "cb"));
}

TEST_F(CliScale, ImagesAboveTheLimitAreReducedWithAMessage) {
  simulate("sequence", "--scene bare --frames 3 --size 80x64");
  ASSERT_EQ(run("sequence", "--quiet --out " + path("a")).exit_code, 0);
  magnify("sequence", 26);  // 2080×1664
  write_file(folder_ / "sequence/calibration.txt", "1706.25 1706.25 1039.5 831.5 5000\nreadout_s 0\n");
  const CommandResult r = run("sequence", "--frames 2 --out " + path("b"));
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_NE(r.err.find("warning: the images of 2080x1664 are larger than plvo takes: they are scaled down by "
                       "2, to 1040x832, and the calibration with them"),
            std::string::npos)
      << r.err;
  EXPECT_NE(r.out.find("images                 1040x832, scaled down by 2\n"), std::string::npos) << r.out;
  // With a scale down to the original size the limit has no effect.
  ASSERT_EQ(run("sequence", "--scale 13 --quiet --out " + path("c")).exit_code, 0);
  const CommandResult as_large = run("sequence", "--scale 1");
  EXPECT_EQ(as_large.exit_code, 2);
  EXPECT_NE(as_large.err.find("--scale: images of 2080x1664 scaled down by 1 are 2080x1664, and plvo takes "
                              "64x64 to 2047x2047"),
            std::string::npos)
      << as_large.err;
  fs::create_directory(folder_ / "out");
  const CommandResult calibrate = plvo("calibrate " + path("sequence") + " --out " + path("out/c.yaml"));
  EXPECT_EQ(calibrate.exit_code, 1);
  EXPECT_NE(calibrate.err.find("record a smaller mode"), std::string::npos) << calibrate.err;
}

TEST_F(CliScale, TooLargeFactorIsRefused) {
  simulate("sequence", "--scene bare --frames 2 --size 160x120");
  const CommandResult r = run("sequence", "--scale 2 --out " + path("t"));
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_NE(r.err.find("--scale: images of 160x120 scaled down by 2 are 80x60, and plvo takes 64x64"),
            std::string::npos)
      << r.err;
  EXPECT_FALSE(fs::exists(folder_ / "t"));
}

}  // namespace
}  // namespace plvo
