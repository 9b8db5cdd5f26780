// SPDX-License-Identifier: Apache-2.0
#include "plvo/replay/tum_writer.hpp"

#include <gtest/gtest.h>

#include "temporary_folder.hpp"
#include "tiny_sequence.hpp"

namespace plvo {
namespace {

using test::TemporaryFolder;

TEST(TumWriter, ReportsWriteFailure) {
  const TemporaryFolder folder;
  test::write_file(folder / "file", "x");
  TumWriter writer;
  EXPECT_EQ(writer.open(folder / "file", test::tiny_camera(), 5000).code(), StatusCode::kIo);
  EXPECT_EQ(writer.open(folder.path() / "file" / "below", test::tiny_camera(), 5000).code(), StatusCode::kIo);
}

TEST(TumWriter, DoesNotOverwriteARecording) {
  const TemporaryFolder folder;
  ASSERT_TRUE(test::write_tiny_sequence(folder.path(), 1).ok());
  const std::string list = test::read_file(folder / "rgb.txt");
  TumWriter writer;
  EXPECT_EQ(writer.open(folder.path(), test::tiny_camera(), 5000).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(test::read_file(folder / "rgb.txt"), list);
}

// The calibration file contains the readout time only if it is known.
TEST(TumWriter, WritesOnlyKnownReadoutTime) {
  const TemporaryFolder folder;
  Calibration written;
  written.camera = test::tiny_camera();
  written.depth_units_per_metre = 1000;
  written.depth_scale_given = true;
  for (const bool known : {false, true}) {
    written.readout_given = known;
    TumWriter writer;
    ASSERT_TRUE(writer.open(folder / (known ? "known" : "unknown"), written).ok());
  }
  EXPECT_EQ(test::read_file(folder / "unknown" / "calibration.txt"), "80 80 47.5 31.5 1000\n");
  EXPECT_EQ(test::read_file(folder / "known" / "calibration.txt"), "80 80 47.5 31.5 1000 0 0 0 0 0 0\n");
  Calibration read;
  ASSERT_TRUE(read_calibration(folder / "known" / "calibration.txt", read).ok());
  EXPECT_TRUE(read.assumptions().empty());
}

}  // namespace
}  // namespace plvo
