// SPDX-License-Identifier: Apache-2.0
#include "plvo/map/pose_graph.hpp"

#include <algorithm>

#include "plvo/math/cholesky.hpp"
#include "plvo/math/mahalanobis.hpp"

namespace plvo {
namespace {

// Added to the variances of every motion, so that no motion is exact: (0.1 mm)², (0.1 mrad)².
constexpr double kMotionFloor = 1e-8;
// The iterations end when rᵀ C r is below this share of its first value, or below this number.
constexpr double kGainShare = 1e-8, kGainEnough = 1e-6;
// Another linearisation follows where a pose moved by more than this (m, rad).
constexpr double kGraphMoved = 1e-3;
// Motions share a displacement if their generalised variance is this share of the largest: a tenth in each of
// the six variances.
constexpr double kComparable = 1e-6;
constexpr int kSharingRounds = 5;

Se3 displacement(const Vector6& x) { return {rotation_exp(x.tail<3>()), x.head<3>()}; }

// J C Jᵀ of a symmetric C with J = (I lever; 0 I): ρ = v + [t]× ω for a pose at t, and the inverse of that.
Matrix6 transform(const Matrix6& C, const Matrix3& lever) {
  const Matrix3 D = C.block<3, 3>(3, 3);
  const Matrix3 B = C.block<3, 3>(0, 3) + lever * D;
  Matrix6 out;
  out.block<3, 3>(0, 0) = C.block<3, 3>(0, 0) + lever * C.block<3, 3>(3, 0) + B * lever.transpose();
  out.block<3, 3>(0, 3) = B;
  out.block<3, 3>(3, 0) = B.transpose();
  out.block<3, 3>(3, 3) = D;
  return out;
}

Matrix6 rotated(const Matrix6& C, const Matrix3& R) {
  const Matrix3 R_transposed = R.transpose();
  const Matrix3 B = R * Matrix3(C.block<3, 3>(0, 3)) * R_transposed;
  Matrix6 out;
  out.block<3, 3>(0, 0) = R * Matrix3(C.block<3, 3>(0, 0)) * R_transposed;
  out.block<3, 3>(0, 3) = B;
  out.block<3, 3>(3, 0) = B.transpose();
  out.block<3, 3>(3, 3) = R * Matrix3(C.block<3, 3>(3, 3)) * R_transposed;
  return out;
}

// The measured motion from one node to another, given that in either direction.
struct Motion {
  Se3 T;
  Matrix6 covariance;
};
Motion directed(bool forwards, const Se3& T, const Matrix6& covariance) {
  if (forwards) return {T, covariance};
  return {T.inverse(), inverse_covariance(T, covariance)};
}

}  // namespace

Matrix6 about_origin(const Matrix6& covariance, const Vector3& t) { return transform(covariance, skew(t)); }
Matrix6 about_position(const Matrix6& covariance, const Vector3& t) {
  return transform(covariance, -skew(t));
}

Matrix6 motion_in_map(const Se3& T_i, const Se3& T_ij, const Matrix6& covariance) {
  return about_origin(rotated(covariance, T_i.R), T_i * T_ij.t);
}

Vector6 difference(const Se3& T) {
  Vector6 r;
  r.head<3>() = T.t;
  r.tail<3>() = rotation_log(T.R);
  return r;
}

void PoseGraph::clear() {
  for (Node& node : nodes_) node.id = 0;
  size_ = loop_count_ = 0;
  next_id_ = 1;
  kernel_ = RobustKernel(RobustLoss::kHuber, 6);
  phase_ = Phase::kIdle;
  changed_ = false;
}

std::uint16_t PoseGraph::append(const Se3& T_previous_keyframe, const Matrix6& covariance,
                                std::optional<std::uint32_t> part) {
  std::size_t slot = 0;
  while (nodes_[slot].id != 0) ++slot;
  Node& node = nodes_[slot];
  node = Node();
  node.id = next_id_++;
  node.part = part ? *part : size_ > 0 ? at(size_ - 1).part : node.id;
  node.position = static_cast<std::uint16_t>(size_);
  if (size_ > 0) {
    const Node& previous = at(size_ - 1);
    node.T_previous_keyframe = T_previous_keyframe;
    node.motion_covariance = covariance + kMotionFloor * Matrix6::Identity();
    node.T_map_keyframe = previous.T_map_keyframe * T_previous_keyframe;
    node.T_map_keyframe.R = renormalise(node.T_map_keyframe.R);
    set_covariance(node, previous.covariance + motion_in_map(previous.T_map_keyframe, T_previous_keyframe,
                                                             node.motion_covariance));
  }
  if (size_ == 0) node.T_map_keyframe = T_previous_keyframe;
  order_[size_++] = static_cast<std::uint16_t>(slot);
  return static_cast<std::uint16_t>(slot);
}

void PoseGraph::restore(std::uint16_t slot, const Node& node) {
  nodes_[slot] = node;
  nodes_[slot].position = static_cast<std::uint16_t>(size_);
  set_covariance(nodes_[slot], node.covariance);
  order_[size_++] = slot;
  next_id_ = node.id + 1;
}

bool PoseGraph::has_loop(std::uint16_t a, std::uint16_t b) const {
  for (const Loop& loop : loops())
    if ((loop.older == a && loop.newer == b) || (loop.older == b && loop.newer == a)) return true;
  return false;
}

void PoseGraph::add_loop(std::uint16_t a, std::uint16_t b, const Se3& T_a_b, const Matrix6& covariance) {
  if (a == b || has_loop(a, b)) return;
  note_change();
  const bool in_order = nodes_[a].position < nodes_[b].position;
  Loop loop;
  loop.older = in_order ? a : b;
  loop.newer = in_order ? b : a;
  const Motion motion = directed(in_order, T_a_b, covariance);
  loop.T_older_newer = motion.T;
  loop.covariance = motion.covariance + kMotionFloor * Matrix6::Identity();
  keep_loop(loop);
}

void PoseGraph::keep_loop(const Loop& loop) {
  if (loop_count_ < loops_.size()) {
    loops_[loop_count_++] = loop;
    return;
  }
  const auto worst = std::max_element(loops_.begin(), loops_.end(), [](const Loop& l, const Loop& m) {
    return generalised_variance(l.covariance) < generalised_variance(m.covariance);
  });
  if (generalised_variance(worst->covariance) > generalised_variance(loop.covariance)) *worst = loop;
}

void PoseGraph::join_parts(std::uint16_t a, std::uint16_t b, const Se3& T_a_b, const Matrix6& covariance) {
  if (nodes_[a].part == nodes_[b].part) return;
  const bool b_moves = nodes_[a].part < nodes_[b].part;
  const Node& stays = nodes_[b_moves ? a : b];
  Node& moves = nodes_[b_moves ? b : a];
  const std::uint32_t part = moves.part;
  const Motion motion = directed(b_moves, T_a_b, covariance);
  place(stays, moves, motion.T, motion.covariance, [part](const Node& node) { return node.part == part; });
  for (std::size_t k = 0; k < size_; ++k)
    if (at(k).part == part) at(k).part = stays.part;
}

void PoseGraph::move_unknown(std::uint16_t a, std::uint16_t b, const Se3& T_a_b, const Matrix6& covariance,
                             const VarianceBounds& known) {
  if (a == b) return;
  const bool in_order = nodes_[a].position < nodes_[b].position;
  const Node& older = nodes_[in_order ? a : b];
  Node& newer = nodes_[in_order ? b : a];
  std::size_t first = newer.position;
  if (!is_uncertain(order_[first], known)) return;
  note_change();
  double least_certain = generalised_variance(at(first).motion_covariance);
  std::size_t begin = first;  // of the uncertain nodes
  for (std::size_t k = first; k > older.position && is_uncertain(order_[k], known); begin = k--)
    if (const double variance = generalised_variance(at(k).motion_covariance); variance > least_certain) {
      first = k;
      least_certain = variance;
    }
  const Motion motion = directed(in_order, T_a_b, covariance);
  share_out(older, newer, motion.T, begin, kComparable * least_certain);
  place(older, newer, motion.T, motion.covariance,
        [first](const Node& node) { return node.position >= first; });
}

// The unobserved motions between two nodes share the displacement as in the solution of a graph that has no
// other loop: y = C (Σ C)⁻¹ r. Each round is a linearisation.
void PoseGraph::share_out(const Node& older, const Node& newer, const Se3& T_older_newer, std::size_t begin,
                          double least_variance) {
  for (std::size_t k = begin; k <= newer.position; ++k)
    at(k).shares = generalised_variance(at(k).motion_covariance) >= least_variance;
  while (begin < newer.position && !at(begin).shares) ++begin;
  for (int round = 0; round < kSharingRounds; ++round) {
    Matrix6 sum = Matrix6::Zero();
    for (std::size_t k = begin; k <= newer.position; ++k) {
      Node& node = at(k);
      if (!node.shares) continue;
      node.C = motion_in_map(at(k - 1).T_map_keyframe, node.T_previous_keyframe, node.motion_covariance);
      sum += node.C;
    }
    Cholesky<6> cholesky;
    if (!cholesky.factor(sum)) return;
    const Vector6 force =
        cholesky.solve(difference(older.T_map_keyframe * T_older_newer * newer.T_map_keyframe.inverse()));
    Vector6 x = Vector6::Zero();
    for (std::size_t k = begin; k < size_; ++k) {
      Node& node = at(k);
      if (k <= newer.position && node.shares) x += node.C * force;
      node.T_map_keyframe = displacement(x) * node.T_map_keyframe;
      node.T_map_keyframe.R = renormalise(node.T_map_keyframe.R);
    }
  }
}

// Moves the nodes that `is_moved` selects, as a whole, so that `moves` is where the motion from `stays` puts
// it.
template <typename IsMoved>
void PoseGraph::place(const Node& stays, Node& moves, const Se3& T_stays_moves, const Matrix6& of_motion,
                      const IsMoved& is_moved) {
  note_change();
  const Se3 displacement = stays.T_map_keyframe * T_stays_moves * moves.T_map_keyframe.inverse();
  for (std::size_t k = 0; k < size_; ++k) {
    Node& node = at(k);
    if (!is_moved(node)) continue;
    node.T_map_keyframe = displacement * node.T_map_keyframe;
    node.T_map_keyframe.R = renormalise(node.T_map_keyframe.R);
  }
  set_covariance(moves, stays.covariance + motion_in_map(stays.T_map_keyframe, T_stays_moves, of_motion));
  relax_along_chain();
}

bool PoseGraph::is_uncertain(std::uint16_t slot, const VarianceBounds& known) const {
  return exceeds(about_position(nodes_[slot].covariance, nodes_[slot].T_map_keyframe.t), known);
}

PoseGraph::Removed PoseGraph::remove(std::uint16_t slot) {
  note_change();
  Node& node = nodes_[slot];
  const std::size_t position = node.position;
  const bool has_previous = position > 0, has_next = position + 1 < size_;
  Node* const next = has_next ? &at(position + 1) : nullptr;
  const bool into_next = has_next && (!has_previous || generalised_variance(next->motion_covariance) <=
                                                           generalised_variance(node.motion_covariance));
  Removed removed;
  removed.slot = slot;
  removed.into = order_[into_next ? position + 1 : position - 1];
  removed.T_into_removed = nodes_[removed.into].T_map_keyframe.inverse() * node.T_map_keyframe;

  // Moves the loops of the removed node to its neighbour, by the measured motion between the two.
  const Se3 T_slot_into = into_next ? next->T_previous_keyframe : node.T_previous_keyframe.inverse();
  const Matrix6 C_slot_into = into_next
                                  ? next->motion_covariance
                                  : inverse_covariance(node.T_previous_keyframe, node.motion_covariance);
  const std::size_t count = loop_count_;
  loop_count_ = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Loop loop = loops_[i];
    if (loop.older != slot && loop.newer != slot) {
      loops_[loop_count_++] = loop;
      continue;
    }
    const bool removed_is_newer = loop.newer == slot;
    const std::uint16_t other = removed_is_newer ? loop.older : loop.newer;
    const Motion other_slot = directed(removed_is_newer, loop.T_older_newer, loop.covariance);
    if (other == removed.into || has_loop(other, removed.into)) continue;
    const bool in_order = nodes_[other].position < nodes_[removed.into].position;
    const Motion other_into =
        directed(in_order, other_slot.T * T_slot_into,
                 compose_covariance(other_slot.T, other_slot.covariance, T_slot_into, C_slot_into));
    Loop& moved = loops_[loop_count_++];
    moved.older = in_order ? other : removed.into;
    moved.newer = in_order ? removed.into : other;
    moved.T_older_newer = other_into.T;
    moved.covariance = other_into.covariance;
  }

