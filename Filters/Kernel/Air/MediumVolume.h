// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MediumVolume.h
 * @brief Volumes of media (layers, boxes, ellipsoids, closed surfaces), and how rays cross them.
 *
 * A ray crosses a medium in parts. The density in a part is constant or, above the top of a layer
 * only, changes exponentially along the ray. So the optical depth of a part, and of any piece of a
 * part, has a closed form.
 *
 * Source: none.
 * Valid: exact up to rounding. The tree's triangle test decides where a ray crosses a closed
 * surface. Shells face outward, except the shells of holes (closedShells()). The space that a shell
 * encloses is inside the volume, except the space of holes.
 * Test: TestMediumVolume.cxx.
 */
#ifndef avianlidar_MediumVolume_h
#define avianlidar_MediumVolume_h

#include "BeamFrame.h"
#include "CollisionTree.h"

#include <array>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace avianlidar
{
enum class MediumShape
{
  Everywhere = 0,
  Layer = 1, ///< space between two heights, and a fading part above the upper height
  Box = 2,   ///< box with right angles, in any orientation
  Ellipsoid = 3,
  Surface = 4 ///< space inside a closed surface
};

struct MediumVolume
{
  MediumShape shape = MediumShape::Everywhere;
  /// Centre of a box, an ellipsoid or the box about a closed surface, m; for a layer, the point
  /// from which heights count, m.
  Vec3 centre{ 0.0 };
  std::array<Vec3, 3> halfAxes{ Vec3(1.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), Vec3(0.0, 0.0, 1.0) };
  Vec3 up{ 0.0, 0.0, 1.0 }; ///< upward direction of a layer, unit vector
  double bottom = -std::numeric_limits<double>::infinity(); ///< lowest height of a layer, m
  double top = 0.0;      ///< height up to which a layer has its full density, m
  double softness = 0.0; ///< height above `top` at which the density is 1/e, m; 0: no fading part
  std::shared_ptr<const CollisionTree> surface;
  Vec3 velocity{ 0.0 }; ///< velocity of the volume from its place at time 0, m/s

  bool isBounded() const { return this->shape >= MediumShape::Box; }
  Vec3 centreAt(double seconds) const { return this->centre + seconds * this->velocity; }
  /// Radius, m, of a ball about the centre that contains a bounded volume.
  double radius() const;
};

/// Part of a ray in a medium.
struct MediumCrossing
{
  double begin, end; ///< ranges, m
  double density;    ///< relative density at `begin`; 1: full density
  double fall;       ///< rate of decay, 1/m: `density` is multiplied by exp(-fall (range - begin))

  /// Integral of the relative density from `begin` to a range, m.
  double upTo(double range) const;
  double densityAt(double range) const;
};

/// Error that names what is wrong with a volume and what was expected, or an empty text.
std::string checkVolume(const MediumVolume& volume);

/// Finds the parts of rays that lie in a volume. Each thread needs its own object.
class MediumCrosser
{
public:
  /// Append the parts of a ray that lie in a volume. @param direction unit vector @param far length
  /// of the ray, m @param seconds time of the ray, s
  void find(const MediumVolume& volume, const Vec3& origin, const Vec3& direction, double far,
    double seconds, std::vector<MediumCrossing>& parts);

  /// Hit of a ray on a closed surface.
  struct Hit
  {
    double range; ///< range of the hit, m
    int entered;  ///< direction: 1 if the ray enters the shell, -1 if the ray leaves the shell
    bool isAmid;  ///< true if the hit does not lie on a side of the triangle
  };

private:
  void findInSurface(const MediumVolume& volume, const Vec3& origin, const Vec3& direction,
    double far, std::vector<MediumCrossing>& parts);
  TraversalStack Stack;
  std::vector<Hit> Hits;
};

/// True if each half axis of a volume exceeds the beam's width at the volume's far end. Such a
/// volume does not fit between the axis and the rim of the beam. The result is always true for
/// layers and always false for closed surfaces.
bool isWiderThan(const MediumVolume& volume, const BeamFrame& frame, double far, double seconds);

/// True if a border or the fading part of a volume at rest may lie in a beam. The result is never
/// false if a border or the fading part lies in the beam.
bool mayMeetBorder(const MediumVolume& volume, const BeamFrame& frame, double far);

/// True if a beam may meet a volume within `far`, m. The result is never false for a beam that
/// meets the volume. @param seconds time of the beam, s
bool mayMeet(const MediumVolume& volume, const BeamFrame& frame, double far, double seconds);
}

#endif
