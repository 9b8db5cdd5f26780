// SPDX-License-Identifier: Apache-2.0
#include "plvo/report/report.hpp"
#include "plvo/view/view_state.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "plvo/report/base64.hpp"
#include "plvo/report/drawing.hpp"
#include "plvo/report/palette.hpp"
#include "temporary_folder.hpp"

namespace plvo::report {
namespace {

std::string encode(const std::string& text) {
  return base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

TEST(Base64, VectorsOfRfc4648) {
  EXPECT_EQ(encode(""), "");
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foo"), "Zm9v");
  EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encode("\xff\xff\xfe"), "///+");
}

nlohmann::json data_of(const std::string& page) {
  const std::string begin = "<script id=\"data\" type=\"application/json\">";
  const std::size_t first = page.find(begin) + begin.size();
  return nlohmann::json::parse(page.substr(first, page.find("</script>", first) - first));
}

TEST(Report, HoldsItsDataWhateverTheNames) {
  ReportInput input;
  input.title = "</script><b>\"nasty\" @STYLE@ \xff";
  input.trajectory.poses = {{5'000'000'000, {}},
                            {5'500'000'000, {Matrix3::Identity(), Vector3(1, -2, 0.333333333)}}};
  const std::string page = make_report(input);
  const nlohmann::json data = data_of(page);
  EXPECT_EQ(data["title"], "</script><b>\"nasty\" @STYLE@ \xEF\xBF\xBD");
  EXPECT_EQ(data["trajectory"]["t"], nlohmann::json({0.0, 0.5}));
  EXPECT_EQ(data["trajectory"]["p"], nlohmann::json({0.0, 0.0, 0.0, 1.0, -2.0, 0.33333}));
  EXPECT_FALSE(data.contains("series") || data.contains("frames") || data.contains("metrics"));
  EXPECT_NE(page.find("function chart("), std::string::npos);
}

// In a browser's script element, `<!--<script` makes the script continue past `</script>`.
TEST(Report, TextIsEscapedForHtmlAndJavaScript) {
  ReportInput input;
  input.title = "x<!--<script>y & ]]> \u2028\u2029 \x1b[31m\u009b";
  input.summary = {{"<!--<script>", "</script><script>alert(1)</script>"}};
  const std::string page = make_report(input);
  const nlohmann::json data = data_of(page);
  EXPECT_EQ(data["title"], input.title);
  EXPECT_EQ(data["summary"][0][1], input.summary[0].second);
  const std::size_t begin = page.find("{\"title\"");
  const std::string text = page.substr(begin, page.find("</script>", begin) - begin);
  EXPECT_EQ(text.find_first_of("<>&"), std::string::npos) << text;
  for (const char c : text) EXPECT_TRUE(c >= ' ' && c < 0x7f) << static_cast<int>(c);
  EXPECT_NE(text.find("x\\u003c!--\\u003cscript\\u003ey \\u0026 ]]\\u003e \\u2028\\u2029"), std::string::npos)
      << text;
}

TEST(Report, WriteFailureIsAStatus) { EXPECT_EQ(write_report("/dev/full", {}).code(), StatusCode::kIo); }

TEST(Drawing, MissingDepthIsBlack) {
  std::vector<std::uint16_t> depth(16, 0);
  depth[0] = 2000;   // 0.4 m: near
  depth[2] = 25000;  // 5 m: far
  const Picture picture = draw_depth({depth.data(), 4, 4, 4, 1.0 / 5000});
  ASSERT_EQ(picture.rgb.size(), 12u);
  EXPECT_EQ((std::vector<std::uint8_t>(picture.rgb.begin(), picture.rgb.begin() + 6)),
            (std::vector<std::uint8_t>{240, 228, 66, 60, 30, 100}));
  EXPECT_EQ((std::vector<std::uint8_t>(picture.rgb.begin() + 6, picture.rgb.end())),
            std::vector<std::uint8_t>(6, 0));
}

TEST(Drawing, TheLiveViewPaintsDepthInTheSameColours) {
  ViewSnapshot snapshot;
  snapshot.depth_width = 256;
  snapshot.depth_height = 2;
  snapshot.metres_per_unit = 1.0 / 5000;
  for (int i = 0; i < 512; ++i) snapshot.depth.push_back(static_cast<std::uint16_t>(120 * i));  // to 12 m
  std::vector<std::uint8_t> live;
  int width = 0, height = 0;
  paint_depth(snapshot, live, width, height);
  EXPECT_EQ(live, draw_depth({snapshot.depth.data(), 256, 2, 256, snapshot.metres_per_unit}).rgb);
}

TEST(Drawing, SegmentsHaveTheirKind) {
  const std::vector<SegmentView> now = {
      {0, 0, 9, 0, false}, {0, 1, 9, 1, true}, {0, 2, 9, 2, true}, {0, 3, 9, 3, true}};
  const std::vector<SegmentView> before(2);
  const std::vector<LineTrackView> tracks = {
      {1, 2, true}, {0, 3, false}, {7, 0, true}};  // the last one is invalid
  FeatureView view;
  view.segments = now;
  view.reference_segments = before;
  view.line_tracks = tracks;
  const std::vector<SegmentFate> fates = segment_fates(view);
  EXPECT_EQ(fates[0].kind, FeatureKind::kPlain);
  EXPECT_EQ(fates[1].kind, FeatureKind::kWith3d);
  EXPECT_EQ(fates[2].kind, FeatureKind::kInlier);
  EXPECT_EQ(fates[2].reference, 1);
  EXPECT_EQ(fates[3].kind, FeatureKind::kOutlier);
}

TEST(Drawing, OverlayDrawsInsideTheImageOnly) {
  const std::vector<std::uint8_t> grey(64, 100);
  const std::vector<PointTrackView> tracks = {{-50, -50, 4, 4, true}, {1e9F, 0, 2, 2, false}};
  FeatureView view;
  view.image = {grey.data(), 8, 8, 8};
  view.point_tracks = tracks;
  const Picture picture = draw_overlay(view);
  ASSERT_EQ(picture.rgb.size(), 192u);
  EXPECT_EQ(picture.rgb[0], kPointColour.r);  // the stroke to the upper left passes through the corner
  EXPECT_EQ(picture.rgb[1], kPointColour.g);
  EXPECT_EQ(picture.rgb[3 * 7], 70) << "the image is dimmed where nothing is drawn";
}

TEST(Drawing, StrokesAreAsWideAsTheirPen) {
  const std::vector<std::uint8_t> black(40 * 40, 0);
  FeatureView view;
  view.image = {black.data(), 40, 40, 40};
  const std::vector<SegmentView> across = {{5, 20, 34, 20, false}};
  const std::vector<SegmentView> down = {{20, 5, 20, 34, false}};
  const std::vector<SegmentView> slanted = {{10, 10, 30, 25, false}};
  const std::vector<LineTrackView> tracks = {{0, 0, true}};
  view.line_tracks = tracks;
  for (const auto* segments : {&across, &down, &slanted}) {
    view.segments = view.reference_segments = *segments;
    const Picture picture = draw_overlay(view);
    double covered = 0;  // full blue of the colour where the stroke covers a pixel
    for (std::size_t i = 2; i < picture.rgb.size(); i += 3)
      covered += static_cast<double>(picture.rgb[i]) / kLineColour.b;
    const SegmentView& s = segments->front();
    const double length = std::hypot(s.b_u - s.a_u, s.b_v - s.a_v);
    EXPECT_NEAR(covered, 3 * length + 9 * 3.14159 / 4, 0.05 * 3 * length);
  }
}

}  // namespace
}  // namespace plvo::report
