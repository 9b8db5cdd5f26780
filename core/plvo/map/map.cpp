// SPDX-License-Identifier: Apache-2.0
#include "plvo/map/map.hpp"

#include <algorithm>

#include "plvo/base/heap_sort.hpp"
#include "plvo/math/mahalanobis.hpp"
#include "plvo/math/trigonometry.hpp"

namespace plvo {
namespace {

// This many keyframes in a row show the same place anyway, so no loops are searched among them.
constexpr std::uint32_t kRecentKeyframes = 5;
// The hypotheses of this many keyframes in a row are compared with each other.
constexpr std::uint32_t kJudgedKeyframes = 10;
// The votes that a keyframe needs to be compared. The index finds 40 % of the matches, and a comparison needs
// twelve inliers. How many other keyframes the votes are divided among does not matter: a place that is seen
// often is in many of them.
constexpr std::uint16_t kLeastVotes = 6;
// While the place is unknown, the score of a single descriptor that votes for the keyframe alone suffices.
constexpr std::uint32_t kLeastScoreUnknown = PlaceIndex::kWholeVote;
// A keyframe is compared with this many views that have the most votes, then judged. While the place is
// unknown, more views follow, until the place is recognised or the latest ones show nothing.
constexpr std::size_t kFirstCandidates = 4;
// For each of this many pixels one more comparison is made in a frame while the place is unknown.
constexpr int kPixelsOfAComparison = 320 * 240;
// Views near a hypothesis differ from it by less than this; see view_distance_between().
constexpr float kNearView = 2;
// A view with fewer points than this is not worth a comparison.
constexpr std::size_t kLeastPoints = 20;
// A place is recognised when this many hypotheses agree, with this many inliers together. Hypotheses of a
// room that looks alike have few inliers each.
constexpr int kLeastAgreeing = 3, kLeastInliersTogether = 120;
// A hypothesis that contradicts them counts if it has this share of their inliers.
constexpr double kRivalShare = 0.5;
// The covariances of the odometry state its errors within this factor of the variances.
constexpr double kCovarianceSlack = 4;
// Variances of the motion between two worlds, where nothing is known of it (m², rad²).
constexpr double kUnknownPosition_m2 = 1e4, kUnknownRotation_rad2 = 10;
// Two views are of the same place if the camera moved by less than this share of the scene's depth, or turned
// by less than this angle; see view_distance_between().
constexpr double kSameViewMove = 0.5, kSameViewTurn_rad = 0.5;
// A motion more uncertain than this counts as unobserved: keyframes before it are not recent, and two
// hypotheses whose difference is more uncertain neither agree nor contradict.
constexpr VarianceBounds kObservedMotion{.position_m2 = 0.1, .orientation_rad2 = 0.1};
// A place more uncertain than this is as good as unknown: the camera was carried, or lost for seconds.
constexpr VarianceBounds kKnownPlace{.position_m2 = 1, .orientation_rad2 = 1};
// A keyframe whose view differs by less than this from the one before does not join the map: nearly all such
// pairs are recognised anyway. See view_distance_between().
constexpr float kNewView = 0.1F;
// Neighbours that are searched anew for each frame.
constexpr int kRefreshedPerFrame = 2;

// Whether δ is within a covariance whose variances are this many times as large.
bool lies_within(const Vector6& delta, const Matrix6& covariance, double slack) {
  return mahalanobis_squared<6>(delta, covariance) <= slack * kMostPlausibleMotion;
}

// Comparisons in a frame while the place is unknown. The features that a keyframe keeps bound the work of
// each; the odometry's work grows with the pixels.
int comparisons_if_unknown(const CameraModel& camera) {
  return 1 + camera.width * camera.height / kPixelsOfAComparison;
}

// How much two views differ, by the translation as a share of the scene's depth and by the angle. Below 1
// they show the same.
float view_distance_between(const Se3& A, const Se3& B, float depth_m) {
  const double depth = static_cast<double>(depth_m);
  const double move = (A.t - B.t).squaredNorm() / (kSameViewMove * kSameViewMove * depth * depth);
  // 2 (1 − cos θ) ≈ θ².
  const double cos_turn = 0.5 * (A.R.cwiseProduct(B.R).sum() - 1);
  const double turn = 2 * (1 - cos_turn) / (kSameViewTurn_rad * kSameViewTurn_rad);
  return static_cast<float>(sqrt(std::max(0.0, move + turn)));
}

// Removes the elements among the first `count` for which `is_gone` holds; the others keep their order.
template <typename Array, typename IsGone>
void remove_those(Array& array, std::size_t& count, const IsGone& is_gone) {
  const auto end = array.begin() + static_cast<std::ptrdiff_t>(count);
  count = static_cast<std::size_t>(std::remove_if(array.begin(), end, is_gone) - array.begin());
}

}  // namespace

Status Map::init(std::span<std::byte> memory, const CameraModel& camera, const Config& config,
                 const MapLimits& limits) {
  ready_ = false;
  if (Status status = camera.validate(); !status.ok()) return status;
  if (Status status = config.validate(); !status.ok()) return status;
  if (Status status = limits.validate(); !status.ok()) return status;
  if (const std::size_t bytes = required_bytes(limits, camera.width, camera.height); memory.size() < bytes)
    return Status(StatusCode::kOutOfMemory, "the map needs a block of ")
        .append(static_cast<std::ptrdiff_t>(bytes))
        .append(" bytes for these MapLimits, got ")
        .append(static_cast<std::ptrdiff_t>(memory.size()));
  arena_ = Arena(memory);
  memory_.allocate(arena_, limits);
  arena_.seal();
  check_ = LoopCheck(camera, config);
  clear();
  counts_ = {};
  ready_ = true;
  return {};
}

void Map::clear() {
  memory_.features.clear();
  memory_.index.clear();
  memory_.graph.clear();
  std::fill(memory_.neighbours.begin(), memory_.neighbours.end(), MapMemory::Neighbour());
  candidate_count_ = to_compare_ = hypothesis_count_ = refreshed_ = 0;
  is_searching_ = follows_camera_ = refines_velocity_ = false;
  loop_variance_ = 0;
  since_loop_.setZero();
}

MapResult Map::update(const Odometry& odometry, const TrackResult& result) {
  MapResult out;
  const KeyframeView view = odometry.keyframe();
  if (!ready_) return out;
  // Nothing is known of the motion between two worlds. The second condition finds the first world of an
  // odometry that was initialised anew.
  if (result.world != world_ || (result.state == TrackState::kInitialising && !result.restarted))
    follows_camera_ = refines_velocity_ = false;
  world_ = result.world;
  if (view.features != nullptr && view.features->points.described &&
      (!follows_camera_ || view.features->stamp_ns != seen_.stamp_ns))
    see_keyframe(view, result, out);
  else
    continue_work(view, out);
  if (!follows_camera_) return out;
  const PoseGraph::Node& latest = memory_.graph.node(memory_.graph.last());
  if (view.features != nullptr && view.features->stamp_ns == seen_.stamp_ns)
    seen_.T_world_camera = view.T_world_camera;
  const Se3 T_seen_camera = seen_.T_world_camera.inverse() * result.T_world_camera;
  out.located = located();
  out.keyframe = latest.id;
  out.T_map_world = latest.T_map_keyframe * seen_.T_keyframe_camera * seen_.T_world_camera.inverse();
  out.T_map_world.R = renormalise(out.T_map_world.R);
  out.T_keyframe_camera = seen_.T_keyframe_camera * T_seen_camera;
  const bool moved_since = result.reference_stamp_ns == seen_.stamp_ns;
  const Matrix6 of_motion = moved_since
                                ? inverse_covariance(result.T_camera_reference, result.motion_covariance)
                                : Matrix6(Matrix6::Zero());
  const Matrix6 since_keyframe =
      compose_covariance(seen_.T_keyframe_camera, seen_.covariance, T_seen_camera, of_motion);
  out.pose_covariance =
      compose_covariance(latest.T_map_keyframe, about_position(latest.covariance, latest.T_map_keyframe.t),
                         out.T_keyframe_camera, since_keyframe);
  (void)make_bounded_covariance(out.pose_covariance);
  return out;
}

// The work of a frame in which no keyframe joins.
void Map::continue_work(const KeyframeView& view, MapResult& out) {
  if (refines_velocity_ && view.features != nullptr && view.features->stamp_ns == keyframe_stamp_ns_)
    memory_.features.set(memory_.graph.last(), view.features->points, view.features->lines, check_.camera,
                         view.velocity);
  refines_velocity_ = false;
  search_on(out);
  memory_.graph.step();
  for (int i = 0; i < kRefreshedPerFrame && memory_.graph.size() > 0; ++i) {
    refreshed_ = (refreshed_ + 1) % memory_.graph.size();
    find_neighbour(memory_.graph.slot_at(refreshed_));
  }
}

// The motion from the odometry's keyframe before is its measurement, if the frame was matched with that
// keyframe. Otherwise it is the difference of the poses, with their uncertainty; between two worlds nothing
// is known of it.
void Map::see_keyframe(const KeyframeView& view, const TrackResult& result, MapResult& out) {
  const std::int64_t stamp_ns = view.features->stamp_ns;
  const bool measured = result.state == TrackState::kTracking && result.stamp_ns == stamp_ns &&
                        result.reference_stamp_ns == seen_.stamp_ns;
  Se3 T_previous_this;
  Matrix6 covariance = Matrix6::Zero();
  if (memory_.graph.size() == 0) {
    T_previous_this = view.T_world_camera;  // the map begins as the world
  } else if (!follows_camera_) {
    covariance.diagonal().head<3>().setConstant(kUnknownPosition_m2);
    covariance.diagonal().tail<3>().setConstant(kUnknownRotation_rad2);
  } else if (measured) {
    T_previous_this = result.T_camera_reference.inverse();
    covariance = inverse_covariance(result.T_camera_reference, result.motion_covariance);
  } else {
    T_previous_this = seen_.T_world_camera.inverse() * view.T_world_camera;
    covariance = compose_covariance(seen_.T_world_camera.inverse(),
                                    inverse_covariance(seen_.T_world_camera, seen_.world_covariance),
                                    view.T_world_camera, result.pose_covariance);
  }
  if (!follows_camera_) seen_ = {};
  seen_.covariance =
      compose_covariance(seen_.T_keyframe_camera, seen_.covariance, T_previous_this, covariance);
  seen_.T_keyframe_camera = seen_.T_keyframe_camera * T_previous_this;
  seen_.T_keyframe_camera.R = renormalise(seen_.T_keyframe_camera.R);
  seen_.stamp_ns = stamp_ns;
  seen_.T_world_camera = view.T_world_camera;
  seen_.world_covariance = result.pose_covariance;
  if (shows_the_latest_view())
    continue_work(view, out);
  else
    add_keyframe(view, out);
}

// Whether the odometry's keyframe shows nearly what the latest one of the map shows, in a known place.
bool Map::shows_the_latest_view() const {
  if (!follows_camera_ || memory_.graph.size() == 0) return false;
  const std::uint16_t last = memory_.graph.last();
  return place_is_known(last) && !exceeds(seen_.covariance, kObservedMotion) &&
         view_distance_between(Se3(), seen_.T_keyframe_camera, memory_.depths[last]) < kNewView;
}

void Map::add_keyframe(const KeyframeView& view, MapResult& out) {
  const FrameFeatures& features = *view.features;
  Se3 T_previous_this = seen_.T_keyframe_camera;
  Matrix6 covariance = seen_.covariance;
  seen_.T_keyframe_camera = Se3();
  seen_.covariance.setZero();
  // A search goes on to its end, unless the motion from its keyframe is not observed.
  if (exceeds(covariance, kObservedMotion)) {
    if (is_searching_) judge(out);
    is_searching_ = false;
    // No observed motion leads to the hypotheses from before.
    hypothesis_count_ = 0;
  }
  // Read before a keyframe is removed, because that may be the latest one.
  const bool begins_part = memory_.graph.size() == 0 || !follows_camera_;
  const std::uint32_t part =
      begins_part ? memory_.graph.next_id() : memory_.graph.node(memory_.graph.last()).part;
  if (memory_.graph.size() > 0) {
    const Se3& T_map_last = memory_.graph.node(memory_.graph.last()).T_map_keyframe;
    since_loop_ += motion_in_map(T_map_last, T_previous_this, covariance);
  }
  if (memory_.graph.full()) {
    const std::uint16_t goes = least_needed();
    if (goes == memory_.graph.last()) {
      // The motion is then that from the keyframe before it.
      const PoseGraph::Node& last = memory_.graph.node(goes);
      covariance =
          compose_covariance(last.T_previous_keyframe, last.motion_covariance, T_previous_this, covariance);
      T_previous_this = last.T_previous_keyframe * T_previous_this;
    }
    remove(goes, out);
  }
  const std::uint16_t slot = memory_.graph.append(T_previous_this, covariance, part);
  memory_.features.set(slot, features.points, features.lines, check_.camera, view.velocity);
  measure_depth(slot);
  memory_.index.add(all_descriptors(), slot, memory_.features.at(slot).descriptors.size());
  find_neighbour(slot);
  ++counts_.keyframes;
  follows_camera_ = true;
  refines_velocity_ = check_.camera.readout_s > 0;
  keyframe_stamp_ns_ = features.stamp_ns;
  if (is_searching_) {
    memory_.excluded[slot] = 1;
    search_on(out);
  } else if (!place_is_known(slot) || generalised_variance(since_loop_) > loop_variance_) {
    find_candidates(slot);
  }
}

void Map::search_on(MapResult& out) {
  if (to_compare_ > 0) {
    const int most = place_is_known(searched_) ? 1 : comparisons_if_unknown(check_.camera);
    for (int i = 0; i < most && to_compare_ > 0; ++i) compare_next();
  } else if (is_searching_) {
    judge(out);
  }
}

void Map::measure_depth(std::uint16_t slot) {
  const std::span<const MapPoint> points = memory_.features.at(slot).points;
  const ScratchScope scope(arena_);
  const std::span<float> depths = arena_.take<float>("map check", points.size());
  memory_.depths[slot] = 1;
  if (depths.empty()) return;
  for (std::size_t i = 0; i < points.size(); ++i) depths[i] = points[i].depth_m;
  heap_sort(depths.data(), depths.data() + depths.size(), [](float a, float b) { return a < b; });
  memory_.depths[slot] = depths[depths.size() / 2];
}

bool Map::settle() {
  MapResult out;
  while (is_searching_) search_on(out);
  while (!memory_.graph.idle()) memory_.graph.step();
  return out.recognised;
}

// Unknown for views of different parts of the map.
float Map::view_distance(std::uint16_t a, std::uint16_t b) const {
  if (memory_.graph.node(a).part != memory_.graph.node(b).part) return MapMemory::Neighbour::kUnknown;
  return view_distance_between(memory_.graph.node(a).T_map_keyframe, memory_.graph.node(b).T_map_keyframe,
                               std::min(memory_.depths[a], memory_.depths[b]));
}

// Finds the neighbour of a node, and makes the node the neighbour of those nodes whose present neighbour is
// farther from them.
void Map::find_neighbour(std::uint16_t slot) {
  MapMemory::Neighbour nearest;
  for (std::size_t k = 0; k < memory_.graph.size(); ++k) {
    const std::uint16_t other = memory_.graph.slot_at(k);
    if (other == slot) continue;
    const float distance = view_distance(slot, other);
    if (distance < nearest.distance) nearest = {distance, other};
    if (distance < memory_.neighbours[other].distance) memory_.neighbours[other] = {distance, slot};
  }
  memory_.neighbours[slot] = nearest;
}

// Whether hypotheses of a keyframe can still be judged together with those of the latest one.
bool Map::is_recent(std::uint16_t slot) const {
  return memory_.graph.node(slot).id + kJudgedKeyframes >= memory_.graph.node(memory_.graph.last()).id;
}

bool Map::was_just_recognised() const {
  const std::span<const Hypothesis> all = hypotheses();
  return std::any_of(all.begin(), all.end(),
                     [this](const Hypothesis& h) { return h.joined && is_recent(h.new_slot); });
}

// Whether a keyframe is searched, or waits for others that agree with it.
bool Map::is_in_use(std::uint16_t slot) const {
  if (is_searching_ && slot == searched_) return true;
  if (!is_recent(slot)) return false;
  const std::span<const Hypothesis> all = hypotheses();
  return std::any_of(all.begin(), all.end(),
                     [slot](const Hypothesis& h) { return h.new_slot == slot && !h.joined; });
}

// The keyframe that a full map removes. It is the later one of the two whose views differ least, but never
// the first keyframe, which defines the map, nor one that is in use. If no two views show the same place, it
// is the latest keyframe: the old places stay.
std::uint16_t Map::least_needed() const {
  std::uint16_t least = memory_.graph.last();
  float distance = 1;
  for (std::size_t k = 1; k < memory_.graph.size(); ++k) {
    const std::uint16_t slot = memory_.graph.slot_at(k);
    if (memory_.neighbours[slot].distance >= distance) continue;
    const std::uint16_t other = memory_.neighbours[slot].slot;
    const std::uint16_t later = memory_.graph.node(other).position > k ? other : slot;
    if (is_in_use(later)) continue;
    distance = memory_.neighbours[slot].distance;
    least = later;
  }
  return least;
}

void Map::remove(std::uint16_t slot, MapResult& out) {
  memory_.index.remove(all_descriptors(), slot, memory_.features.at(slot).descriptors.size());
  out.removed = memory_.graph.node(slot).id;
  const PoseGraph::Removed removed = memory_.graph.remove(slot);
  out.removed_into = memory_.graph.node(removed.into).id;
  out.T_into_removed = removed.T_into_removed;
  ++counts_.removed;
  memory_.neighbours[slot] = MapMemory::Neighbour();
  for (MapMemory::Neighbour& neighbour : memory_.neighbours)
    if (neighbour.slot == slot) neighbour = MapMemory::Neighbour();  // until it is searched anew
  drop_candidate(slot);
  if (slot == searched_) {
    candidate_count_ = to_compare_ = 0;
    is_searching_ = false;
  }
  const auto gone = [slot](const Hypothesis& h) { return h.old_slot == slot || h.new_slot == slot; };
  remove_those(hypotheses_, hypothesis_count_, gone);
}

bool Map::place_is_known(std::uint16_t slot) const {
  return memory_.graph.is_placed(slot) && !memory_.graph.is_uncertain(slot, kKnownPlace);
}

void Map::find_candidates(std::uint16_t slot) {
  std::fill(memory_.excluded.begin(), memory_.excluded.end(), std::uint8_t{0});
  const std::uint32_t id = memory_.graph.node(slot).id;
  for (std::size_t k = memory_.graph.size(); k-- > 0;) {
    const PoseGraph::Node& node = memory_.graph.node(memory_.graph.slot_at(k));
    if (node.id + kRecentKeyframes < id) break;
    memory_.excluded[memory_.graph.slot_at(k)] = 1;
    if (exceeds(node.motion_covariance, kObservedMotion)) break;
  }
  const bool is_known = place_is_known(slot);
  const std::span<PlaceCandidate> room(candidates_);
  FixedVector<PlaceCandidate> best(room.first(is_known ? kFirstCandidates : kVotedCandidates));
  memory_.index.query(all_descriptors(), memory_.features.at(slot).descriptors, memory_.excluded, best);
  candidate_count_ = 0;
  for (const PlaceCandidate& candidate : best)
    if (is_known ? candidate.votes >= kLeastVotes : candidate.score >= kLeastScoreUnknown) ++candidate_count_;
  searched_ = slot;
  is_promising_ = true;
  is_searching_ = candidate_count_ > 0;
  to_compare_ =
      std::min(candidate_count_, is_known && was_just_recognised() ? std::size_t{1} : kFirstCandidates);
  std::reverse(candidates_.begin(), candidates_.begin() + static_cast<std::ptrdiff_t>(candidate_count_));
}

// Where places were recognised up to now, one more view is compared before the next judgement. While the
// place is unknown, these are the views near the pose that the best hypothesis gives or, without one, those
// with the next most votes.
void Map::look_further() {
  is_searching_ = false;
  std::size_t count = 1;
  if (!place_is_known(searched_)) {
    if (!is_promising_) return;
    is_promising_ = false;
    if (const Hypothesis* best = best_hypothesis())
      add_views_near(pose_after(*best), memory_.graph.node(best->old_slot).part, memory_.depths[searched_]);
    count = kMoreCandidates;
  }
  to_compare_ = std::min(candidate_count_, count);
  is_searching_ = to_compare_ > 0;
}

// The pose in the map that the hypothesis gives the keyframe whose place is searched.
Se3 Map::pose_after(const Hypothesis& h) const {
  const Se3 T_map_new = memory_.graph.node(h.old_slot).T_map_keyframe * h.loop.T_old_new;
  return T_map_new * memory_.graph.node(h.new_slot).T_map_keyframe.inverse() *
         memory_.graph.node(searched_).T_map_keyframe;
}

// The nearest ones that were not compared come before the other candidates.
void Map::add_views_near(const Se3& T_map_camera, std::uint32_t part, float depth_m) {
  std::array<PlaceCandidate, kMoreCandidates> nearest;
  std::array<float, kMoreCandidates> distances;
  distances.fill(kNearView);
  std::size_t count = 0;
  for (std::size_t k = 0; k < memory_.graph.size(); ++k) {
    const std::uint16_t slot = memory_.graph.slot_at(k);
    const PoseGraph::Node& node = memory_.graph.node(slot);
    if (memory_.excluded[slot] != 0 || node.part != part ||
        memory_.features.at(slot).points.size() < kLeastPoints)
      continue;
    const float distance =
        view_distance_between(T_map_camera, node.T_map_keyframe, std::min(depth_m, memory_.depths[slot]));
    std::size_t at = count;
    while (at > 0 && distances[at - 1] > distance) --at;
    if (at == kMoreCandidates || distance >= kNearView) continue;
    count = std::min(count + 1, kMoreCandidates);
    for (std::size_t i = count - 1; i > at; --i) {
      distances[i] = distances[i - 1];
      nearest[i] = nearest[i - 1];
    }
    distances[at] = distance;
    nearest[at] = {slot, 0, 0};
  }
  for (std::size_t i = count; i-- > 0;) {
    const std::uint16_t slot = nearest[i].slot;
    memory_.excluded[slot] = 1;
    drop_candidate(slot);
    candidates_[candidate_count_++] = nearest[i];
  }
}

void Map::drop_candidate(std::uint16_t slot) {
  remove_those(candidates_, candidate_count_, [slot](const PlaceCandidate& c) { return c.slot == slot; });
  to_compare_ = std::min(to_compare_, candidate_count_);
}

// Compares the keyframe with the most promising candidate that is left.
void Map::compare_next() {
  Hypothesis latest;
  --to_compare_;
  const PlaceCandidate candidate = candidates_[--candidate_count_];
  latest.old_slot = candidate.slot;
  memory_.excluded[latest.old_slot] = 1;
  latest.new_slot = searched_;
  ++counts_.compared;
  Se3 T_new_old;
  // A view that a hypothesis led to has no votes.
  const Hypothesis* guide = candidate.score == 0 ? best_hypothesis() : nullptr;
  if (guide != nullptr)
    T_new_old = pose_after(*guide).inverse() * memory_.graph.node(latest.old_slot).T_map_keyframe;
  latest.loop = check_(memory_.features.at(latest.old_slot), memory_.features.at(latest.new_slot), arena_,
                       guide != nullptr ? &T_new_old : nullptr);
  const bool is_accepted = latest.loop.found && plausible(latest);
  if (is_accepted) keep(latest);
  const bool is_worth_judging = may_suffice() && (is_accepted || !place_is_known(searched_));
  if (to_compare_ == 0 && !is_worth_judging) look_further();
}

void Map::keep(const Hypothesis& hypothesis) {
  ++counts_.accepted;
  is_promising_ = true;
  if (hypothesis_count_ == kHypotheses) {
    std::move(hypotheses_.begin() + 1, hypotheses_.end(), hypotheses_.begin());
    --hypothesis_count_;
  }
  hypotheses_[hypothesis_count_++] = hypothesis;
}

// Whether there are enough hypotheses, if all agree.
bool Map::may_suffice() const {
  int inliers = 0;
  for (const Hypothesis& h : hypotheses()) inliers += h.loop.inliers;
  return hypothesis_count_ >= kLeastAgreeing && inliers >= kLeastInliersTogether;
}

// The best hypothesis of the newest keyframe that has any.
const Map::Hypothesis* Map::best_hypothesis() const {
  const Hypothesis* best = nullptr;
  for (const Hypothesis& h : hypotheses())
    if (h.new_slot == hypotheses().back().new_slot &&
        (best == nullptr || h.loop.inliers > best->loop.inliers))
      best = &h;
  return best;
}

// Whether the motion lies within the map's own uncertainty: that along the chain between the two keyframes,
// or that of their poses relative to the first keyframe, whichever is smaller.
bool Map::plausible(const Hypothesis& h) const {
  const PoseGraph::Node& a = memory_.graph.node(h.old_slot);
  const PoseGraph::Node& b = memory_.graph.node(h.new_slot);
  const Vector3& t = b.T_map_keyframe.t;
  const Matrix6 covariance = about_position(
      between(h.old_slot, h.new_slot) + motion_in_map(a.T_map_keyframe, h.loop.T_old_new, h.loop.covariance),
      t);
  return lies_within(boxminus(a.T_map_keyframe * h.loop.T_old_new, b.T_map_keyframe), covariance,
                     kCovarianceSlack);
}

// Covariance of the perturbation x_b − x_a.
Matrix6 Map::between(std::uint16_t a, std::uint16_t b) const {
  const Matrix6 chain = memory_.graph.chain_covariance(a, b);
  const Matrix6 both = memory_.graph.node(a).covariance + memory_.graph.node(b).covariance;
  return generalised_variance(chain) < generalised_variance(both) ? chain : both;
}

// Each of two hypotheses gives the latest part of the map a pose. They agree if these poses do, and
// contradict each other if the poses differ by more than the slack allows.
Map::Relation Map::compare(const Hypothesis& a, const Hypothesis& b) const {
  const PoseGraph::Node& new_a = memory_.graph.node(a.new_slot);
  const PoseGraph::Node& new_b = memory_.graph.node(b.new_slot);
  if (new_a.id + kJudgedKeyframes < new_b.id || new_b.id + kJudgedKeyframes < new_a.id)
    return Relation::kUnrelated;
  const Se3& old_a = memory_.graph.node(a.old_slot).T_map_keyframe;
  const Se3& old_b = memory_.graph.node(b.old_slot).T_map_keyframe;
  const Se3 by_a = old_a * a.loop.T_old_new * new_a.T_map_keyframe.inverse() * new_b.T_map_keyframe;
  const Se3 by_b = old_b * b.loop.T_old_new;
  // The sum of the covariances of both loops, of the map between the old views and, rotated by the
  // loop, of the motion between the new views.
  Matrix6 covariance = about_position(between(a.old_slot, b.old_slot) +
                                          motion_in_map(old_a, a.loop.T_old_new, a.loop.covariance) +
                                          motion_in_map(old_b, b.loop.T_old_new, b.loop.covariance),
                                      by_b.t);
  const Matrix3 turn = by_b.R * new_b.T_map_keyframe.R.transpose();
  const Matrix6 of_new =
      about_position(memory_.graph.chain_covariance(a.new_slot, b.new_slot), new_b.T_map_keyframe.t);
  covariance += transform_covariance(rotation_of_both(turn), of_new);
  if (exceeds(covariance, kObservedMotion)) return Relation::kUnrelated;
  const Vector6 delta = boxminus(by_a, by_b);
  if (lies_within(delta, covariance, 1)) return Relation::kAgree;
  return lies_within(delta, covariance, kCovarianceSlack) ? Relation::kUnrelated : Relation::kContradict;
}

// Called in the frame after the comparisons, or before a keyframe whose motion was not observed. The best of
// the hypotheses and those that agree with it become loops, if they are enough and no hypothesis contradicts
// them.
void Map::judge(MapResult& out) {
  is_searching_ = false;
  const Hypothesis* best = best_hypothesis();
  if (best == nullptr) return;
  const std::span<Hypothesis> all = std::span(hypotheses_).first(hypothesis_count_);
  int agreeing = 0, inliers = 0;
  std::array<bool, kHypotheses> agrees{};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Relation relation = &all[i] == best ? Relation::kAgree : compare(all[i], *best);
    if (relation == Relation::kContradict && all[i].loop.inliers >= kRivalShare * best->loop.inliers) return;
    agrees[i] = relation == Relation::kAgree;
    agreeing += agrees[i] ? 1 : 0;
    inliers += agrees[i] ? all[i].loop.inliers : 0;
  }
  if (agreeing < kLeastAgreeing || inliers < kLeastInliersTogether) return look_further();
  const LoopMeasurement& loop = best->loop;
  memory_.graph.join_parts(best->old_slot, best->new_slot, loop.T_old_new, loop.covariance);
  const Vector3& t = memory_.graph.node(best->new_slot).T_map_keyframe.t;
  if (exceeds(about_position(between(best->old_slot, best->new_slot), t), kKnownPlace))
    memory_.graph.move_unknown(best->old_slot, best->new_slot, loop.T_old_new, loop.covariance, kKnownPlace);
  for (std::size_t i = 0; i < all.size(); ++i) {
    Hypothesis& h = all[i];
    if (!agrees[i] || h.joined) continue;
    h.joined = true;
    memory_.graph.add_loop(h.old_slot, h.new_slot, h.loop.T_old_new, h.loop.covariance);
    ++counts_.loops;
    out.recognised = true;
  }
  since_loop_ = memory_.graph.chain_covariance(best->new_slot, memory_.graph.last());
  loop_variance_ = generalised_variance(loop.covariance);
}

std::optional<Se3> Map::keyframe_pose(std::uint32_t id) const {
  for (std::size_t k = 0; k < memory_.graph.size(); ++k)
    if (const std::uint16_t slot = memory_.graph.slot_at(k); memory_.graph.node(slot).id == id)
      return memory_.graph.is_placed(slot) ? std::optional(memory_.graph.node(slot).T_map_keyframe)
                                           : std::nullopt;
  return std::nullopt;
}

}  // namespace plvo
