// SPDX-License-Identifier: Apache-2.0
// The pose graph against a dense least-squares solution of the same problem, and what removal does to it.
#include "plvo/map/pose_graph.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

#include "plvo/base/random.hpp"

namespace plvo {
namespace {

struct Graph {
  explicit Graph(int keyframes) : memory(bytes(keyframes)) {
    arena = Arena(memory);
    graph.allocate(arena, keyframes);
    graph.clear();
  }
  static std::size_t bytes(int keyframes) {
    Arena sizer = Arena::counting();
    PoseGraph().allocate(sizer, keyframes);
    return sizer.peak() + kArenaAlignment;
  }
  // The number of steps until nothing is left to do.
  int solve() {
    int steps = 0;
    for (; !graph.idle() && steps < 10000; ++steps) graph.step();
    return steps;
  }
  std::vector<std::byte> memory;
  Arena arena;
  PoseGraph graph;
};

Vector6 draw(Random& random, double sigma_m, double sigma_rad) {
  Vector6 x;
  for (int i = 0; i < 6; ++i) {
    double sum = -6;
    for (int k = 0; k < 12; ++k) sum += random.uniform();
    x[i] = sum * (i < 3 ? sigma_m : sigma_rad);
  }
  return x;
}

constexpr double kStep_m = 0.01, kStep_rad = 0.01;

Matrix6 covariance(double sigma_m, double sigma_rad) {
  Vector6 d;
  d << Vector3::Constant(sigma_m * sigma_m), Vector3::Constant(sigma_rad * sigma_rad);
  return d.asDiagonal();
}

// A closed trajectory of n keyframes, which ends where it began; the truth.
std::vector<Se3> circle(int n) {
  std::vector<Se3> poses;
  for (int k = 0; k < n; ++k) {
    const double angle = 2 * 3.14159265358979 * k / (n - 1);
    poses.push_back(
        {rotation_exp({0, 0, angle}), {2 * std::sin(angle), 2 - 2 * std::cos(angle), 0.1 * k / n}});
  }
  return poses;
}

// The chain of a noisy odometry along these poses.
void append_all(PoseGraph& graph, const std::vector<Se3>& truth, std::uint64_t seed) {
  Random random(seed);
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const Se3 motion = k == 0 ? truth[0] : truth[k - 1].inverse() * truth[k];
    graph.append(k == 0 ? motion : boxplus(motion, draw(random, kStep_m, kStep_rad)),
                 covariance(kStep_m, kStep_rad));
  }
}

double robust_cost(double s) {
  const double k = chi_square_quantile(6, 0.95);
  return s <= k ? s : 2 * std::sqrt(k * s) - k;
}

// Loops that begin or end at the keyframe in this slot.
int loops_at(const PoseGraph& graph, std::uint16_t slot) {
  return static_cast<int>(std::ranges::count_if(
      graph.loops(), [slot](const PoseGraph::Loop& l) { return l.older == slot || l.newer == slot; }));
}

// Residual of a measured motion, whitened by its covariance in the axes of its start.
Vector6 whitened(const Se3& a, const Se3& b, const Se3& T_a_b, const Matrix6& C) {
  const Eigen::Matrix<double, 6, 6> L = Eigen::Matrix<double, 6, 6>(C).llt().matrixL();
  return Eigen::Matrix<double, 6, 6>(L).triangularView<Eigen::Lower>().solve(
      Eigen::Matrix<double, 6, 1>(boxminus(a.inverse() * b, T_a_b)));
}

// The same of a loop. Its covariance is so many times as large as loops share its two views with it.
Vector6 whitened(const PoseGraph& graph, const PoseGraph::Loop& loop, const std::vector<Se3>& poses) {
  const double shared = 0.5 * (loops_at(graph, loop.older) + loops_at(graph, loop.newer));
  return whitened(poses[graph.node(loop.older).position], poses[graph.node(loop.newer).position],
                  loop.T_older_newer, shared * loop.covariance);
}

double cost(const PoseGraph& graph, const std::vector<Se3>& poses) {
  double sum = 0;
  for (std::size_t k = 1; k < graph.size(); ++k) {
    const PoseGraph::Node& node = graph.node(graph.slot_at(k));
    sum += whitened(poses[k - 1], poses[k], node.T_previous_keyframe, node.motion_covariance).squaredNorm();
  }
  for (const PoseGraph::Loop& loop : graph.loops())
    sum += robust_cost(whitened(graph, loop, poses).squaredNorm());
  return sum;
}

std::vector<Se3> poses_of(const PoseGraph& graph) {
  std::vector<Se3> poses;
  for (std::size_t k = 0; k < graph.size(); ++k) poses.push_back(graph.node(graph.slot_at(k)).T_map_keyframe);
  return poses;
}

// Gauss–Newton with a dense matrix and numeric derivatives of the ⊞-perturbations of all poses but the first.
std::vector<Se3> dense_solution(const PoseGraph& graph) {
  std::vector<Se3> poses = poses_of(graph);
  const auto n = static_cast<Eigen::Index>(6 * (poses.size() - 1));
  const auto edges = static_cast<Eigen::Index>(poses.size() - 1 + graph.loops().size());
  const auto residuals = [&](const std::vector<Se3>& at) {
    Eigen::VectorXd r(6 * edges);
    for (Eigen::Index e = 0; e < edges; ++e) {
      const auto k = static_cast<std::size_t>(e + 1);
      if (k < poses.size()) {
        const PoseGraph::Node& node = graph.node(graph.slot_at(k));
        r.segment<6>(6 * e) = whitened(at[k - 1], at[k], node.T_previous_keyframe, node.motion_covariance);
      } else {
        Vector6 w = whitened(graph, graph.loops()[k - poses.size()], at);
        const double s = w.squaredNorm(), limit = chi_square_quantile(6, 0.95);
        if (s > limit) w *= std::sqrt(std::sqrt(limit / s));  // by the root of the weight
        r.segment<6>(6 * e) = w;
      }
    }
    return r;
  };
  for (int round = 0; round < 20; ++round) {
    const Eigen::VectorXd r = residuals(poses);
    Eigen::MatrixXd J(6 * edges, n);
    constexpr double kTiny = 1e-6;
    for (Eigen::Index i = 0; i < n; ++i) {
      std::vector<Se3> moved = poses;
      Vector6 delta = Vector6::Zero();
      delta[i % 6] = kTiny;
      Se3& pose = moved[static_cast<std::size_t>(i / 6 + 1)];
      pose = boxplus(pose, delta);
      J.col(i) = (residuals(moved) - r) / kTiny;
    }
    const Eigen::VectorXd step = -J.colPivHouseholderQr().solve(r);
    for (std::size_t k = 1; k < poses.size(); ++k)
      poses[k] = boxplus(poses[k], step.segment<6>(static_cast<Eigen::Index>(6 * (k - 1))));
    if (step.cwiseAbs().maxCoeff() < 1e-9) break;
  }
  return poses;
}

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

// A circle with loops between these pairs of keyframes.
void compare_with_dense_solver(const Pairs& loops) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const std::vector<Se3> truth = circle(25);
    Graph g(30);
    append_all(g.graph, truth, seed);
    Random random(seed, 7);
    for (const auto& [i, j] : loops) {
      g.graph.add_loop(g.graph.slot_at(i), g.graph.slot_at(j),
                       boxplus(truth[i].inverse() * truth[j], draw(random, 0.01, 0.01)),
                       covariance(0.01, 0.01));
    }
    const double before = cost(g.graph, poses_of(g.graph));
    const std::vector<Se3> reference = dense_solution(g.graph);
    g.solve();
    const std::vector<Se3> solved = poses_of(g.graph);
    double apart = 0;
    for (std::size_t k = 0; k < solved.size(); ++k)
      apart = std::max(apart, boxminus(solved[k], reference[k]).cwiseAbs().maxCoeff());
    std::printf("cost %.1f before, %.3f solved, %.3f dense; poses %.2g apart\n", before,
                cost(g.graph, solved), cost(g.graph, reference), apart);
    // The two linearise a motion's error at its two ends: they differ by products of the errors.
    EXPECT_LT(cost(g.graph, solved), 1.05 * cost(g.graph, reference) + 0.1);
    EXPECT_LT(apart, 5e-3);
    EXPECT_LT((solved.back().t - truth.back().t).norm(), 0.03);
  }
}

