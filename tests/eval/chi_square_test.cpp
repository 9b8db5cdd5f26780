// SPDX-License-Identifier: Apache-2.0
#include "plvo/eval/chi_square.hpp"

#include <gtest/gtest.h>

namespace plvo::eval {
namespace {

// Values from published tables.
TEST(ChiSquare, QuantilesAreThoseOfTheTables) {
  struct Row {
    double probability;
    int dof;
    double value;
  };
  for (const Row& row :
       {Row{0.95, 6, 12.5916}, Row{0.95, 3, 7.8147}, Row{0.5, 6, 5.3481}, Row{0.5, 3, 2.3660},
        Row{0.975, 1, 5.0239}, Row{0.01, 2, 0.0201}, Row{0.95, 100, 124.3421}}) {
    EXPECT_NEAR(chi_square_quantile(row.probability, row.dof), row.value, 1e-4) << row.dof;
    EXPECT_NEAR(chi_square_tail(chi_square_quantile(row.probability, row.dof), row.dof), 1 - row.probability,
                1e-9);
  }
}

TEST(ChiSquare, ManyDegreesOfFreedomAreNearlyNormal) {
  const int dof = 60000;
  const double sigma = 346.4102;  // √(2·60000)
  EXPECT_NEAR(chi_square_quantile(0.975, dof), dof + 1.95996 * sigma, 0.01 * sigma);
  EXPECT_NEAR(chi_square_quantile(0.025, dof), dof - 1.95996 * sigma, 0.01 * sigma);
  EXPECT_EQ(chi_square_tail(0, dof), 1);
}

}  // namespace
}  // namespace plvo::eval
