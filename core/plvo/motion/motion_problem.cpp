// SPDX-License-Identifier: Apache-2.0
#include "plvo/motion/motion_problem.hpp"

#include <limits>

#include "plvo/math/cholesky.hpp"

namespace plvo {

MotionProblem::Kernels MotionProblem::make_kernels(const CostTerms& terms, RobustLoss loss) {
  Kernels kernels;
  for (std::size_t i = 0; i < terms.size(); ++i) kernels[i] = RobustKernel(loss, terms[i].dof());
  return kernels;
}

MotionsToCurrent motions_to_current(const Se3& T_current_base, const MotionReferences& references) {
  MotionsToCurrent motions;
  motions[0] = T_current_base;
  for (std::size_t r = 1; r < kMaxPoses; ++r)
    motions[r] = T_current_base * references[r].T_reference_base.inverse();
  return motions;
}

// Not inlined: the motions would otherwise stay on the stack while the motion is solved for.
[[gnu::noinline]] bool contradict(const CostTerms& terms, const Se3& T_current_base,
                                  const MotionReferences& references) {
  const MotionsToCurrent motions = motions_to_current(T_current_base, references);
  for (std::size_t i = 0; i < terms.size(); ++i)
    if (terms[i].contradicts(motions[terms[i].reference()])) return true;
  return false;
}

namespace {

constexpr int kJointSize = JointInformation::kSize;
using Joint = Matrix<kJointSize, kJointSize>;

// Weight of a term's inliers relative to independent ones.
double share_of(const CostTerm& term) {
  int n = 0;
  for (const std::uint8_t flag : term.inliers()) n += flag;
  return term.weight() * term.share_of(n);
}

// Lower Cholesky factor of a semidefinite matrix. Columns with a pivot of zero are zero.
Matrix6 root(const Matrix6& S) {
  Matrix6 L = Matrix6::Zero();
  for (int j = 0; j < 6; ++j) {
    double d = S(j, j);
    for (int k = 0; k < j; ++k) d -= L(j, k) * L(j, k);
    if (!(d > 1e-20)) continue;
    L(j, j) = sqrt(d);
    for (int i = j + 1; i < 6; ++i) {
      double s = S(i, j);
      for (int k = 0; k < j; ++k) s -= L(i, k) * L(j, k);
      L(i, j) = s / L(j, j);
    }
  }
  return L;
}

}  // namespace

void MotionProblem::start(const CostTerms& terms, const MotionReferences& references,
                          const NuisanceParameters& shared, const Kernels& kernels, const Se3& T,
                          std::size_t every, bool exact_poses) {
  terms_ = terms;
  references_ = references;
  if (exact_poses)
    for (MotionReference& reference : references_) reference.covariance.setZero();
  kernels_ = kernels;
  T_ = candidate_ = T;
  shared_ = shared;
  candidate_shared_ = shared.value;
  inverse_.setZero();
  candidate_inverse_.setZero();
  gain_.setZero();
  candidate_gain_.setZero();
  of_references_ = {};
  for (std::size_t r = 0; r < kMaxPoses; ++r) candidate_moved_[r] = references_[r].moved;
  for (PoseGain& gain : pose_gain_) gain.setZero();
  const MotionsToCurrent motions = motions_to_current(T, references_);
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    terms_[i].begin(motions[terms_[i].reference()], shared, kernels_[i], every);
    share_[i] = share_of(terms_[i]);
  }
  for (std::size_t r = 1; r < kMaxPoses; ++r) root_[r] = root(references_[r].covariance);
}

double MotionProblem::linearize(const Vector6& step, Matrix6& H, Vector6& g) {
  candidate_ = boxplus(T_, step);
  const MotionsToCurrent motions = motions_to_current(candidate_, references_);
  sum_.set_zero();
  double cost = 0;
  for (std::size_t r = 0; r < kMaxPoses; ++r) {
    cost += add_reference(r, motions[r]);
    if (r == 0) candidate_of_references_.base = sum_.H.block<6, 6>(0, 0);
  }
  candidate_of_references_.others = sum_.H.block<6, 6>(0, 0) - candidate_of_references_.base;
  if (shared_.any()) {
    cost += eliminate_shared();
    for (std::size_t r = 1; r < kMaxPoses; ++r)
      candidate_moved_[r] -= pose_gain_[r].lazyProduct(candidate_shared_ - shared_.value);
  }
  H = sum_.H.block<6, 6>(0, 0);
  g = sum_.g.head<6>();
  return cost;
}

double MotionProblem::add_reference(std::size_t r, const Se3& T) {
  bool any = false;
  double cost = add_terms(r, T, any);
  if (!any) return 0;
  if (r > 0) cost += bring_to_base(r, T);
  sum_.H += of_reference_.H;
  sum_.g += of_reference_.g;
  return cost;
}

double MotionProblem::add_terms(std::size_t r, const Se3& T, bool& any) {
  of_reference_.set_zero();
  double cost = 0;
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    const CostTerm& term = terms_[i];
    if (term.reference() != r) continue;
    any = true;
    of_term_.set_zero();
    cost += share_[i] * term.linearize(T, shared_, kernels_[i], of_term_);
    of_reference_.H += share_[i] * of_term_.H;
    of_reference_.g += share_[i] * of_term_.g;
  }
  return cost;
}