// The blocks against the whole Jacobians.
TEST(PoseGraph, AMotionHasTheCovarianceThatItsJacobianGives) {
  using Dense = Eigen::Matrix<double, 6, 6>;
  Random random(48);
  for (int i = 0; i < 50; ++i) {
    const Se3 T_i = boxplus(Se3(), draw(random, 2, 1)), T_ij = boxplus(Se3(), draw(random, 1, 1));
    Dense root;
    for (int k = 0; k < 6; ++k) root.col(k) = draw(random, 0.1, 0.1);
    const Dense C = root * root.transpose();
    Dense turn = Dense::Zero(), lever = Dense::Identity();
    turn.block<3, 3>(0, 0) = turn.block<3, 3>(3, 3) = T_i.R;
    lever.block<3, 3>(0, 3) = skew(T_i * T_ij.t);
    const Dense J = lever * turn;
    const Dense in_map = motion_in_map(T_i, T_ij, C);
    EXPECT_LT((in_map - J * C * J.transpose()).norm(), 1e-12 * in_map.norm());
    const Dense about = about_position(in_map, T_i * T_ij.t);
    EXPECT_LT((about - turn * C * turn.transpose()).norm(), 1e-12 * in_map.norm());
  }
}

TEST(PoseGraph, FindsTheSolutionOfADenseSolver) { compare_with_dense_solver({{0, 24}, {3, 20}, {1, 23}}); }

