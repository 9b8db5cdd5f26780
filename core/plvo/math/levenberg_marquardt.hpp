// SPDX-License-Identifier: Apache-2.0
// A small dense Levenberg–Marquardt solver for N parameters (N fixed, about 1 … 12), with Nielsen's damping
// rule (Madsen, Nielsen, Tingleff, "Methods for Non-Linear Least Squares Problems", 2004, ch. 3). The
// workspace is the object. The solver sees neither residuals nor the state. A Problem holds its state and
// offers two functions:
//
//   double linearize(const Vector<N>& step, Matrix<N, N>& H, Vector<N>& g);
//     Computes candidate = state ⊞ step. Writes H = Σ Jᵀ Σ⁻¹ J and g = Σ Jᵀ Σ⁻¹ r at the candidate (both are
//     overwritten, H in full). Returns the cost ½ Σ rᵀ Σ⁻¹ r there. J is the derivative of r with respect to
//     a further ⊞ step. A cost that is not finite means "outside the domain"; the solver treats the step as
//     failed.
//   void accept();
//     Makes the candidate the state.
//
// One pass over the residuals per iteration serves both to judge a step and to compute the next one. When the
// solver stops, hessian() belongs to the final state, so its inverse is the covariance. Landmarks that the
// problem eliminates block by block are part of its state: H and g are then the Schur complement on the N
// parameters.
#pragma once

#include <cstdint>

#include "plvo/base/build.hpp"
#include "plvo/math/cholesky.hpp"
#include "plvo/math/types.hpp"

namespace plvo {

enum class LmStatus : std::uint8_t {
  kGradientTolerance,  // converged: max |g_i| ≤ gradient_tolerance
  kStepTolerance,      // converged: max |step_i| ≤ step_tolerance
  kDecreaseTolerance,  // converged: the next step promises to lower the cost by ≤ decrease_tolerance
  kMaxIterations,      // reached max_iterations; the state is the best one found
  kNotFinite,          // the initial cost, H or g is NaN or infinite; the state is unchanged
  kSingular,  // H + μ D has no Cholesky factor for any μ ≤ max_damping; the state is the best one found
  kStalled,   // no step lowers the cost for any μ ≤ max_damping; the state is the best one found
};

constexpr bool converged(LmStatus status) { return status <= LmStatus::kDecreaseTolerance; }

struct LmOptions {
  int max_iterations = 20;            // limit of tried steps: iterations ≤ max_iterations
  double gradient_tolerance = 1e-12;  // see LmStatus; in the problem's own units
  double step_tolerance = 1e-9;       // see LmStatus; in the problem's own units
  // See LmStatus; 0 disables it. If Σ is a true covariance, a step of k standard deviations gains ½ k².
  double decrease_tolerance = 0;
  double initial_damping = 1e-5;  // first μ, relative to D = diag(H); 0 < initial_damping ≤ max_damping
  double max_damping = 1e10;      // μ ≤ max_damping

  // Tries no step; only next_step() is of use afterwards.
  static constexpr LmOptions one_step() { return {.max_iterations = 0}; }
};

struct LmSummary {
  LmStatus status = LmStatus::kNotFinite;
  int iterations = 0;       // tried steps, accepted or not
  int accepted = 0;         // accepted steps
  double initial_cost = 0;  // ½ Σ rᵀ Σ⁻¹ r before the first step
  double final_cost = 0;    // the same at the final state; at most initial_cost
};

// A type-erased problem. With it, size-optimised code has one solver for all problems of N parameters.
template <int N>
class LmAnyProblem {
 public:
  template <typename Problem>
  explicit LmAnyProblem(Problem& problem)
      : problem_(&problem),
        linearize_([](void* p, const Vector<N>& step, Matrix<N, N>& H, Vector<N>& g) {
          return static_cast<Problem*>(p)->linearize(step, H, g);
        }),
        accept_([](void* p) { static_cast<Problem*>(p)->accept(); }) {}

  double linearize(const Vector<N>& step, Matrix<N, N>& H, Vector<N>& g) {
    return linearize_(problem_, step, H, g);
  }
  void accept() { accept_(problem_); }

