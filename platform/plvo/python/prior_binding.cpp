// SPDX-License-Identifier: Apache-2.0
// What other sensors say of a frame, for Python: priors, and gyros, accelerometers and wheels that make them.
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "plvo/inertial/imu_integrator.hpp"
#include "plvo/motion/wheel_prior.hpp"
#include "plvo/odometry/track_result.hpp"
#include "plvo/python/arrays.hpp"
#include "plvo/python/bindings.hpp"
#include "plvo/python/values.hpp"
#include "plvo/replay/recorded_imu.hpp"

namespace plvo::python {

using namespace py::literals;

namespace {

constexpr std::size_t kWaiting = 4096;  // samples of a sensor between two frames

// None, or a pair of a value and its 3×3 covariance.
template <int Columns>
std::optional<std::pair<Matrix<3, Columns>, Matrix3>> with_covariance(const py::object& given,
                                                                      const std::string& name) {
  if (given.is_none()) return std::nullopt;
  if (!py::isinstance<py::sequence>(given) || py::len(given) != 2)
    throw py::value_error(name + ": expected a pair of the value and its covariance");
  const auto pair = py::reinterpret_borrow<py::sequence>(given);
  return std::pair{matrix_of<3, Columns>(pair[0], name), matrix_of<3, 3>(pair[1], name + ", covariance")};
}

MotionPrior make_prior(const py::object& rotation, const py::object& translation, const py::object& gravity,
                       double gravity_offset_sigma) {
  MotionPrior prior;
  if (const auto given = with_covariance<3>(rotation, "rotation"))
    prior.rotation = {given->first, given->second};
  if (const auto given = with_covariance<1>(translation, "translation"))
    prior.translation = {given->first, given->second};
  if (const auto given = with_covariance<1>(gravity, "gravity"))
    prior.gravity = {given->first, given->second, gravity_offset_sigma};
  throw_unless_ok(prior.validate());
  return prior;
}

// steps: (seconds, twist, covariance) of each.
MotionPrior prior_of_wheels(const py::object& steps, const py::object& T_base_camera, double error_s) {
  const Se3 T = se3_of(T_base_camera, "T_base_camera");
  BaseMotion motion;
  for (const py::handle& given : py::list(steps)) {
    const py::list parts(py::reinterpret_borrow<py::object>(given));
    if (parts.size() != 3)
      throw py::value_error("steps: expected (seconds, twist, covariance) for each step");
    const WheelStep step{number(parts[0], "seconds"), matrix_of<6, 1>(parts[1], "twist"),
                         matrix_of<6, 6>(parts[2], "covariance")};
    throw_unless_ok(motion.add(step, error_s));
  }
  MotionPrior prior;
  throw_unless_ok(motion.prior(T, prior));
  return prior;
}

void learn(ImuIntegrator& imu, const TrackResult& result) {
  if (const std::optional<ObservedRotation> observed = observed_rotation(result)) imu.correct(*observed);
}

class Imu {
 public:
  explicit Imu(const ImuConfig& config) : gyro_(kWaiting), accelerometer_(kWaiting) {
    throw_unless_ok(integrator_.init(gyro_, accelerometer_, config));
  }
  ImuIntegrator& integrator() { return integrator_; }