// Their errors are not independent: those of a view are in all of its loops.
TEST(PoseGraph, LoopsOfOneViewCountByTheirOwnShare) {
  compare_with_dense_solver({{0, 24}, {0, 23}, {0, 22}, {0, 21}, {0, 20}, {3, 18}, {4, 18}});
}

TEST(PoseGraph, BoundsTheWorkOfAStep) {
  constexpr int kNodes = 512;
  const std::vector<Se3> truth = circle(kNodes);
  Graph g(kNodes);
  append_all(g.graph, truth, 5);
  g.graph.add_loop(g.graph.slot_at(0), g.graph.last(), truth.front().inverse() * truth.back(),
                   covariance(0.01, 0.01));
  const int steps = g.solve();
  std::printf("%d steps for %d nodes\n", steps, kNodes);
  // Linearisations by parts, then iterations two by two.
  EXPECT_GE(steps, (kNodes + 1) / PoseGraph::kEdgesPerStep);
  EXPECT_LE(steps, PoseGraph::kMostRounds * ((kNodes + 1) / PoseGraph::kEdgesPerStep + 1 +
                                             PoseGraph::kMostIterations / PoseGraph::kIterationsPerStep + 1));
  EXPECT_LT((g.graph.node(g.graph.last()).T_map_keyframe.t - truth.back().t).norm(), 0.05);
}

TEST(PoseGraph, MovesUncertainMotionsAndKeepsCertainOnes) {
  // Between keyframes 9 and 10 nothing was seen: the odometry went on at a wrong place.
  const std::vector<Se3> truth = circle(20);
  Graph g(20);
  append_all(g.graph, std::vector<Se3>(truth.begin(), truth.begin() + 10), 3);
  g.graph.append({rotation_exp({0.3, -2, 0.4}), {30, -20, 10}}, covariance(100, 3));
  for (std::size_t k = 11; k < 20; ++k)
    g.graph.append(truth[k - 1].inverse() * truth[k], covariance(kStep_m, kStep_rad));
  EXPECT_GT(g.graph.node(g.graph.last()).covariance(0, 0), 1e3);
  g.graph.add_loop(g.graph.slot_at(1), g.graph.slot_at(18), truth[1].inverse() * truth[18],
                   covariance(0.01, 0.01));
  g.solve();
  EXPECT_LT((g.graph.node(g.graph.last()).T_map_keyframe.t - truth.back().t).norm(), 0.2);
  EXPECT_LT(about_position(g.graph.node(g.graph.last()).covariance, truth.back().t)(0, 0), 0.01)
      << "by the path over the loop";
}

