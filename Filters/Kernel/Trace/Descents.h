// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Descents.h
 * @brief Descent of a tree, wide or not: a cone, or one ray.
 */
#ifndef avianlidar_Descents_h
#define avianlidar_Descents_h

#include "BeamVolumeTest.h"
#include "Traversal.h"
#include "TriangleTest.h"

#include <variant>

namespace avianlidar
{
/// A cone down the tree, wide or not.
template <class Visitor>
std::uint64_t descendCone(
  const CollisionTree& tree, const BeamVolumeTest& probe, Visitor& visitor, TraversalStack& stack)
{
  WideCone cone;
  if (!tree.wide.nodes.empty() && cone.set(tree.wide, probe))
  {
    return descendWide(tree, cone, visitor, stack);
  }
  return std::visit([&](const auto& volumes)
    { return descend(tree, volumes, probe, visitor, stack); },
    tree.volumes());
}

/// One ray down the tree. `origin` is relative to the apex.
template <class Visitor>
std::uint64_t descendRay(const CollisionTree& tree, const Vec3& apex, const Vec3& origin,
  const Vec3& direction, double angularMargin, Visitor& visitor, TraversalStack& stack)
{
  WideRay ray;
  if (!tree.wide.nodes.empty() &&
    ray.set(tree.wide, apex, origin, direction, angularMargin + 2.0 * HitMargin))
  {
    return descendWide(tree, ray, visitor, stack);
  }
  const RayVolumeTest probe(apex, origin, direction, angularMargin);
  return std::visit([&](const auto& volumes)
    { return descend(tree, volumes, probe, visitor, stack); },
    tree.volumes());
}
}

#endif
