// SPDX-License-Identifier: Apache-2.0
// The members of an aggregate in their order, without a list of their names: a member that joins the struct
// cannot be forgotten. The number of members is the largest number of initialisers that the aggregate
// accepts. Structured bindings then refer to them; with a wrong number they do not compile.
#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>

namespace plvo::python {

// Initialises a member of any type; never called.
struct AnyMember {
  template <typename Member>
  operator Member() const;
};

template <typename Aggregate, typename... Given>
constexpr std::size_t member_count() {
  if constexpr (requires { Aggregate{Given{}..., AnyMember{}}; })
    return member_count<Aggregate, Given..., AnyMember>();
  else
    return sizeof...(Given);
}

// A tuple of references to the members.
template <typename Aggregate>
auto members(Aggregate& of) {
  constexpr std::size_t kCount = member_count<std::remove_const_t<Aggregate>>();
  static_assert(kCount >= 1 && kCount <= 20, "members(): add a case for this number of members");
  // clang-format off
  if constexpr (kCount == 1) { auto& [a] = of; return std::tie(a); }
  else if constexpr (kCount == 2) { auto& [a, b] = of; return std::tie(a, b); }
  else if constexpr (kCount == 3) { auto& [a, b, c] = of; return std::tie(a, b, c); }
  else if constexpr (kCount == 4) { auto& [a, b, c, d] = of; return std::tie(a, b, c, d); }
  else if constexpr (kCount == 5) { auto& [a, b, c, d, e] = of; return std::tie(a, b, c, d, e); }
  else if constexpr (kCount == 6) { auto& [a, b, c, d, e, f] = of; return std::tie(a, b, c, d, e, f); }
  else if constexpr (kCount == 7) { auto& [a, b, c, d, e, f, g] = of; return std::tie(a, b, c, d, e, f, g); }
  else if constexpr (kCount == 8) {
    auto& [a, b, c, d, e, f, g, h] = of;
    return std::tie(a, b, c, d, e, f, g, h);
  } else if constexpr (kCount == 9) {
    auto& [a, b, c, d, e, f, g, h, i] = of;
    return std::tie(a, b, c, d, e, f, g, h, i);
  } else if constexpr (kCount == 10) {
    auto& [a, b, c, d, e, f, g, h, i, j] = of;
    return std::tie(a, b, c, d, e, f, g, h, i, j);
  } else if constexpr (kCount == 11) {
    auto& [a, b, c, d, e, f, g, h, i, j, k] = of;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k);
  } else if constexpr (kCount == 12) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l] = of;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l);
  } else if constexpr (kCount == 13) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = of;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m);
  } else if constexpr (kCount == 14) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n] = of;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n);
  } else if constexpr (kCount == 15) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o] = of;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o);
  } else if constexpr (kCount == 16) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] = of;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p);
  } else if constexpr (kCount == 17) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q] = of;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q);
  } else if constexpr (kCount == 18) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r] = of;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r);
  } else if constexpr (kCount == 19) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s] = of;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s);
  } else {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t] = of;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t);
  }
  // clang-format on
}

}  // namespace plvo::python
