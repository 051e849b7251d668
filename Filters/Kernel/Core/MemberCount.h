// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MemberCount.h
 * @brief How many members an aggregate has, known to the compiler: where all members of a struct
 * must be named, one that was forgotten does not compile.
 *
 * Source: none; as many members as an aggregate takes initialisers.
 * Valid: aggregates of C++17 without base classes, arrays or references as members.
 * Test: Testing/Kernel/check_kept_beams.py.
 */
#ifndef avianlidar_MemberCount_h
#define avianlidar_MemberCount_h

#include <cstddef>
#include <type_traits>
#include <utility>

namespace avianlidar
{
/// Stands for a member of any type. Is only declared.
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
