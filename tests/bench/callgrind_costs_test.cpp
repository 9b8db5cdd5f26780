// SPDX-License-Identifier: Apache-2.0
// Tests with a hand-written profile in callgrind's compressed form: a name appears once and then as a number;
// calls state the inclusive cost of the callee; line numbers are relative to the previous line.
#include "plvo/bench/stages/callgrind_costs.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace plvo::bench {
namespace {

TEST(CallgrindCosts, FunctionIncludesItsCallees) {
  std::istringstream file(
      "version: 1\n"
      "positions: line\n"
      "events: Ir\n"
      "summary: 999\n"
      "\n"
      "fl=(1) main.cpp\n"
      "fn=(1) track(Frame const&)\n"
      "10 5\n"
      "+1 2\n"
      "cfn=(2) detect(int) [clone .isra.0]\n"
      "calls=3 20\n"
      "* 100\n"
      "cfi=(2) other.cpp\n"
      "cfn=(3) describe(int)\n"
      "calls=1 7\n"
      "-2 40\n"
      "\n"
      "fn=(2)\n"
      "20 60\n"
      "cfn=(3)\n"
      "calls=1 7\n"
      "21 40\n"
      "\n"
      "fn=(3)\n"
      "7 80\n");
  const CallgrindCosts costs = read_callgrind(file);
  EXPECT_EQ(costs.total, 5U + 2 + 60 + 80);
  EXPECT_EQ(costs.of("track("), 147U);
  EXPECT_EQ(costs.of("detect("), 100U);
  EXPECT_EQ(costs.of("describe("), 80U);
  EXPECT_EQ(costs.of("de"), 180U);
  EXPECT_EQ(costs.of("absent("), 0U);
}

TEST(CallgrindCosts, LambdaBelongsToItsFunction) {
  std::istringstream file(
      "events: Ir\n"
      "fn=(1) track(int)\n"
      "10 5\n"
      "cfn=(2) track(int)::{lambda(int)#1}::operator()(int) const\n"
      "calls=1 7\n"
      "* 100\n"
      "\n"
      "fn=(2)\n"
      "7 100\n");
  const CallgrindCosts costs = read_callgrind(file);
  EXPECT_EQ(costs.total, 105U);
  EXPECT_EQ(costs.of("track("), 105U);
}

TEST(CallgrindCosts, FileWithoutProfileHasNoCosts) {
  std::istringstream file("not a profile\n");
  EXPECT_EQ(read_callgrind(file).total, 0U);
}

}  // namespace
}  // namespace plvo::bench
