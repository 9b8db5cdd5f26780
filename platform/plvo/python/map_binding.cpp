// SPDX-License-Identifier: Apache-2.0
// The map for Python, in a block of its own; other threads run while it is read from a file or written.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plvo/host/files/map_files.hpp"
#include "plvo/python/arrays.hpp"
#include "plvo/python/bindings.hpp"
#include "plvo/python/one_thread.hpp"
#include "plvo/python/settings.hpp"
#include "plvo/python/tracker.hpp"
#include "plvo/python/values.hpp"

namespace plvo::python {

using namespace py::literals;

namespace {

class OwnedMap {
 public:
  OwnedMap(const Calibration& camera, const Settings& settings, const MapLimits& limits) {
    throw_unless_ok(limits.validate());
    memory_.resize(Map::required_bytes(limits, camera.camera.width, camera.camera.height));
    throw_unless_ok(map_.init(memory_, camera.camera, settings.config, limits));
  }

  MapResult update(Tracker& odometry, const TrackResult& result) {
    const OneThread::Use use(one_thread_);
    return odometry.update(map_, result);
  }
  void settle() {
    const OneThread::Use use(one_thread_);
    const py::gil_scoped_release others_may_run;
    (void)map_.settle();
  }
  void save(const py::object& path) { with_file(save_map, path); }
  void load(const py::object& path) { with_file(load_map, path); }
  py::object keyframe_pose(std::uint32_t keyframe) {
    const OneThread::Use use(one_thread_);
    const std::optional<Se3> pose = map_.keyframe_pose(keyframe);
    return pose ? py::object(matrix_4x4(*pose)) : py::none();
  }
  std::size_t keyframes() {
    const OneThread::Use use(one_thread_);
    return map_.graph().size();
  }
  std::size_t loops() {
    const OneThread::Use use(one_thread_);
    return map_.graph().loops().size();
  }
  std::size_t memory_bytes() const { return memory_.size(); }

 private:
  void with_file(Status (*save_or_load)(const std::filesystem::path&, Map&), const py::object& path) {
    const std::string file = path_bytes(path);
    const OneThread::Use use(one_thread_);
    Status status;
    {
      const py::gil_scoped_release others_may_run;
      status = save_or_load(file, map_);
    }
    throw_unless_ok(status);
  }

  std::vector<std::byte> memory_;
  Map map_;
  OneThread one_thread_{"Map"};
};

}  // namespace

void bind_map(py::module_& module) {
  bind_value<MapResult>(module, "MapResult")
      .def_readonly("located", &MapResult::located)
      .def_readonly("recognised", &MapResult::recognised)
      .def_readonly("keyframe", &MapResult::keyframe)
      .def_property_readonly("T_map_world", [](const MapResult& r) { return matrix_4x4(r.T_map_world); })
      .def_property_readonly(
          "covariance",
          [](const py::object& self) {
            return matrix_view<6, 6>(
                argument<const MapResult&>(self, "self", "a plvo.MapResult").pose_covariance, self);
          })
      .def_property_readonly("T_keyframe_camera",
                             [](const MapResult& r) { return matrix_4x4(r.T_keyframe_camera); })
      .def_readonly("removed", &MapResult::removed)
      .def_readonly("removed_into", &MapResult::removed_into)
      .def_property_readonly("T_into_removed",
                             [](const MapResult& r) { return matrix_4x4(r.T_into_removed); })
      .def("__repr__", shown_by({"located", "recognised", "keyframe", "removed"}));
  const MapLimits defaults;
  bind_class<OwnedMap>(module, "Map")
      .def(py::init([](const Calibration& camera, const py::object& config, int keyframes, int keypoints,
                       int segments) {
             return std::make_unique<OwnedMap>(
                 camera,
                 config.is_none() ? Settings() : argument<const Settings&>(config, "config", "a plvo.Config"),
                 MapLimits{keyframes, keypoints, segments});
           }),
           "camera"_a, "config"_a = py::none(), py::kw_only(), "keyframes"_a = defaults.keyframes,
           "keypoints"_a = defaults.keypoints, "segments"_a = defaults.segments)
      .def("update", &OwnedMap::update, "odometry"_a, "result"_a)
      .def("settle", &OwnedMap::settle)
      .def("save", &OwnedMap::save, "path"_a)
      .def("load", &OwnedMap::load, "path"_a)
      .def("keyframe_pose", &OwnedMap::keyframe_pose, "keyframe"_a)
      .def_property_readonly("keyframes", &OwnedMap::keyframes)
      .def_property_readonly("loops", &OwnedMap::loops)
      .def_property_readonly("memory_bytes", &OwnedMap::memory_bytes);
}

}  // namespace plvo::python