 private:
  void* problem_;
  double (*linearize_)(void*, const Vector<N>&, Matrix<N, N>&, Vector<N>&);
  void (*accept_)(void*);
};

template <int N>
class LevenbergMarquardt {
 public:
  template <typename Problem>
  LmSummary solve(Problem& problem, const LmOptions& options = {}) {
    if constexpr (kSizeOptimised) {
      LmAnyProblem<N> any(problem);
      return run(any, options);
    } else {
      return run(problem, options);
    }
  }

  // H and g at the final state. g serves only tests of that state.
  const Matrix<N, N>& hessian() const { return H_; }
  const Vector<N>& gradient() const { return g_; }
  // The next step from the final state; zero if there is none. A caller that applies it without evaluating
  // the cost saves a pass over the residuals.
  const Vector<N>& next_step() const { return step_; }
  // The decrease of the cost that this step predicts: ½ k² for a step of k standard deviations.
  double next_decrease() const { return predicted_; }

 private:
  template <typename Problem>
  LmSummary run(Problem& problem, const LmOptions& options) {
    LmSummary summary;
    step_.setZero();
    predicted_ = 0;
    double cost = problem.linearize(Vector<N>::Zero(), H_, g_);
    summary.initial_cost = summary.final_cost = cost;
    if (!is_finite(cost) || !H_.allFinite() || !g_.allFinite()) return summary;
    problem.accept();

    double mu = options.initial_damping;
    double growth = 2;
    while (true) {
      const bool solved = solve_damped(mu);
      // Evaluated first, because Eigen sums a costly expression in a loop (PLVO_SIZE_DEFINITIONS).
      const Vector<N> slope = mu * diagonal_.cwiseProduct(step_) - g_;
      predicted_ = solved ? 0.5 * step_.dot(slope) : 0;
      if (g_.cwiseAbs().maxCoeff() <= options.gradient_tolerance)
        return finish(summary, LmStatus::kGradientTolerance);
      if (solved && step_.cwiseAbs().maxCoeff() <= options.step_tolerance)
        return finish(summary, LmStatus::kStepTolerance);
      if (solved && predicted_ <= options.decrease_tolerance)
        return finish(summary, LmStatus::kDecreaseTolerance);
      if (summary.iterations >= options.max_iterations) return finish(summary, LmStatus::kMaxIterations);
      ++summary.iterations;

      bool taken = false;
      if (solved) {
        const double new_cost = problem.linearize(step_, H_new_, g_new_);
        const double gain = (cost - new_cost) / predicted_;
        taken = is_finite(new_cost) && new_cost <= cost && H_new_.allFinite() && g_new_.allFinite();
        if (taken) {
          problem.accept();
          ++summary.accepted;
          cost = summary.final_cost = new_cost;
          H_ = H_new_;
          g_ = g_new_;
          // Nielsen's rule is smooth, unlike "halve or double"; a gain ratio of 1 divides μ by 3.
          const double t = 2 * gain - 1;
          const double shrink = 1 - t * t * t;
          mu *= shrink > 1.0 / 3 ? (shrink < 2 ? shrink : 2) : 1.0 / 3;
          growth = 2;
        }
      }
      if (!taken) {
        mu *= growth;
        growth *= 2;
        if (!(mu <= options.max_damping))
          return finish(summary, solved ? LmStatus::kStalled : LmStatus::kSingular);
      }
    }
  }

  static LmSummary finish(LmSummary& summary, LmStatus status) {
    summary.status = status;
    return summary;
  }

  // Solves (H + μ D) step = −g with D = diag(H). This is Marquardt's scaling: the step does not depend on the
  // units of the parameters. Entries of D near zero are raised, so that damping also bounds unobservable
  // parameters.
  bool solve_damped(double mu) {
    const double floor = 1e-12 * H_.diagonal().cwiseAbs().maxCoeff();
    damped_ = H_;
    for (int i = 0; i < N; ++i) {
      diagonal_[i] = H_(i, i) > floor ? H_(i, i) : floor;
      damped_(i, i) += mu * diagonal_[i];
    }
    step_.setZero();
    if (!cholesky_.factor(damped_)) return false;
    const Vector<N> step = -cholesky_.solve(g_);
    if (!step.allFinite()) return false;
    step_ = step;
    return true;
  }

  Matrix<N, N> H_, H_new_, damped_;
  Vector<N> g_, g_new_, diagonal_, step_;
  double predicted_ = 0;  // the predicted decrease of step_
  Cholesky<N> cholesky_;
};

}  // namespace plvo
