// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file TriangleOrder.h
 * @brief An order of triangles that does not depend on the order in which the triangles are given.
 *
 * Ties between coincident faces and the rounding of sums depend on the order of triangles. Sorted
 * in this order, a surface gives equal echoes however it is divided among files, blocks or
 * processes. Triangles are sorted by object and, within an object, by the middle of their longest
 * side along a Morton curve, so neighbours in space are neighbours in memory. The two halves of a
 * rectangle share their longest side, so one half follows the other half (BeamTriangles.h joins the
 * halves).
 *
 * Source: G. M. Morton, A Computer Oriented Geodetic Data Base, IBM, 1966.
 * Differs: 21 bits per axis. Triangles at one place of the curve are ordered by the coordinates of
 * the middle, then by their corners, then by material.
 * Valid: finite coordinates. Triangles with equal keys keep their order.
 * Test: TestTriangleOrder.cxx.
 */
#ifndef avianlidar_TriangleOrder_h
#define avianlidar_TriangleOrder_h

#include "TriangleMesh.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Place, of 63 bits, of a point in a box along the Morton curve through the box.
std::uint64_t placeOnCurve(const Vec3& point, const Vec3& lower, const Vec3& upper);

/// Numbers of the triangles, sorted; empty if the triangles are sorted already.
/// @param objectIds, materialIds ids of each triangle
std::vector<std::uint32_t> triangleOrder(
  const TriangleMesh& mesh, const std::vector<int>& objectIds, const std::vector<int>& materialIds);

/// Bring one value per triangle into the order that triangleOrder() returned.
template <class T, class Order>
void reorder(std::vector<T>& values, const Order& order)
{
  const auto isFirst = [&](const T& value) { return value == values.front(); };
  if (order.empty() || std::all_of(values.begin(), values.end(), isFirst))
  {
    return;
  }
  std::vector<T> sorted(values.size());
  for (std::size_t i = 0; i < sorted.size(); ++i)
  {
    sorted[i] = values[order[i]];
  }
  values.swap(sorted);
}
}

#endif
