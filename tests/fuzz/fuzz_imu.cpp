// SPDX-License-Identifier: Apache-2.0
// Any bytes as readings of a gyro and an accelerometer. Accepted readings are finite, have increasing stamps,
// and survive writing and reading.
#include "plvo/replay/imu_files.hpp"
#include "scratch_file.hpp"

namespace {

using namespace plvo;

void check(const std::vector<ImuSample>& samples) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    fuzz::require(samples[i].value.allFinite());
    fuzz::require(i == 0 || samples[i - 1].stamp_ns < samples[i].stamp_ns);
  }
}

bool same(const std::vector<ImuSample>& a, const std::vector<ImuSample>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a[i].stamp_ns != b[i].stamp_ns || a[i].value != b[i].value) return false;
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto& folder = fuzz::scratch_folder();
  for (const char* name : {kGyroFile, kAccelerometerFile}) fuzz::write_scratch(name, data, size);
  ImuRecording read, again;
  const Status status = read_imu_files(folder, read);
  if (!status.ok()) {
    fuzz::require(!std::string_view(status.message()).empty());
    return 0;
  }
  check(read.gyro);
  fuzz::require(same(read.gyro, read.accelerometer));
  if (read.gyro.empty()) return 0;
  fuzz::require(write_imu_files(folder, read, ImuAxes::kSensor).ok());
  fuzz::require(read_imu_files(folder, again).ok());
  fuzz::require(again.ignored == 0 && same(read.gyro, again.gyro));
  return 0;
}