TEST(PoseGraph, APartMovesAsAWholeToWhereItsPlaceIsFound) {
  const std::vector<Se3> truth = circle(20);
  // Whichever of the two is named first, the part that began later moves.
  for (const bool swapped : {false, true}) {
    Graph g(20);
    PoseGraph& graph = g.graph;
    append_all(graph, std::vector<Se3>(truth.begin(), truth.begin() + 10), 3);
    graph.append(Se3(), covariance(100, 3), graph.next_id());
    for (std::size_t k = 11; k < 20; ++k)
      graph.append(truth[k - 1].inverse() * truth[k], covariance(kStep_m, kStep_rad));
    for (std::size_t k = 0; k < 20; ++k) EXPECT_EQ(graph.is_placed(graph.slot_at(k)), k < 10) << k;
    const std::vector<Se3> before = poses_of(graph);
    const std::uint16_t a = graph.slot_at(2), b = graph.slot_at(15);
    const Se3 T_a_b = truth[2].inverse() * truth[15];
    const Matrix6 C = covariance(0.01, 0.01);
    if (swapped)
      graph.join_parts(b, a, T_a_b.inverse(), inverse_covariance(T_a_b, C));
    else
      graph.join_parts(a, b, T_a_b, C);
    for (std::size_t k = 0; k < 20; ++k) {
      const PoseGraph::Node& node = graph.node(graph.slot_at(k));
      EXPECT_TRUE(graph.is_placed(graph.slot_at(k)));
      const Se3 expected = k < 10 ? before[k] : before[2] * truth[2].inverse() * truth[k];
      EXPECT_LT(boxminus(node.T_map_keyframe, expected).norm(), k < 10 ? 1e-300 : 1e-9) << k;
      EXPECT_LT(about_position(node.covariance, node.T_map_keyframe.t).trace(), 0.1) << k;
    }
  }
}

// A part that was joined keeps its place, though the motion before it is the least certain one of all.
TEST(PoseGraph, OnlyNodesWhosePlaceIsUnknownMove) {
  const std::vector<Se3> truth = circle(20);
  Graph g(20);
  PoseGraph& graph = g.graph;
  append_all(graph, std::vector<Se3>(truth.begin(), truth.begin() + 10), 3);
  graph.append(Se3(), covariance(100, 3), graph.next_id());
  for (std::size_t k = 11; k < 20; ++k) {
    const double worse = k == 15 ? 1000 : 1;
    graph.append(truth[k - 1].inverse() * truth[k], covariance(worse * kStep_m, worse * kStep_rad));
  }
  const auto slot = [&](std::size_t k) { return graph.slot_at(k); };
  graph.join_parts(slot(2), slot(12), truth[2].inverse() * truth[12], covariance(0.01, 0.01));
  const std::vector<Se3> before = poses_of(graph);
  constexpr VarianceBounds known{.position_m2 = 1, .orientation_rad2 = 1};
  for (std::size_t k = 0; k < 20; ++k) EXPECT_EQ(graph.is_uncertain(slot(k), known), k >= 15) << k;
  // The later node's place is known: nothing moves.
  graph.move_unknown(slot(3), slot(13), Se3(), covariance(0.01, 0.01), known);
  EXPECT_EQ(poses_of(graph)[13].t, before[13].t);
  const Se3 T_a_b{Matrix3::Identity(), {1, 2, 3}};
  graph.move_unknown(slot(17), slot(4), T_a_b.inverse(), covariance(0.01, 0.01), known);
  const std::vector<Se3> after = poses_of(graph);
  for (std::size_t k = 0; k < 20; ++k) {
    const Se3 expected = k < 15 ? before[k] : before[4] * T_a_b * before[17].inverse() * before[k];
    EXPECT_LT(boxminus(after[k], expected).norm(), k < 15 ? 1e-300 : 1e-9) << k;
    EXPECT_FALSE(graph.is_uncertain(slot(k), {.position_m2 = 0.05, .orientation_rad2 = 0.05})) << k;
  }
}

