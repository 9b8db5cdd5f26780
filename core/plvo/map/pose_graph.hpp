// SPDX-License-Identifier: Apache-2.0
// The pose graph of the map. Its nodes are the keyframes. They form a chain in the order in which they were
// seen: each has the motion from the one before, as the odometry measured it. Loops are further motions,
// between keyframes that show the same place.
//
// Perturbations x = (ρ, ω) move a pose in the axes of the map and about its origin: T ← (Exp(ω), ρ) T. The
// residual of a measured motion T_ij is r = (t, Log R) of T_i T_ij T_j⁻¹, and to first order it becomes r +
// x_i − x_j. The unknowns are the differences y_k = x_k − x_(k−1) along the chain. The Hessian of the chain
// is then block-diagonal, with the covariances of its motions as its inverse: the preconditioner of conjugate
// gradients (as the subgraph of Dellaert, Carlson, Ila, Ni & Thorpe, IROS 2010). A loop only adds the sum of
// the y that it spans. Loops have Huber's loss; their weights are renewed with each linearisation.
//
// Nodes with an unknown motion between them belong to different parts of the graph. When the place of a part
// is found, the whole part moves there at once.
//
// step() does a bounded part of the work: it linearises at most kEdgesPerStep edges, or takes at most
// kIterationsPerStep iterations, each of which visits every edge once.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "plvo/base/arena.hpp"
#include "plvo/math/covariance.hpp"
#include "plvo/math/se3.hpp"
#include "plvo/motion/robust_kernel.hpp"

namespace plvo {

class PoseGraph {
 public:
  static constexpr int kEdgesPerStep = 64;
  static constexpr int kIterationsPerStep = 2;
  static constexpr int kMostIterations = 40;  // of one linearisation
  static constexpr int kMostRounds = 10;      // linearisations after a change

  struct Node {
    Se3 T_map_keyframe;
    Se3 T_previous_keyframe;                      // as measured; unused in the first node
    Matrix6 motion_covariance = Matrix6::Zero();  // of its ⊞-perturbation
    // Covariance of the perturbation (ρ, ω), along the path through the graph on which it is smallest. It is
    // an upper bound: the other paths would only make it smaller.
    Matrix6 covariance = Matrix6::Zero();
    double variance = 0;     // generalised variance of `covariance`
    std::uint32_t id = 0;    // 1, 2, … in the order of the chain; 0: the slot is free
    std::uint32_t part = 0;  // the id of the node with which the part began
    std::uint16_t position = 0;
    std::uint16_t loops = 0;  // that begin or end here
    bool shares = false;      // the displacement that move_unknown() distributes

    // The solver's: covariance and information of the motion in the axes of the map, and vectors.
    Matrix6 C = Matrix6::Zero(), W = Matrix6::Zero();
    Vector6 residual = Vector6::Zero(), y = residual, r = residual, p = residual, q = residual, x = residual;
  };
  struct Loop {
    std::uint16_t older = 0, newer = 0;  // slots, in the order of the chain
    Se3 T_older_newer;
    Matrix6 covariance = Matrix6::Zero();  // of its ⊞-perturbation
    Matrix6 W = Matrix6::Zero();           // with the robust weight
    Vector6 residual = Vector6::Zero();
  };
  // What remove() did with the node: its pose relative to a node that stays.
  struct Removed {
    std::uint16_t slot = 0, into = 0;
    Se3 T_into_removed;
  };

  constexpr void allocate(Arena& memory, int keyframes) {
    const auto n = static_cast<std::size_t>(keyframes);
    nodes_ = memory.take<Node>("pose graph", n);
    order_ = memory.take<std::uint16_t>("pose graph", n);
    loops_ = memory.take<Loop>("pose graph", n);
  }
  void clear();

  // Nodes in the order of the chain.
  std::size_t size() const { return size_; }
  std::size_t capacity() const { return nodes_.size(); }
  bool full() const { return size_ == nodes_.size(); }
  std::uint16_t slot_at(std::size_t position) const { return order_[position]; }
  std::uint16_t last() const { return order_[size_ - 1]; }
  const Node& node(std::size_t slot) const { return nodes_[slot]; }
  std::span<const Loop> loops() const { return loops_.first(loop_count_); }