  if (has_previous && has_next) {
    next->motion_covariance = compose_covariance(node.T_previous_keyframe, node.motion_covariance,
                                                 next->T_previous_keyframe, next->motion_covariance);
    next->T_previous_keyframe = node.T_previous_keyframe * next->T_previous_keyframe;
    next->T_previous_keyframe.R = renormalise(next->T_previous_keyframe.R);
  }
  for (std::size_t k = position; k + 1 < size_; ++k) {
    order_[k] = order_[k + 1];
    nodes_[order_[k]].position = static_cast<std::uint16_t>(k);
  }
  --size_;
  node.id = 0;
  return removed;
}

Matrix6 PoseGraph::chain_covariance(std::uint16_t a, std::uint16_t b) const {
  const std::size_t first = std::min(nodes_[a].position, nodes_[b].position);
  const std::size_t last = std::max(nodes_[a].position, nodes_[b].position);
  Matrix6 sum = Matrix6::Zero();
  for (std::size_t k = first + 1; k <= last; ++k)
    sum += motion_in_map(at(k - 1).T_map_keyframe, at(k).T_previous_keyframe, at(k).motion_covariance);
  return sum;
}

// Keeps the progress of the iterations so far, and begins a new linearisation.
void PoseGraph::note_change() {
  if (phase_ == Phase::kIterate && iteration_ > 0) (void)apply();
  phase_ = Phase::kIdle;
  changed_ = true;
}