// Two losses, each with an error. Together they have that of the later place, and each takes its share.
TEST(PoseGraph, EqualLossesShareTheDisplacement) {
  constexpr VarianceBounds known{.position_m2 = 1, .orientation_rad2 = 1};
  std::vector<Se3> truth;
  for (int k = 0; k < 20; ++k) truth.push_back({Matrix3::Identity(), {1.0 * k, 0, 0}});
  Graph g(20);
  const auto slot = [&](std::size_t k) { return g.graph.slot_at(k); };
  const Vector6 error = (Vector6() << 0.2, 0.3, 0, 0, 0, 0.2).finished();
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const Se3 motion = k == 0 ? truth[0] : truth[k - 1].inverse() * truth[k];
    const bool is_lost = k == 5 || k == 15;
    g.graph.append(is_lost ? boxplus(motion, error) : motion,
                   is_lost ? covariance(1, 0.5) : covariance(0.001, 0.001));
  }
  const auto worst_turn = [&] {
    double worst = 0;
    for (std::size_t k = 5; k < 15; ++k)
      worst = std::max(worst, boxminus(g.graph.node(slot(k)).T_map_keyframe, truth[k]).tail<3>().norm());
    return worst;
  };
  EXPECT_NEAR(worst_turn(), 0.2, 1e-6);
  g.graph.move_unknown(slot(2), slot(17), truth[2].inverse() * truth[17], covariance(0.001, 0.001), known);
  EXPECT_LT(worst_turn(), 0.1);
  for (std::size_t k = 15; k < 20; ++k)
    EXPECT_LT(boxminus(g.graph.node(slot(k)).T_map_keyframe, truth[k]).norm(), 1e-6) << k;
  // It is where the solution begins, and nearly where it ends.
  const double before = worst_turn();
  g.graph.add_loop(slot(2), slot(17), truth[2].inverse() * truth[17], covariance(0.001, 0.001));
  g.solve();
  EXPECT_NEAR(worst_turn(), before, 0.02);
}

TEST(PoseGraph, TheCovarianceIsAtLeastTheMarginalOfTheDenseProblem) {
  const std::vector<Se3> truth = circle(12);
  Graph g(12);
  for (std::size_t k = 0; k < truth.size(); ++k)
    g.graph.append(k == 0 ? truth[0] : truth[k - 1].inverse() * truth[k], covariance(kStep_m, kStep_rad));
  g.graph.add_loop(g.graph.slot_at(0), g.graph.slot_at(11), truth[0].inverse() * truth[11],
                   covariance(0.01, 0.01));
  g.solve();
  // Information of the differences x along the chain, about the origin.
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(66, 66);
  const auto add = [&H](int i, int j, const Matrix6& C) {
    const Eigen::Matrix<double, 6, 6> W = Eigen::Matrix<double, 6, 6>(C).inverse();
    if (i >= 0) H.block<6, 6>(6 * i, 6 * i) += W;
    H.block<6, 6>(6 * j, 6 * j) += W;
    if (i < 0) return;
    H.block<6, 6>(6 * i, 6 * j) -= W;
    H.block<6, 6>(6 * j, 6 * i) -= W;
  };
  for (int k = 1; k < 12; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const PoseGraph::Node& node = g.graph.node(g.graph.slot_at(at));
    add(k - 2, k - 1, motion_in_map(truth[at - 1], node.T_previous_keyframe, node.motion_covariance));
  }
  const PoseGraph::Loop& loop = g.graph.loops()[0];
  add(-1, 10, motion_in_map(truth[0], loop.T_older_newer, loop.covariance));
  const Eigen::MatrixXd marginal = H.inverse();
  for (int k = 1; k < 12; ++k) {
    const Eigen::Matrix<double, 6, 6> more =
        Eigen::Matrix<double, 6, 6>(g.graph.node(g.graph.slot_at(static_cast<std::size_t>(k))).covariance) -
        marginal.block<6, 6>(6 * (k - 1), 6 * (k - 1));
    EXPECT_GT(more.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), -1e-7) << "node " << k;
  }
}

