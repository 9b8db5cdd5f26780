// SPDX-License-Identifier: Apache-2.0
// Any bytes as the file of wheel odometry, and the priors of frames between its samples. Accepted samples are
// finite, have increasing stamps, and survive writing and reading to seven decimals; every prior is valid.
#include "plvo/replay/wheel_files.hpp"
#include "plvo/replay/wheel_priors.hpp"
#include "scratch_file.hpp"

namespace {

using namespace plvo;

void check(const WheelRecording& recording) {
  const std::vector<WheelSample>& samples = recording.samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    fuzz::require(samples[i].velocity.allFinite() && samples[i].sigma.allFinite());
    fuzz::require(!recording.has_sigma || samples[i].sigma.minCoeff() > 0);
    fuzz::require(i == 0 || samples[i - 1].stamp_ns < samples[i].stamp_ns);
  }
}

void check_priors(const WheelRecording& recording) {
  WheelPriors wheels, as_they_come;
  WheelConfig held;
  held.hold_s = 0.1;
  fuzz::require(wheels.init(recording, {}).ok() && as_they_come.init({}, held).ok());
  for (const WheelSample& sample : recording.samples) {
    if (sample.stamp_ns > std::int64_t{1} << 61) break;
    fuzz::require(as_they_come.add(sample));
    fuzz::require(as_they_come.prior(sample.stamp_ns + 7'000'000).validate().ok());
    const MotionPrior prior = wheels.prior(sample.stamp_ns + 7'000'000);
    fuzz::require(prior.validate().ok());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::write_scratch(kWheelFile, data, size);
  WheelRecording read, again;
  const Status status = read_wheel_file(fuzz::scratch_folder() / kWheelFile, read);
  if (!status.ok()) {
    fuzz::require(!std::string_view(status.message()).empty());
    return 0;
  }
  check(read);
  check_priors(read);
  fuzz::require(write_wheel_file(fuzz::scratch_folder() / kWheelFile, read).ok());
  fuzz::require(read_wheel_file(fuzz::scratch_folder() / kWheelFile, again).ok());
  fuzz::require(again.samples.size() == read.samples.size() && again.ignored == 0);
  return 0;
}
