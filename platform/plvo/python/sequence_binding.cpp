// SPDX-License-Identifier: Apache-2.0
// Recorded sequences for Python; what they assume, and damaged images, are warnings.
#include <filesystem>
#include <string>

#include "plvo/python/arrays.hpp"
#include "plvo/python/bindings.hpp"
#include "plvo/replay/recorded_camera.hpp"
#include "plvo/replay/sequence_calibration.hpp"

namespace plvo::python {

using namespace py::literals;

namespace {

void warn(const std::string& text) {
  if (PyErr_WarnEx(PyExc_RuntimeWarning, text.c_str(), 1) != 0) throw py::error_already_set();
}

Calibration calibration_for(const std::filesystem::path& folder, const py::object& camera) {
  Calibration found;
  std::string guess;
  if (camera.is_none()) {
    throw_unless_ok(sequence_calibration(folder, found, guess));
  } else if (py::isinstance<Calibration>(camera)) {
    return camera.cast<Calibration>();
  } else {
    const std::string name = path_text(camera);
    Status status = builtin_calibration(name, found);
    if (status.code() == StatusCode::kNotFound) status = read_calibration(name, found);
    throw_unless_ok(status);
  }
  if (!guess.empty()) warn(guess);
  return found;
}

class Sequence {
 public:
  Sequence(const py::object& path, const py::object& camera) {
    const std::filesystem::path folder = path_text(path);
    // A folder that is no sequence should be told so before a missing calibration is.
    SequenceIndex index;
    throw_unless_ok(read_sequence_index(folder, {}, index));
    if (!index.remark.empty()) warn(index.remark);
    throw_unless_ok(camera_.open(folder, calibration_for(folder, camera)));
    if (!camera_.remark().empty()) warn(camera_.remark());
    if (py::isinstance<Calibration>(camera)) return;
    for (const std::string& sentence : calibration().assumptions()) warn(sentence);
  }

  // False at the end. Damaged pairs of images are warned of, and left out.
  bool next(RgbdFrame& frame) {
    for (;;) {
      Status status;
      {
        const py::gil_scoped_release others_may_run;
        status = camera_.next(frame);
      }
      if (status.ok()) return true;
      if (status.code() == StatusCode::kEndOfStream) return false;
      if (status.code() != StatusCode::kDamaged) throw_unless_ok(status);
      warn(status.message());
    }
  }
  const Calibration& calibration() const { return camera_.calibration(); }
  std::size_t length() const { return camera_.frame_count(); }

 private:
  RecordedCamera camera_;
};

}  // namespace

void bind_sequence(py::module_& module) {
  const py::object frame_type = namedtuple(module, "Frame", "colour depth stamp_ns depth_stamp_ns");
  py::class_<Sequence>(module, "Sequence")
      .def(py::init<const py::object&, const py::object&>(), "folder"_a, "camera"_a = py::none())
      .def_property_readonly("camera", &Sequence::calibration)
      .def("__len__", &Sequence::length)
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", [frame_type](const py::object& self) {
        RgbdFrame frame;
        if (!self.cast<Sequence&>().next(frame)) throw py::stop_iteration();
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