void PoseGraph::step() {
  switch (phase_) {
    case Phase::kIdle:
      if (changed_ && loop_count_ > 0) {
        begin_round(0);
        linearise();
      }
      changed_ = false;
      break;
    case Phase::kLinearise: linearise(); break;
    case Phase::kIterate:
      for (int i = 0; i < kIterationsPerStep && phase_ == Phase::kIterate; ++i) {
        if (!iterate()) continue;
        phase_ = Phase::kIdle;
        if (apply() && round_ + 1 < kMostRounds) begin_round(round_ + 1);
      }
      break;
  }
}

void PoseGraph::begin_round(int round) {
  phase_ = Phase::kLinearise;
  round_ = round;
  count_ = size_;
  edge_ = 1;  // the first node has no motion
  for (std::size_t k = 0; k < size_; ++k) at(k).loops = 0;
  for (const Loop& loop : loops()) {
    ++nodes_[loop.older].loops;
    ++nodes_[loop.newer].loops;
  }
}

void PoseGraph::linearise() {
  for (int i = 0; i < kEdgesPerStep && edge_ < count_ + loop_count_; ++i, ++edge_) {
    if (edge_ < count_)
      linearise_chain(edge_);
    else
      linearise_loop(loops_[edge_ - count_]);
  }
  if (edge_ == count_ + loop_count_) begin_iterations();
}

