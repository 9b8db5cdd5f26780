// SPDX-License-Identifier: Apache-2.0
// Recorded sequences behind sequence.h. The replay module uses the heap and may throw when it runs out; its
// exceptions become a status here.
#include "plvo/c/sequence.h"

#include <memory>
#include <string>
#include <vector>

#include "plvo/c/boundary.hpp"
#include "plvo/c/guarded.hpp"
#include "plvo/recording/recording.hpp"

template <>
inline constexpr std::size_t plvo::c::kFirstSize<plvo_bag_topics> =
    plvo::c::end_of(offsetof(plvo_bag_topics, camera_info), &plvo_bag_topics::camera_info);
template <>
inline constexpr std::size_t plvo::c::kFirstSize<plvo_imu_readings> =
    plvo::c::end_of(offsetof(plvo_imu_readings, left_out), &plvo_imu_readings::left_out);

struct plvo_sequence {
  plvo::Recording camera;
  std::vector<plvo_imu_sample> gyro, accelerometer;
};

namespace {

using plvo::Status;
using plvo::c::guarded;
using plvo::c::missing;
using plvo::c::to_c;

Status give_calibration(const plvo::Calibration& calibration, plvo_camera* camera, double* metres_per_unit) {
  plvo_camera whole = to_c(calibration.camera);
  if (!calibration.has_size) {
    whole.width = camera->width;
    whole.height = camera->height;
  }
  if (Status status = plvo::c::give_camera(whole, camera); !status.ok()) return status;
  if (metres_per_unit != nullptr) *metres_per_unit = 1 / calibration.depth_units_per_metre;
  return {};
}

Status open(const char* path, const char* calibration, const plvo::BagTopicNames& topics,
            plvo_sequence** sequence) {
  const auto choose = [calibration](const plvo::OwnCalibration& own, plvo::Calibration& found) {
    return calibration == nullptr ? own(found) : plvo::named_calibration(calibration, found);
  };
  auto opened = std::make_unique<plvo_sequence>();
  if (Status status = opened->camera.open(path, choose, {{}, topics, {}}); !status.ok()) return status;
  *sequence = opened.release();
  return {};
}

std::vector<plvo_imu_sample> samples_for_c(const std::vector<plvo::ImuSample>& samples) {
  std::vector<plvo_imu_sample> result;
  result.reserve(samples.size());
  for (const auto& [stamp_ns, value] : samples)
    result.push_back({stamp_ns, {value.x(), value.y(), value.z()}});
  return result;
}

const plvo_imu_sample* first_of(const std::vector<plvo_imu_sample>& samples) {
  return samples.empty() ? nullptr : samples.data();
}

std::string text_or_none(const char* text) { return text == nullptr ? "" : text; }

}  // namespace

plvo_status plvo_camera_builtin(const char* name, plvo_camera* camera, double* metres_per_unit) {
  return guarded([&]() -> Status {
    if (name == nullptr) return missing("name");
    if (Status status = plvo::c::check_struct(camera, "camera"); !status.ok()) return status;
    plvo::Calibration calibration;
    if (Status status = plvo::builtin_calibration(name, calibration); !status.ok()) return status;
    return give_calibration(calibration, camera, metres_per_unit);
  });
}

plvo_status plvo_camera_read(const char* file, plvo_camera* camera, double* metres_per_unit) {
  return guarded([&]() -> Status {
    if (file == nullptr) return missing("file");
    if (Status status = plvo::c::check_struct(camera, "camera"); !status.ok()) return status;
    plvo::Calibration calibration;
    if (Status status = plvo::read_calibration(file, calibration); !status.ok()) return status;
    return give_calibration(calibration, camera, metres_per_unit);
  });
}

plvo_status plvo_sequence_open(const char* path, const char* calibration, plvo_sequence** sequence) {
  return guarded([&]() -> Status {
    if (sequence == nullptr) return missing("sequence");
    *sequence = nullptr;
    if (path == nullptr) return missing("path");
    return open(path, calibration, {}, sequence);
  });
}

plvo_status plvo_sequence_open_bag(const char* file, const char* calibration, const plvo_bag_topics* topics,
                                   plvo_sequence** sequence) {
  return guarded([&]() -> Status {
    if (sequence == nullptr) return missing("sequence");
    *sequence = nullptr;
    if (file == nullptr) return missing("file");
    if (!plvo::is_bag(file))
      return plvo::c::refuse("file: the name of a ROS 1 bag ends in .bag, that of ROS 2 in .mcap or .db3");
    plvo_bag_topics known = {};
    if (topics != nullptr)
      if (Status status = plvo::c::take_struct(topics, known, "bag_topics"); !status.ok()) return status;
    const plvo::BagTopicNames names = {text_or_none(known.colour), text_or_none(known.depth),
                                       text_or_none(known.camera_info), text_or_none(known.gyro),
                                       text_or_none(known.accelerometer)};
    return open(file, calibration, names, sequence);
  });
}

plvo_status plvo_sequence_camera(const plvo_sequence* sequence, plvo_camera* camera) {
  if (sequence == nullptr) return to_c(missing("sequence"));
  Status status = plvo::c::check_struct(camera, "camera");
  if (status.ok()) status = plvo::c::give_camera(to_c(sequence->camera.model()), camera);
  return to_c(status);
}

std::size_t plvo_sequence_frame_count(const plvo_sequence* sequence) {
  return sequence == nullptr ? 0 : sequence->camera.frame_count();
}

plvo_status plvo_sequence_next(plvo_sequence* sequence, plvo_frame* frame) {
  return guarded([&]() -> Status {
    if (sequence == nullptr) return missing("sequence");
    if (Status status = plvo::c::check_struct(frame, "frame"); !status.ok()) return status;
    plvo::RgbdFrame view;
    const Status status = sequence->camera.next(view);
    plvo_frame whole;
    std::memset(&whole, 0, sizeof whole);
    whole.stamp_ns = view.stamp_ns;
    whole.depth_stamp_ns = view.depth_stamp_ns;
    whole.width = view.colour.width;
    whole.height = view.colour.height;
    whole.colour_format = static_cast<std::int32_t>(view.colour.format);
    whole.colour = view.colour.data;
    whole.colour_stride_bytes = view.colour.stride_bytes;
    whole.depth = view.depth.data;
    whole.depth_stride_bytes = view.depth.stride * static_cast<std::int64_t>(sizeof(std::uint16_t));
    whole.metres_per_unit = view.depth.metres_per_unit;
    plvo::c::give_struct(whole, frame);
    return status;
  });
}

plvo_status plvo_sequence_imu(plvo_sequence* sequence, plvo_imu_readings* readings) {
  return guarded([&]() -> Status {
    if (sequence == nullptr) return missing("sequence");
    if (Status status = plvo::c::check_struct(readings, "imu_readings"); !status.ok()) return status;
    plvo::ImuRecording recording;
    const Status status = sequence->camera.read_imu(recording);
    if (!status.ok()) recording = {};
    sequence->gyro = samples_for_c(recording.gyro);
    sequence->accelerometer = samples_for_c(recording.accelerometer);
    plvo_imu_readings whole;
    std::memset(&whole, 0, sizeof whole);
    whole.gyro = first_of(sequence->gyro);
    whole.gyro_count = sequence->gyro.size();
    whole.accelerometer = first_of(sequence->accelerometer);
    whole.accelerometer_count = sequence->accelerometer.size();
    whole.left_out = recording.ignored;
    plvo::c::give_struct(whole, readings);
    return status;
  });
}

void plvo_sequence_close(plvo_sequence* sequence) { delete sequence; }
