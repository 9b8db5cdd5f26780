// SPDX-License-Identifier: Apache-2.0
// Recorded sequences for Python; what they assume, and damaged images, are warnings.
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "plvo/python/arrays.hpp"
#include "plvo/python/bindings.hpp"
#include "plvo/python/one_thread.hpp"
#include "plvo/python/topics.hpp"
#include "plvo/recording/recording.hpp"
#include "plvo/replay/checks/frame_check.hpp"
#include "plvo/replay/recorded_imu.hpp"

namespace plvo::python {

using namespace py::literals;

namespace {

void warn(const std::string& text) {
  if (PyErr_WarnFormat(PyExc_RuntimeWarning, 1, "%U", words(text).ptr()) != 0) throw py::error_already_set();
}

void warn(const std::vector<std::string>& sentences) {
  for (const std::string& sentence : sentences) warn(sentence);
}

CalibrationChoice choice_of(const py::object& camera) {
  return [&camera](const OwnCalibration& own, Calibration& calibration) -> Status {
    if (camera.is_none()) return own(calibration);
    if (py::isinstance<Calibration>(camera)) {
      calibration = camera.cast<const Calibration&>();
      return {};
    }
    return named_calibration(path_bytes(camera), calibration);
  };
}

class Sequence {
 public:
  Sequence(const py::object& path, const py::object& camera, const py::object& topics) {
    const std::filesystem::path recording = path_bytes(path);
    RecordingOptions options;
    options.topics = bag_topics(topics);
    if (!topics.is_none() && !is_bag(recording))
      throw py::value_error("topics: they are for a ROS bag (.bag, .mcap, .db3, a folder of rosbag2)");
    throw_unless_ok(recording_.open(recording, choice_of(camera), options));
    warn(recording_.remarks());
    if (!py::isinstance<Calibration>(camera)) warn(calibration().assumptions());
  }

  // False at the end. Damaged pairs of images are warned of, and left out.
  bool next(RgbdFrame& frame) {
    if (closed_) throw py::value_error("the with block of this sequence has ended; open it again");
    for (;;) {
      Status status;
      {
        const OneThread::Use use(one_thread_);
        const py::gil_scoped_release others_may_run;
        status = recording_.next(frame);
      }
      if (status.ok()) {
        warn(check_.add(frame));
        return true;
      }
      if (status.code() == StatusCode::kEndOfStream) {
        warn(check_.finish());
        return false;
      }
      if (status.code() != StatusCode::kDamaged) throw_unless_ok(status);
      warn(status.message());
    }
  }
  const Calibration& calibration() const { return recording_.calibration(); }
  std::unique_ptr<RecordedImu> imu(const py::object& R_camera_imu) {
    ImuConfig config;
    if (!R_camera_imu.is_none()) config.R_camera_imu = matrix_of<3, 3>(R_camera_imu, "R_camera_imu");
    ImuRecording samples;
    {
      const OneThread::Use use(one_thread_);
      throw_unless_ok(recording_.read_imu(samples));
    }
    auto imu = std::make_unique<RecordedImu>();
    throw_unless_ok(imu->init(std::move(samples), config));
    return imu;
  }
  // Frames that were handed out are views of the recording, which therefore stays.
  void close() { closed_ = true; }
  std::size_t length() const { return recording_.frame_count(); }

 private:
  Recording recording_;
  bool closed_ = false;
  OneThread one_thread_{"Sequence"};
  FrameCheck check_;
};

}  // namespace

void bind_sequence(py::module_& module) {
  const py::object frame_type = namedtuple(module, "Frame", "colour depth stamp_ns depth_stamp_ns");
  bind_class<Sequence>(module, "Sequence")
      .def(py::init<const py::object&, const py::object&, const py::object&>(), "recording"_a,
           "camera"_a = py::none(), py::kw_only(), "topics"_a = py::none())
      .def_property_readonly("camera", &Sequence::calibration)
      .def("imu", &Sequence::imu, py::kw_only(), "R_camera_imu"_a = py::none())
      .def("__len__", &Sequence::length)
      .def("__enter__", [](Sequence& sequence) { return py::cast(&sequence); })
      .def("__exit__", [](Sequence& sequence, const py::args&) { sequence.close(); })
      .def("__iter__", [](Sequence& sequence) { return py::cast(&sequence); })
      .def("__next__", [frame_type](const py::object& self) {
        RgbdFrame frame;
        if (!argument<Sequence&>(self, "self", "a plvo.Sequence").next(frame)) throw py::stop_iteration();
        const ColourView& colour = frame.colour;
        const DepthView& depth = frame.depth;
        return frame_type(view(py::dtype::of<std::uint8_t>(), {colour.height, colour.width, 3},
                               {colour.stride_bytes, 3, 1}, colour.data, self),
                          view(py::dtype::of<std::uint16_t>(), {depth.height, depth.width},
                               {2 * depth.stride, 2}, depth.data, self),
                          frame.stamp_ns, frame.depth_stamp_ns);
      });
}

}  // namespace plvo::python
