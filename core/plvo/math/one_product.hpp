// SPDX-License-Identifier: Apache-2.0
// Eigen instantiates products and long sums for every combination of matrix sizes and kinds. In
// size-optimised code, one function computes all products, and one function per length computes sums. They
// use Eigen's order of summation: first one half of the terms, then the other, each half recursively. The
// results are therefore bit-identical. This file assumes Eigen 3.4; golden_test detects differences.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <type_traits>

namespace plvo::one_product {

struct Strides {
  std::uint8_t row, column;  // offset to the entry below, and to the entry on the right
};

// Compile-time description of a product.
struct Shape {
  std::uint8_t rows, columns, depth;
  std::int8_t sign;  // 1: add to the destination; −1: subtract from it; 0: overwrite it
  Strides left, right, to;
};

inline constexpr int kMostDepth = 13;

// Σ a b over N entries.
template <int N>
double dot(const double* a, int a_step, const double* b, int b_step) {
  if constexpr (N == 1) {
    return *a * *b;
  } else {
    constexpr int kHalf = N / 2;
    return dot<kHalf>(a, a_step, b, b_step) +
           dot<N - kHalf>(a + kHalf * a_step, a_step, b + kHalf * b_step, b_step);
  }
}

inline double dot(const double* a, int a_step, const double* b, int b_step, int depth) {
  switch (depth) {
    case 1: return dot<1>(a, a_step, b, b_step);
    case 2: return dot<2>(a, a_step, b, b_step);
    case 3: return dot<3>(a, a_step, b, b_step);
    case 4: return dot<4>(a, a_step, b, b_step);
    case 6: return dot<6>(a, a_step, b, b_step);
    case 7: return dot<7>(a, a_step, b, b_step);
    default: return dot<kMostDepth>(a, a_step, b, b_step);
  }
}

[[gnu::noinline]] inline void multiply(const Shape& shape, const double* left, const double* right,
                                       double* to) {
  for (int column = 0; column < shape.columns; ++column)
    for (int row = 0; row < shape.rows; ++row) {
      const double entry = dot(left + row * shape.left.row, shape.left.column,
                               right + column * shape.right.column, shape.right.row, shape.depth);
      double& out = to[row * shape.to.row + column * shape.to.column];
      out = shape.sign == 0 ? entry : shape.sign > 0 ? out + entry : out - entry;
    }
}

template <int N>
[[gnu::noinline]] double sum(const double* x) {
  if constexpr (N == 1)
    return *x;
  else if constexpr (N <= 3)
    return *x + sum<N - 1>(x + 1);
  else
    return sum<N / 2>(x) + sum<N - N / 2>(x + N / 2);
}

template <typename T>
constexpr Strides strides() {
  using Eigen::internal::inner_stride_at_compile_time;
  using Eigen::internal::outer_stride_at_compile_time;
  constexpr int kInner = inner_stride_at_compile_time<T>::ret;
  constexpr int kOuter = outer_stride_at_compile_time<T>::ret;
  return T::IsRowMajor ? Strides{kOuter, kInner} : Strides{kInner, kOuter};
}

template <typename To, typename Left, typename Right, int Sign>
inline constexpr Shape kShape = {Left::RowsAtCompileTime,
                                 Right::ColsAtCompileTime,
                                 Left::ColsAtCompileTime,
                                 Sign,
                                 strides<Left>(),
                                 strides<Right>(),
                                 strides<To>()};

template <typename T>
constexpr bool lies_in_memory() {
  using namespace Eigen::internal;
  return (traits<T>::Flags & Eigen::DirectAccessBit) != 0 && inner_stride_at_compile_time<T>::ret > 0 &&
         outer_stride_at_compile_time<T>::ret > 0;
}

template <typename T>
concept Numbers = std::is_same_v<typename T::Scalar, double> && T::SizeAtCompileTime != Eigen::Dynamic;

template <typename T>
concept InMemory = Numbers<T> && lies_in_memory<T>();

// An operand that is an expression (−A, 2 A, A + B) is evaluated into memory first; the rounding of its
// entries is the same.
template <typename T>
using Stored = std::conditional_t<InMemory<T>, T, typename T::PlainObject>;

constexpr bool knows_depth(int depth) {
  return (depth >= 1 && depth <= 4) || depth == 6 || depth == 7 || depth == kMostDepth;
}

template <typename Functor>
inline constexpr int kSign = 2;
template <>
inline constexpr int kSign<Eigen::internal::assign_op<double, double>> = 0;
template <>
inline constexpr int kSign<Eigen::internal::add_assign_op<double, double>> = 1;
template <>
inline constexpr int kSign<Eigen::internal::sub_assign_op<double, double>> = -1;

template <typename Left, typename Functor>
concept Multiplied = (knows_depth(Left::ColsAtCompileTime) && kSign<Functor> != 2);

template <typename Entries>
concept Long = (Entries::SizeAtCompileTime > 8);

}  // namespace plvo::one_product

namespace Eigen::internal {

template <plvo::one_product::InMemory To, plvo::one_product::Numbers Left, plvo::one_product::Numbers Right,
          typename Functor>
requires plvo::one_product::Multiplied<Left, Functor>
struct Assignment<To, Product<Left, Right, LazyProduct>, Functor, Dense2Dense> {
  static void run(To& to, const Product<Left, Right, LazyProduct>& product, const Functor&) {
    using namespace plvo::one_product;
    const Stored<Left>& left = product.lhs();
    const Stored<Right>& right = product.rhs();
    multiply(kShape<To, Stored<Left>, Stored<Right>, kSign<Functor>>, left.data(), right.data(), to.data());
  }
};

// A product inside an expression is evaluated first; the expression reads the result.
template <plvo::one_product::Numbers Left, plvo::one_product::Numbers Right>
requires(plvo::one_product::knows_depth(
    Left::ColsAtCompileTime)) struct evaluator<Product<Left, Right, LazyProduct>>
    : evaluator<typename Product<Left, Right, LazyProduct>::PlainObject> {
  using Result = typename Product<Left, Right, LazyProduct>::PlainObject;

  explicit evaluator(const Product<Left, Right, LazyProduct>& product)
      : evaluator<Result>(result_), result_(product.rows(), product.cols()) {
    call_assignment_no_alias(result_, product);
  }

 private:
  Result result_;
};

// Squared norms of matrices. Sums of fewer than nine entries stay inline, because they are no larger than the
// call.
template <plvo::one_product::Long Entries>
struct redux_impl<scalar_sum_op<double, double>, Entries, DefaultTraversal, CompleteUnrolling> {
  template <typename Xpr>
  static double run(const Entries& entries, const scalar_sum_op<double, double>&, const Xpr& xpr) {
    constexpr int kSize = Entries::SizeAtCompileTime;
    double terms[kSize];
    double* term = terms;
    for (Index outer = 0; outer < xpr.outerSize(); ++outer)
      for (Index inner = 0; inner < xpr.innerSize(); ++inner)
        *term++ = entries.coeffByOuterInner(outer, inner);
    return plvo::one_product::sum<kSize>(terms);
  }
};

}  // namespace Eigen::internal