  // Adds a node at the end of the chain, and returns its slot. The graph must not be full. The first node
  // defines the map: the motion is its pose, without covariance. Without `part`, the node belongs to the part
  // of the node before.
  std::uint16_t append(const Se3& T_previous_keyframe, const Matrix6& covariance,
                       std::optional<std::uint32_t> part = std::nullopt);
  // The id of the node that is appended next.
  std::uint32_t next_id() const { return next_id_; }
  // Whether the pose of a node is known relative to the first one.
  bool is_placed(std::size_t slot) const { return nodes_[slot].part == at(0).part; }
  // If the nodes belong to two parts, the part that began later moves to where the motion puts it, and is
  // merged with the other.
  void join_parts(std::uint16_t a, std::uint16_t b, const Se3& T_a_b, const Matrix6& covariance);
  // Whether the pose of a node relative to the first one is more uncertain than a known one may be.
  bool is_uncertain(std::uint16_t slot, const VarianceBounds& known) const;
  // Does nothing unless the later node is uncertain. Otherwise it finds the least certain motion among the
  // uncertain nodes that end with the later node. It and the motions that are about as uncertain share the
  // displacement that puts the later node where T_a_b has it; the nodes between them and to the end of the
  // chain move as wholes. The solution would need many steps for this.
  void move_unknown(std::uint16_t a, std::uint16_t b, const Se3& T_a_b, const Matrix6& covariance,
                    const VarianceBounds& known);
  // Adds a measured motion. If there is no room, it replaces the most uncertain loop.
  void add_loop(std::uint16_t a, std::uint16_t b, const Se3& T_a_b, const Matrix6& covariance);
  // Removes a node. Its neighbours' motions are composed; its loops go to the neighbour whose motion is more
  // certain. There must be another node.
  Removed remove(std::uint16_t slot);

  // Restores a map from a file. After clear(), restore the nodes in the order of the chain, each to a slot
  // that is free and below the capacity, then the loops.
  void restore(std::uint16_t slot, const Node& node);
  void restore(const Loop& loop) { keep_loop(loop); }

  // Covariance of the perturbation of x_b − x_a along the chain.
  Matrix6 chain_covariance(std::uint16_t a, std::uint16_t b) const;

  // Does a bounded part of the solution.
  void step();
  bool idle() const { return phase_ == Phase::kIdle && !changed_; }

 private:
  enum class Phase : std::uint8_t { kIdle, kLinearise, kIterate };

  Node& at(std::size_t position) { return nodes_[order_[position]]; }
  const Node& at(std::size_t position) const { return nodes_[order_[position]]; }
  bool has_loop(std::uint16_t a, std::uint16_t b) const;
  void note_change();
  void begin_round(int round);
  void linearise();
  void linearise_chain(std::size_t position);
  void linearise_loop(Loop& loop);
  void begin_iterations();
  bool iterate();
  bool apply();
  static void set_covariance(Node& node, const Matrix6& covariance);
  void relax(Node& node, const Node& from, const Se3& T_from_node, const Matrix6& between) const;
  void relax_along_chain();
  void share_out(const Node& older, const Node& newer, const Se3& T_older_newer, std::size_t begin,
                 double least_variance);
  template <typename IsMoved>
  void place(const Node& stays, Node& moves, const Se3& T_stays_moves, const Matrix6& of_motion,
             const IsMoved& is_moved);
  void keep_loop(const Loop& loop);

  std::span<Node> nodes_;           // by slot
  std::span<std::uint16_t> order_;  // slots by position in the chain
  std::size_t size_ = 0;
  std::span<Loop> loops_;
  std::size_t loop_count_ = 0;
  std::uint32_t next_id_ = 1;
  RobustKernel kernel_;

  Phase phase_ = Phase::kIdle;
  bool changed_ = false;   // since the last linearisation began
  std::size_t count_ = 0;  // nodes and
  std::size_t edge_ = 0;   // edges of the chain, then loops, that were linearised
  int iteration_ = 0, round_ = 0;
  double first_gain_ = 0, gain_ = 0;  // rᵀ C r, in squared standard deviations
};

// The covariance of the perturbation (ρ, ω) from that of the ⊞-perturbation of a pose at t, and back.
Matrix6 about_origin(const Matrix6& covariance, const Vector3& t);
Matrix6 about_position(const Matrix6& covariance, const Vector3& t);
// Covariance of the perturbation (ρ, ω) of T_i T_ij, from that of the ⊞-perturbation of T_ij.
Matrix6 motion_in_map(const Se3& T_i, const Se3& T_ij, const Matrix6& covariance);
// (t, Log R).
Vector6 difference(const Se3& T);

}  // namespace plvo