// Transforms the information about a reference's own motion into information about the base's motion. A
// separate function from add_terms: otherwise its matrices and those of a term's linearisation would be on
// the stack at the same time.
[[gnu::noinline]] double MotionProblem::bring_to_base(std::size_t r, const Se3& T) {
  const Matrix3 Q = skew(T.R * references_[r].T_reference_base.t);
  Matrix6 B = rotation_of_both(T.R);
  B.block<3, 3>(0, 3) = Q * T.R;
  double cost = 0;
  // −B is the derivative of T_current_reference with respect to the perturbation of T_reference_base.
  if (references_[r].covariance.trace() > 0) cost = eliminate_pose(r, -B.lazyProduct(root_[r]));
  // Aᵀ H A, where A is the identity with Q added above the diagonal: an update of the columns, then of the
  // rows.
  Joint& H = of_reference_.H;
  H.block<kJointSize, 3>(0, 3) += H.block<kJointSize, 3>(0, 0).lazyProduct(Q).eval();
  H.block<3, kJointSize>(3, 0) += Q.transpose().lazyProduct(H.block<3, kJointSize>(0, 0)).eval();
  of_reference_.g.segment<3>(3) += Q.transpose().lazyProduct(of_reference_.g.head<3>());
  return cost;
}

// Eliminates the pose of a reference together with its prior, at its optimum for this motion: H ← (H⁻¹ + L
// Lᵀ)⁻¹ on the motion's block; updates the gradient accordingly and returns the change of the cost.
double MotionProblem::eliminate_pose(std::size_t r, const Matrix6& L) {
  JointInformation& sum = of_reference_;
  const Vector6& moved = references_[r].moved;
  const Matrix<kJointSize, 6> HL = sum.H.block<kJointSize, 6>(0, 0).lazyProduct(L);
  const Matrix6 M = Matrix6::Identity() + L.transpose().lazyProduct(HL.block<6, 6>(0, 0));
  Cholesky<6> cholesky;
  if (!cholesky.factor(M)) return std::numeric_limits<double>::infinity();
  const Vector6 g = L.transpose().lazyProduct(sum.g.head<6>()) + moved;
  const Vector6 step = cholesky.solve(g);
  const Matrix<6, kJointSize> gain = cholesky.inverse().lazyProduct(HL.transpose());
  sum.H -= HL.lazyProduct(gain);
  for (int c = 0; c < kJointSize; ++c)
    for (int i = c + 1; i < kJointSize; ++i) sum.H(i, c) = sum.H(c, i) = 0.5 * (sum.H(i, c) + sum.H(c, i));
  sum.g -= HL.lazyProduct(step);
  candidate_moved_[r] = moved - step;
  pose_gain_[r] = gain.rightCols<NuisanceParameters::kCount>();
  return 0.5 * moved.squaredNorm() - 0.5 * g.dot(step);
}

// Eliminates the nuisance parameters together with their prior, at their optimum for this motion. Returns the
// change of the cost.
[[gnu::noinline]] double MotionProblem::eliminate_shared() {
  constexpr int n = NuisanceParameters::kCount;
  double cost = 0;
  for (int k = 0; k < n; ++k) {
    const double sigma = shared_.sigma(k);
    // The derivative by a parameter that is not modelled is zero, so any positive information keeps its
    // value.
    const double information = sigma > 0 ? 1 / (sigma * sigma) : 1;
    sum_.H(6 + k, 6 + k) += information;
    sum_.g[6 + k] += information * shared_.value[k];
    cost += 0.5 * information * shared_.value[k] * shared_.value[k];
  }
  Cholesky<n> cholesky;
  if (!cholesky.factor(sum_.H.block<n, n>(6, 6))) return std::numeric_limits<double>::infinity();
  const NuisanceParameters::Vector g = sum_.g.tail<n>();
  const NuisanceParameters::Vector step = cholesky.solve(g);
  candidate_shared_ = shared_.value - step;
  candidate_inverse_ = cholesky.inverse();
  candidate_gain_ = candidate_inverse_.lazyProduct(sum_.H.block<n, 6>(6, 0));
  const Matrix<6, n> coupling = sum_.H.block<6, n>(0, 6);
  const Matrix6 eliminated = coupling.lazyProduct(candidate_gain_);
  sum_.H.block<6, 6>(0, 0) -= symmetric<6>(eliminated);
  sum_.g.head<6>() -= coupling.lazyProduct(step);
  return cost - 0.5 * g.dot(step);
}

NuisanceEstimate MotionProblem::shared(const Matrix6& covariance) const {
  if (!shared_.any()) return {};
  return {shared_.value,
          inverse_.diagonal() + gain_.lazyProduct(covariance).eval().cwiseProduct(gain_).rowwise().sum()};
}

void MotionProblem::accept() {
  T_ = {renormalise(candidate_.R), candidate_.t};
  for (std::size_t r = 1; r < kMaxPoses; ++r) {
    MotionReference& reference = references_[r];
    if (!(reference.covariance.trace() > 0)) continue;
    const Vector6 step = root_[r].lazyProduct(candidate_moved_[r] - reference.moved);
    reference.T_reference_base = boxplus(reference.T_reference_base, step);
    reference.moved = candidate_moved_[r];
  }
  shared_.value = candidate_shared_;
  inverse_ = candidate_inverse_;
  gain_ = candidate_gain_;
  of_references_ = candidate_of_references_;
}

void MotionProblem::advance(const Vector6& step) {
  const Se3 T = boxplus(T_, step);
  T_ = {renormalise(T.R), T.t};
  shared_.value -= gain_.lazyProduct(step);
}

}  // namespace plvo
