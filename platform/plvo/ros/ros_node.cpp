// SPDX-License-Identifier: Apache-2.0
#include "plvo/ros/ros_node.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <deque>
#include <sstream>

namespace plvo {
namespace {

using SteadyClock = std::chrono::steady_clock;  // that of a simulation may stand still
constexpr double kComplaintPeriod_s = 5;
constexpr double kSilence_s = 2;  // without images, until the diagnosis says so

double seconds_since(SteadyClock::time_point then) {
  return std::chrono::duration<double>(SteadyClock::now() - then).count();
}

// `count` numbers with spaces between them, and nothing else.
std::optional<std::vector<double>> numbers_of(const std::string& text, std::size_t count) {
  std::istringstream stream(text);
  std::vector<double> numbers;
  for (double number = 0; stream >> number;) numbers.push_back(number);
  if (!stream.eof() || numbers.size() != count) return std::nullopt;
  return numbers;
}

// plvo's reasons of a loss begin with the state.
std::string sentence(const std::string& state, const std::string& reason) {
  if (reason.empty()) return state;
  return reason.starts_with(state + ":") ? reason : state + ": " + reason;
}

}  // namespace

struct RosNode::State {
  State(const RosNodeSettings& given, RosMiddleware given_middleware)
      : settings(given), middleware(std::move(given_middleware)), odometry(given.odometry) {}

  struct Frame {
    std::int64_t stamp_ns = 0;
    std::string camera_frame;
    Track track;
    SteadyClock::time_point arrival;
  };

  void take_camera_info(const std::string& wrong);
  void take_imu(const std::string& wrong, std::int64_t stamp_ns, const std::string& frame);
  void track_waiting();
  bool can_track(const Frame& frame);
  bool wait_for(const std::string& what);
  std::optional<RosPose> look_up(const std::string& target, const std::string& source, const char* parameter);
  void publish(const RosEstimate& next);
  void diagnose();
  void complain(const std::string& text);

  RosNodeSettings settings;
  RosMiddleware middleware;
  RosOdometry odometry;
  RosTopics topics;

  std::deque<Frame> waiting;
  std::string imu_frame;
  bool base_is_known = false, imu_axes_are_known = false;
  std::int64_t last_imu_ns = 0;
  std::optional<SteadyClock::time_point> last_arrival;  // of a frame
  std::string camera_frame;

  RosEstimate estimate;
  std::uint64_t frames = 0, without_pose = 0, dropped = 0, poses_set = 0;
  std::string waits_for, camera_wanted, complaint;
  SteadyClock::time_point complained;
};

RosNode::RosNode(const RosNodeSettings& settings, RosMiddleware middleware)
    : state_(std::make_unique<State>(settings, std::move(middleware))) {}
RosNode::~RosNode() = default;

std::uint32_t RosNode::queue_length() const {
  return static_cast<std::uint32_t>(std::max(1, state_->settings.queue_size));
}

std::string RosNode::start() {
  State& state = *state_;
  const RosNodeSettings& settings = state.settings;
  if (!settings.base_camera.empty()) {
    const auto n = numbers_of(settings.base_camera, 7);
    if (!n) return "base_camera must be seven numbers: tx ty tz qx qy qz qw";
    const auto& v = *n;
    const std::string wrong = state.odometry.set_base_camera({{v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]}});
    if (!wrong.empty()) return "base_camera: " + wrong;
    state.base_is_known = true;
  }
  if (!settings.camera_imu.empty()) {
    const auto q = numbers_of(settings.camera_imu, 4);
    if (!q) return "camera_imu must be four numbers: qx qy qz qw";
    const std::string wrong = state.odometry.set_imu_axes({(*q)[0], (*q)[1], (*q)[2], (*q)[3]});
    if (!wrong.empty()) return "camera_imu: " + wrong;
    state.imu_axes_are_known = true;
  }
  if (settings.odometry.level && !settings.odometry.imu)
    return "level is by the accelerometer of imu: set that, too";
  if (!(settings.max_interval_s >= 0)) return "max_interval_s must not be negative";
  return "";
}

void RosNode::set_topics(const RosTopics& topics) {
  State& state = *state_;
  state.topics = topics;
  state.camera_wanted = "images wait for camera_info on " + topics.camera_info;
  state.waits_for =
      "no images with stamps that belong together have come on " + topics.colour + " and " + topics.depth;
}

void RosNode::add_camera_info(const RosMessage& camera_info) {
  state_->take_camera_info(state_->odometry.set_camera(camera_info));
}

void RosNode::add_camera_info(const RosCameraInfo& camera_info) {
  state_->take_camera_info(state_->odometry.set_camera(camera_info));
}

void RosNode::State::take_camera_info(const std::string& wrong) {
  complain(wrong);
  if (!wrong.empty() && !odometry.has_camera()) waits_for = camera_wanted = wrong;
  track_waiting();
}

void RosNode::add_imu(const RosMessage& imu, const std::string& frame) {
  std::int64_t stamp_ns = 0;
  const std::string wrong = state_->odometry.add_imu(imu, stamp_ns);
  state_->take_imu(wrong, stamp_ns, frame);
}

void RosNode::add_imu(const RosImu& imu, const std::string& frame) {
  state_->take_imu(state_->odometry.add_imu(imu), imu.stamp_ns, frame);
}