 private:
  std::vector<ImuSample> gyro_, accelerometer_;
  ImuIntegrator integrator_;
};

template <int Rows, int Columns, typename Of>
py::object copy_or_none(const Of* part, Matrix<Rows, Columns> Of::*member) {
  if (part == nullptr) return py::none();
  return copy_of(part->*member);
}

template <typename Part>
const Part* pointer(const std::optional<Part>& part) {
  return part ? &*part : nullptr;
}

std::string describe_prior(const MotionPrior& prior) {
  std::string parts;
  if (prior.rotation) parts += " rotation";
  if (prior.translation) parts += " translation";
  if (prior.gravity) parts += " gravity";
  return "<plvo.MotionPrior" + (parts.empty() ? " without a part" : " of" + parts) + ">";
}

}  // namespace

void bind_prior(py::module_& module) {
  using Prior = const MotionPrior&;
  bind_value<MotionPrior>(module, "MotionPrior")
      .def(py::init(&make_prior), py::kw_only(), "rotation"_a = py::none(), "translation"_a = py::none(),
           "gravity"_a = py::none(), "gravity_offset_sigma"_a = 0.0)
      .def_static("of_wheels", &prior_of_wheels, "steps"_a, "T_base_camera"_a, "error_s"_a = 0.0)
      .def_property_readonly(
          "R_now_before",
          [](Prior p) { return copy_or_none(pointer(p.rotation), &RotationPrior::R_now_before); })
      .def_property_readonly(
          "rotation_covariance",
          [](Prior p) { return copy_or_none(pointer(p.rotation), &RotationPrior::covariance); })
      .def_property_readonly(
          "t_now_before",
          [](Prior p) { return copy_or_none(pointer(p.translation), &TranslationPrior::t_now_before); })
      .def_property_readonly(
          "translation_covariance",
          [](Prior p) { return copy_or_none(pointer(p.translation), &TranslationPrior::covariance); })
      .def_property_readonly("down",
                             [](Prior p) { return copy_or_none(pointer(p.gravity), &GravityPrior::down); })
      .def_property_readonly(
          "gravity_covariance",
          [](Prior p) { return copy_or_none(pointer(p.gravity), &GravityPrior::covariance); })
      .def_property_readonly("gravity_offset_sigma",
                             [](Prior p) { return p.gravity ? p.gravity->offset_sigma : 0.0; })
      .def("__repr__", &describe_prior);

  bind_class<Imu>(module, "Imu")
      .def(py::init([](const py::object& R_camera_imu, double gyro_noise, double gyro_offset_sigma,
                       double gyro_offset_walk, double gyro_scale_sigma, double accelerometer_noise,
                       double accelerometer_offset_sigma, double acceleration, double acceleration_s,
                       double longest_gap_s) {
             ImuConfig config;
             if (!R_camera_imu.is_none()) config.R_camera_imu = matrix_of<3, 3>(R_camera_imu, "R_camera_imu");
             config.gyro_noise = gyro_noise;
             config.gyro_offset_sigma = gyro_offset_sigma;
             config.gyro_offset_walk = gyro_offset_walk;
             config.gyro_scale_sigma = gyro_scale_sigma;
             config.accelerometer_noise = accelerometer_noise;
             config.accelerometer_offset_sigma = accelerometer_offset_sigma;
             config.acceleration = acceleration;
             config.acceleration_s = acceleration_s;
             config.longest_gap_s = longest_gap_s;
             return std::make_unique<Imu>(config);
           }),
           py::kw_only(), "R_camera_imu"_a = py::none(), "gyro_noise"_a = ImuConfig().gyro_noise,
           "gyro_offset_sigma"_a = ImuConfig().gyro_offset_sigma,
           "gyro_offset_walk"_a = ImuConfig().gyro_offset_walk,
           "gyro_scale_sigma"_a = ImuConfig().gyro_scale_sigma,
           "accelerometer_noise"_a = ImuConfig().accelerometer_noise,
           "accelerometer_offset_sigma"_a = ImuConfig().accelerometer_offset_sigma,
           "acceleration"_a = ImuConfig().acceleration, "acceleration_s"_a = ImuConfig().acceleration_s,
           "longest_gap_s"_a = ImuConfig().longest_gap_s)
      .def(
          "add_gyro",
          [](Imu& imu, std::int64_t stamp_ns, const py::object& rate) {
            return imu.integrator().add_gyro({stamp_ns, matrix_of<3, 1>(rate, "rate")});
          },
          "stamp_ns"_a, "rate"_a)
      .def(
          "add_acceleration",
          [](Imu& imu, std::int64_t stamp_ns, const py::object& force) {
            return imu.integrator().add_acceleration({stamp_ns, matrix_of<3, 1>(force, "force")});
          },
          "stamp_ns"_a, "force"_a)
      .def(
          "prior", [](Imu& imu, std::int64_t stamp_ns) { return imu.integrator().prior(stamp_ns); },
          "stamp_ns"_a)
      .def(
          "learn", [](Imu& imu, const TrackResult& result) { learn(imu.integrator(), result); }, "result"_a)
      .def_property_readonly("gyro_offset", [](Imu& imu) { return copy_of(imu.integrator().gyro_offset()); })
      .def_property_readonly("gyro_offset_variance",
                             [](Imu& imu) { return copy_of(imu.integrator().gyro_offset_variance()); });

  bind_class<RecordedImu>(module, "RecordedImu")
      .def(
          "prior",
          [](RecordedImu& imu, std::int64_t stamp_ns) {
            ImuIntegrator& integrator = imu.until(stamp_ns);
            return integrator.prior(stamp_ns);
          },
          "stamp_ns"_a)
      .def(
          "learn",
          [](RecordedImu& imu, const TrackResult& result) { learn(imu.until(result.stamp_ns), result); },
          "result"_a);
}

}  // namespace plvo::python
