// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file EffectiveArea.h
 * @brief What an object shows of itself to an observer: its silhouette weighted by the cosine of
 * incidence, mutual shadow included. A lidar receives of a matt object that one beam holds in
 * proportion to it.
 *
 * Source: none; the sum over the visible polygons of VisiblePolygons.h.
 * Valid: for objects that are small from the observer, an error of the square of half their angle.
 * Test: TestEffectiveArea.cxx.
 */
#ifndef avianlidar_EffectiveArea_h
#define avianlidar_EffectiveArea_h

#include "Bird.h"
#include "DetectionLaw.h"
#include "TriangleMesh.h"

#include <memory>
#include <vector>

namespace avianlidar
{
/// m^2; NaN from a point inside the sphere about the object, or so near that it takes more than 60
/// degrees to either side. @param center @param radius of a sphere about all points, m
double effectiveArea(const std::shared_ptr<const TriangleMesh>& mesh, const Vec3& center,
  double radius, const Vec3& observer);

/// Effective areas of a bird in flight, seen from the side at 3 degrees of elevation: heading and
/// wing phase uniform.
struct BirdAreas
{
  double mean;                   ///< m^2
  std::vector<TargetPose> poses; ///< 24, equally likely, by rising area
};
BirdAreas effectiveAreas(const BirdShape& shape, bool gliding);
}

#endif