void RosNode::State::take_imu(const std::string& wrong, std::int64_t stamp_ns, const std::string& frame) {
  imu_frame = frame;
  complain(wrong);
  last_imu_ns = std::max(last_imu_ns, stamp_ns);
  track_waiting();
}

void RosNode::add_frame(std::int64_t stamp_ns, const std::string& camera_frame, Track track) {
  State& state = *state_;
  state.camera_frame = camera_frame;
  state.last_arrival = SteadyClock::now();
  state.waiting.push_back({stamp_ns, camera_frame, std::move(track), *state.last_arrival});
  state.track_waiting();
  if (state.waiting.size() <= queue_length()) return;
  state.waiting.pop_front();
  ++state.dropped;
}

void RosNode::poll() { state_->track_waiting(); }

// Frames wait for camera_info, for the place of the camera, and for a reading of the IMU that is later.
void RosNode::State::track_waiting() {
  while (!waiting.empty() && can_track(waiting.front())) {
    const Frame frame = std::move(waiting.front());
    waiting.pop_front();
    publish(frame.track(odometry));
  }
}

bool RosNode::State::can_track(const Frame& frame) {
  if (!odometry.has_camera()) return wait_for(camera_wanted);
  if (!base_is_known) {
    const auto place = look_up(settings.base_frame, frame.camera_frame, "base_camera");
    if (!place) return false;
    complain(odometry.set_base_camera(*place));
    base_is_known = true;
  }
  if (settings.odometry.imu && !imu_axes_are_known) {
    if (imu_frame.empty()) return wait_for("images wait for a reading of the IMU on " + topics.imu);
    const auto turn = look_up(frame.camera_frame, imu_frame, "camera_imu");
    if (!turn) return false;
    complain(odometry.set_imu_axes(turn->orientation));
    imu_axes_are_known = true;
  }
  waits_for.clear();
  return !settings.odometry.imu || last_imu_ns > frame.stamp_ns ||
         seconds_since(frame.arrival) > settings.imu_wait_s;
}

bool RosNode::State::wait_for(const std::string& what) {
  waits_for = what;
  complain(what);
  return false;
}

std::optional<RosPose> RosNode::State::look_up(const std::string& target, const std::string& source,
                                               const char* parameter) {
  const auto found = middleware.look_up(target, source);
  if (!found)
    wait_for("images wait for a transform from " + source + " to " + target +
             ": publish it, or set the parameter " + parameter);
  return found;
}

void RosNode::State::publish(const RosEstimate& next) {
  ++frames;
  if (!next.has_pose) ++without_pose;
  const bool news = next.state != estimate.state;
  estimate = next;
  if (news) {
    middleware.log(next.reason.empty() ? RosLevel::kOk : RosLevel::kWarn, sentence(next.state, next.reason));
    diagnose();
  }
  if (next.has_pose) middleware.publish(next);
}

void RosNode::diagnose() { state_->diagnose(); }

void RosNode::State::diagnose() {
  const double silence_s = last_arrival ? seconds_since(*last_arrival) : 0;
  if (silence_s > kSilence_s)
    waits_for = "no images have come for " + std::to_string(static_cast<int>(silence_s)) + " s";
  const bool waits = !waits_for.empty();
  const std::string state = waits ? "waiting" : estimate.state;
  const std::string reason = waits ? waits_for : estimate.reason;
  RosDiagnosis diagnosis;
  diagnosis.message = sentence(state, reason);
  diagnosis.hardware_id = camera_frame;
  if (waits || !estimate.has_pose || state == "predicted") diagnosis.level = RosLevel::kWarn;
  if (state == "error") diagnosis.level = RosLevel::kError;
  diagnosis.values = {{"state", state},
                      {"reason", reason},
                      {"world", std::to_string(estimate.world)},
                      {"frames", std::to_string(frames)},
                      {"frames without a pose", std::to_string(without_pose)},
                      {"frames dropped while they waited", std::to_string(dropped)},
                      {"inliers, points", std::to_string(estimate.points)},
                      {"inliers, lines", std::to_string(estimate.lines)},
                      {"poses set", std::to_string(poses_set)}};
  middleware.diagnose(diagnosis);
}

std::string RosNode::reset() {
  state_->odometry.reset();
  state_->waiting.clear();
  state_->last_imu_ns = 0;
  return "the next frame is the first one";
}

void RosNode::set_pose(const std::string& frame, const RosPose& T_odom_base,
                       const RosCovariance& covariance) {
  State& state = *state_;
  const std::string& odom = state.settings.odom_frame;
  if (!frame.empty() && frame != odom)
    return state.complain("set_pose: the pose is in " + frame + ", not in " + odom);
  const std::string wrong = state.odometry.set_pose(T_odom_base, covariance);
  state.complain(wrong);
  if (wrong.empty()) ++state.poses_set;
  state.diagnose();
}

// A message that may come again with every frame: logged when it is new, and then every few seconds.
void RosNode::State::complain(const std::string& text) {
  if (text.empty()) return;
  if (text == complaint && seconds_since(complained) < kComplaintPeriod_s) return;
  complaint = text;
  complained = SteadyClock::now();
  middleware.log(RosLevel::kWarn, text);
}

}  // namespace plvo
