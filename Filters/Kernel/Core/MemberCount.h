// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MemberCount.h
 * @brief Number of members of an aggregate at compile time. Code that must name all members of a
 * struct can check the number. Code that omits a member then does not compile.
 *
 * Source: none. An aggregate takes as many initialisers as it has members.
 * Valid: aggregates of C++17 without base classes and without arrays or references as members.
 * Test: Testing/Kernel/check_kept_beams.py.
 */
#ifndef avianlidar_MemberCount_h
#define avianlidar_MemberCount_h

#include <cstddef>
#include <type_traits>
#include <utility>

namespace avianlidar
{
/// Type that converts to a member of any type. The conversion is declared and not defined.
struct AnyMember
{
  template <class T>
  operator T() const;
};

template <class T, class Numbers, class = void>
struct TakesMembers : std::false_type
{
};
template <class T, std::size_t... I>
struct TakesMembers<T, std::index_sequence<I...>,
  std::void_t<decltype(T{ (static_cast<void>(I), AnyMember{})... })>> : std::true_type
{
};

template <class T, std::size_t N = 0>
constexpr std::size_t memberCount()
{
  if constexpr (TakesMembers<T, std::make_index_sequence<N + 1>>::value)
  {
    return memberCount<T, N + 1>();
  }
  else
  {
    return N;
  }
}
}

#endif
