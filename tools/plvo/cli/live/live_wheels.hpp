// SPDX-License-Identifier: Apache-2.0
// `--wheels` of a live session: lines of wheel odometry that another program writes while it runs. They are
// read when a frame is there, without waiting; a frame that no line reaches is tracked without wheels, and
// what is wrong with the lines is said.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "plvo/cli/common/console.hpp"
#include "plvo/cli/run/wheel_options.hpp"
#include "plvo/host/arrival_clock.hpp"
#include "plvo/host/files/line_file.hpp"
#include "plvo/host/files/table_reader.hpp"
#include "plvo/host/stream/line_reader.hpp"

namespace plvo::cli {

// What the stamps of the lines count.
enum class WheelClock : std::uint8_t {
  kImages,    // the clock of the images, as in a file beside them
  kComputer,  // this computer's time since 1970: nobody outside knows the clock of a sensor
};

struct WheelSummary {
  bool used = false;
  std::uint64_t lines = 0, left_out = 0;  // that could not be parsed, are not later or not finite
  std::uint64_t with = 0, without = 0;    // frames
};

class LiveWheels {
 public:
  explicit LiveWheels(Console& console);

  // Without --wheels it does nothing. Returns the errors of LineReader::open and WheelConfig::validate.
  Status start(const WheelOptions& options, const BaseOption& base, WheelClock clock);
  // The file of the lines, on the clock of the images, that plvo run --wheels reads: in this folder, from the
  // first line after the first frame on. A full disk ends the file alone; failure() then says that it did.
  void keep_in(const std::string& folder) { folder_ = folder; }
  const Status& failure() const { return failure_; }

  // Called for each frame that is tracked, in their order; arrival_ns by posix_monotonic_ns().
  MotionPrior until(std::int64_t stamp_ns, std::int64_t arrival_ns);
  // While no frame comes from a sensor, so that the writer of the lines need not wait.
  void while_no_frame_comes();

  WheelSummary summary() const { return summary_; }

 private:
  void read(std::int64_t until_ns);
  void take(const std::string& line);
  void leave_out(const std::string& why);
  void tell(std::int64_t stamp_ns, bool with);
  std::string why_without(std::int64_t stamp_ns) const;
  void keep(const WheelSample& sample);

  Console& console_;
  std::string name_;  // of the source, for messages
  WheelClock clock_ = WheelClock::kImages;
  LineReader reader_;
  TableRow row_;
  WheelRows rows_;
  WheelPriors priors_;
  QuickWheels quick_;
  ArrivalClock arrivals_;
  std::string folder_;
  LineFile file_;
  Status failure_;
  bool first_ = true;                           // no frame has come yet
  bool missing_ = false;                        // it was said that frames are tracked without wheels
  std::optional<std::int64_t> again_since_ns_;  // while missing_: the first of the frames with lines again
  WheelSummary summary_;
};

}  // namespace plvo::cli
