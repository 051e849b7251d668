// SPDX-License-Identifier: BSD-3-Clause
#include "EffectiveArea.h"

#include "VisiblePolygons.h"

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace avianlidar
{
double effectiveArea(const std::shared_ptr<const TriangleMesh>& mesh, const Vec3& center,
  double radius, const Vec3& observer)
{
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  const Vec3 to = center - observer;
  const double distance = safeLength(to);
  if (!(radius < distance))
  {
    return nothing;
  }
  const double half = std::asin(radius / distance);
  if (!(half > 0.0 && half < Pi / 3.0))
  {
    return nothing;
  }
  CollisionTree tree;
  tree.mesh = mesh;
  const BeamFrame frame = makeBeamFrame(observer, to, half);
  constexpr std::size_t few = 16; // pieces of a few triangles may be more than three times as many
  PolygonFinder finder(tree, mesh->size() + few);
  std::vector<std::uint32_t> triangles(mesh->size());
  std::iota(triangles.begin(), triangles.end(), 0u);
  finder.begin(frame);
  finder.add(triangles.data(), triangles.size());
  std::unique_ptr<VisiblePolygons> seen;
  const SeenByBeam found = finder.find(seen);
  if (found != SeenByBeam::Polygons)
  {
    return found == SeenByBeam::Nothing ? 0.0 : nothing;
  }
  double sum = 0.0;
  seen->forEach(
    [&](const PolygonSurface& surface, const PlaneRing& ring)
    {
      PlanePoint middle{ 0.0, 0.0 };
      for (int i = 0; i < ring.size; ++i)
      {
        middle.x += ring.corners[i].x / ring.size;
        middle.y += ring.corners[i].y / ring.size;
      }
      const double away = safeLength(frame.direction(middle.x, middle.y));
      const double range = away / surface.inverse.at(middle);
      const double solidAngle = ring.area() * frame.tanHalf * frame.tanHalf / (away * away * away);
      sum += range * range * solidAngle * (std::fabs(surface.height) / range);
    });
  return sum;
}
}