void PoseGraph::set_covariance(Node& node, const Matrix6& covariance) {
  node.covariance = covariance;
  node.variance = generalised_variance(covariance);
}

// Sets the covariance of `node` to that of the path over `from`, if this path is more certain and the poses
// agree with the motion between the two nodes. They may disagree until the graph is solved. No path over a
// node that is less certain can be more certain.
void PoseGraph::relax(Node& node, const Node& from, const Se3& T_from_node, const Matrix6& between) const {
  if (node.position == 0 || !(from.variance < node.variance)) return;
  const Matrix6 covariance = from.covariance + between;
  const double variance = generalised_variance(covariance);
  if (!(variance < node.variance)) return;
  const Vector6 residual = difference(from.T_map_keyframe * T_from_node * node.T_map_keyframe.inverse());
  if (!(mahalanobis_squared<6>(residual, between) <= kMostPlausibleMotion)) return;
  node.covariance = covariance;
  node.variance = variance;
}

void PoseGraph::relax_along_chain() {
  for (std::size_t k = size_; k-- > 1;) {
    Node& node = at(k);
    node.C = motion_in_map(at(k - 1).T_map_keyframe, node.T_previous_keyframe, node.motion_covariance);
    relax(at(k - 1), node, node.T_previous_keyframe.inverse(), node.C);
  }
  for (std::size_t k = 1; k < size_; ++k) relax(at(k), at(k - 1), at(k).T_previous_keyframe, at(k).C);
}

void PoseGraph::linearise_chain(std::size_t position) {
  Node& node = at(position);
  const Node& previous = at(position - 1);
  node.C = motion_in_map(previous.T_map_keyframe, node.T_previous_keyframe, node.motion_covariance);
  Cholesky<6> cholesky;
  node.W = cholesky.factor(node.C) ? cholesky.inverse() : Matrix6(Matrix6::Zero());
  node.residual =
      difference(previous.T_map_keyframe * node.T_previous_keyframe * node.T_map_keyframe.inverse());
}