// At each step the stated covariance must contain the error: what a loop tells may not make it small before
// the pose has moved.
TEST(PoseGraph, TheCovarianceShrinksOnlyWithThePose) {
  constexpr int kNodes = 200;
  const std::vector<Se3> truth = circle(kNodes);
  Graph g(kNodes);
  append_all(g.graph, truth, 5);
  const std::uint16_t last = g.graph.last();
  const auto nees = [&] {
    const PoseGraph::Node& node = g.graph.node(last);
    const Eigen::Matrix<double, 6, 6> C = about_position(node.covariance, node.T_map_keyframe.t);
    const Eigen::Matrix<double, 6, 1> error = boxminus(node.T_map_keyframe, truth.back());
    return error.dot(C.llt().solve(error));
  };
  const double before = nees();
  const double spread = g.graph.node(last).covariance.trace();
  g.graph.add_loop(g.graph.slot_at(0), last, truth[0].inverse() * truth.back(), covariance(0.01, 0.01));
  int steps = 0;
  for (; !g.graph.idle(); ++steps) {
    g.graph.step();
    ASSERT_LT(nees(), std::max(before, 30.0)) << "after " << steps << " steps";
  }
  EXPECT_GT(steps, 3);
  EXPECT_LT(g.graph.node(last).covariance.trace(), 0.1 * spread);
}

TEST(PoseGraph, ARemovedNodeLeavesItsMotionsAndLoops) {
  const std::vector<Se3> truth = circle(10);
  Graph g(10);
  append_all(g.graph, truth, 4);
  g.graph.add_loop(g.graph.slot_at(1), g.graph.slot_at(8), truth[1].inverse() * truth[8],
                   covariance(0.01, 0.01));
  const std::vector<Se3> before = poses_of(g.graph);
  const std::uint16_t gone = g.graph.slot_at(8);
  const PoseGraph::Removed removed = g.graph.remove(gone);
  EXPECT_EQ(g.graph.size(), 9U);
  EXPECT_LT(boxminus(g.graph.node(removed.into).T_map_keyframe * removed.T_into_removed, before[8]).norm(),
            1e-12);
  ASSERT_EQ(g.graph.loops().size(), 1U);
  const PoseGraph::Loop& loop = g.graph.loops()[0];
  EXPECT_EQ(loop.older, g.graph.slot_at(1));
  EXPECT_EQ(loop.newer, removed.into);
  EXPECT_GT(loop.covariance(0, 0), 1.5e-4) << "it includes the motion to the neighbour";
  const PoseGraph::Node& next = g.graph.node(g.graph.slot_at(8));
  EXPECT_LT(boxminus(before[7] * next.T_previous_keyframe, before[9]).norm(), 1e-12);
  EXPECT_GT(next.motion_covariance(0, 0), 1.5e-4);
  // The slot is used again, with a new number.
  EXPECT_EQ(g.graph.append(Se3(), covariance(1, 1)), gone);
  EXPECT_EQ(g.graph.node(gone).id, 11U);
}

TEST(PoseGraph, KeepsTheMoreCertainLoopsWhenFull) {
  const std::vector<Se3> truth = circle(6);
  Graph g(6);
  append_all(g.graph, truth, 1);
  double sigma = 0.1;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = i + 2; j < 6; ++j, sigma -= 0.005)
      g.graph.add_loop(g.graph.slot_at(i), g.graph.slot_at(j), truth[i].inverse() * truth[j],
                       covariance(sigma, sigma));
  ASSERT_EQ(g.graph.loops().size(), 6U);
  for (const PoseGraph::Loop& loop : g.graph.loops()) EXPECT_LT(loop.covariance(0, 0), 0.081 * 0.081);
}

}  // namespace
}  // namespace plvo