void PoseGraph::linearise_loop(Loop& loop) {
  const Node& older = nodes_[loop.older];
  const Node& newer = nodes_[loop.newer];
  loop.residual = difference(older.T_map_keyframe * loop.T_older_newer * newer.T_map_keyframe.inverse());
  const Matrix6 C = motion_in_map(older.T_map_keyframe, loop.T_older_newer, loop.covariance);
  Cholesky<6> cholesky;
  loop.W.setZero();
  if (cholesky.factor(C)) {
    const double independent = 2.0 / (older.loops + newer.loops);
    double weight = 1;
    kernel_(independent * cholesky.solve_lower(loop.residual).squaredNorm(), weight);
    loop.W = independent * weight * cholesky.inverse();
  }
}

// The gradient at y = 0: W r of each motion, and of each loop for all motions that it spans.
void PoseGraph::begin_iterations() {
  for (std::size_t k = 0; k < count_; ++k) at(k).q.setZero();
  for (const Loop& loop : loops()) {
    const Vector6 force = loop.W * loop.residual;
    nodes_[loop.newer].q += force;
    nodes_[loop.older].q -= force;
  }
  Vector6 sum = Vector6::Zero();
  gain_ = 0;
  for (std::size_t k = count_; k-- > 1;) {
    Node& node = at(k);
    sum += node.q;
    node.r = node.W * node.residual + sum;
    node.y.setZero();
    node.p = node.C * node.r;
    gain_ += node.r.dot(node.p);
  }
  first_gain_ = gain_;
  iteration_ = 0;
  phase_ = Phase::kIterate;
}

// One iteration of preconditioned conjugate gradients (Hestenes & Stiefel, 1952). Returns true at the end.
bool PoseGraph::iterate() {
  if (!(gain_ > kGainEnough && gain_ > kGainShare * first_gain_) || iteration_ == kMostIterations)
    return true;
  ++iteration_;
  // q = H p
  Vector6 x = Vector6::Zero();
  for (std::size_t k = 0; k < count_; ++k) {
    Node& node = at(k);
    if (k > 0) x += node.p;
    node.x = x;
    node.q.setZero();
  }
  for (const Loop& loop : loops()) {
    const Vector6 force = loop.W * (nodes_[loop.newer].x - nodes_[loop.older].x);
    nodes_[loop.newer].q += force;
    nodes_[loop.older].q -= force;
  }
  Vector6 sum = Vector6::Zero();
  double curvature = 0;
  for (std::size_t k = count_; k-- > 1;) {
    Node& node = at(k);
    sum += node.q;
    node.q = node.W * node.p + sum;
    curvature += node.p.dot(node.q);
  }
  if (!(curvature > 0)) return true;
  const double alpha = gain_ / curvature;
  double gain = 0;
  for (std::size_t k = 1; k < count_; ++k) {
    Node& node = at(k);
    node.y += alpha * node.p;
    node.r -= alpha * node.q;
    node.q = node.C * node.r;
    gain += node.r.dot(node.q);
  }
  const double beta = gain / gain_;
  gain_ = gain;
  for (std::size_t k = 1; k < count_; ++k) at(k).p = at(k).q + beta * at(k).p;
  return false;
}

// Moves the poses. Nodes that were added since the linearisation move with the last one before them. Returns
// whether any pose moved far.
bool PoseGraph::apply() {
  Vector6 x = Vector6::Zero();
  bool moved = false;
  for (std::size_t k = 1; k < size_; ++k) {
    Node& node = at(k);
    if (k < count_) x += node.y;
    node.T_map_keyframe = displacement(x) * node.T_map_keyframe;
    node.T_map_keyframe.R = renormalise(node.T_map_keyframe.R);
    moved = moved || x.cwiseAbs().maxCoeff() > kGraphMoved;
  }
  for (const Loop& loop : loops()) {
    Node& older = nodes_[loop.older];
    Node& newer = nodes_[loop.newer];
    const Matrix6 C = motion_in_map(older.T_map_keyframe, loop.T_older_newer, loop.covariance);
    relax(newer, older, loop.T_older_newer, C);
    relax(older, newer, loop.T_older_newer.inverse(), C);
  }
  relax_along_chain();
  return moved;
}

}  // namespace plvo
