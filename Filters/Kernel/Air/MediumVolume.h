// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MediumVolume.h
 * @brief Where a medium is: in a layer, a box, an ellipsoid or a closed surface; and where rays
 * cross it.
 *
 * A ray crosses a medium in parts. In each the density falls exponentially along the ray: that of a
 * layer falls above its top, that of the others is constant. So the optical depth of a part, and of
 * any piece of it, is a closed form.
 *
 * Source: none.
 * Valid: exact but for rounding. A closed surface is crossed where the tree's triangle test says
 * so; its shells face outward but for holes, as closedShells() turns them, and what they enclose is
 * inside.
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
  Layer = 1, ///< between two heights, and fading above
  Box = 2,   ///< parallelepiped with right angles
  Ellipsoid = 3,
  Surface = 4 ///< inside a closed surface
};

struct MediumVolume
{
  MediumShape shape = MediumShape::Everywhere;
  /// Of box and ellipsoid, and of a box about a closed surface, m. A layer's heights count from it.
  Vec3 centre{ 0.0 };
  std::array<Vec3, 3> halfAxes{ Vec3(1.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), Vec3(0.0, 0.0, 1.0) };
  Vec3 up{ 0.0, 0.0, 1.0 };                                 ///< of a layer, unit vector
  double bottom = -std::numeric_limits<double>::infinity(); ///< of a layer, m
  double top = 0.0;      ///< of a layer: the height up to which it is dense, m
  double softness = 0.0; ///< m, by which the density above falls to 1/e; 0: none there
  std::shared_ptr<const CollisionTree> surface;
  Vec3 velocity{ 0.0 }; ///< m/s; the volume is here at the time 0

  bool isBounded() const { return this->shape >= MediumShape::Box; }
  Vec3 centreAt(double seconds) const { return this->centre + seconds * this->velocity; }
  /// Radius of the ball about its centre that holds it, m.
  double radius() const;
};

/// Part of a ray in a medium, from one range to another, m.
struct MediumCrossing
{
  double begin, end;
  double density; ///< at the beginning, over that of the medium
  double fall;    ///< 1/m: exp(-fall (range - begin)) times that

  /// Integral of the density up to a range, m.
  double upTo(double range) const;
  double densityAt(double range) const;
};

/// Empty, or a sentence that names what is wrong with a volume, and what was expected.
std::string checkVolume(const MediumVolume& volume);

/// Finds crossings. One per thread.
class MediumCrosser
{
public:
  /// Append the parts of a ray up to `far`, m, that lie in a volume. @param direction unit vector
  /// @param seconds when the ray passes
  void find(const MediumVolume& volume, const Vec3& origin, const Vec3& direction, double far,
    double seconds, std::vector<MediumCrossing>& parts);

  struct Hit
  {
    double range; ///< m
    int entered;  ///< shells that the ray enters: 1 or -1
    bool isAmid;  ///< not on a side of the triangle
  };

private:
  void findInSurface(const MediumVolume& volume, const Vec3& origin, const Vec3& direction,
    double far, std::vector<MediumCrossing>& parts);
  TraversalStack Stack;
  std::vector<Hit> Hits;
};

/// Whether a volume is, to each side of its middle, wider than a beam at its far end, so that none
/// of it lies between the beam's axis and its rim.
bool isWiderThan(const MediumVolume& volume, const BeamFrame& frame, double far);

/// Whether a border of a volume at rest, or where a layer fades, may lie in a beam: conservative.
bool mayMeetBorder(const MediumVolume& volume, const BeamFrame& frame, double far);

/// Whether a beam may meet a volume within `far`, m: conservative.
bool mayMeet(const MediumVolume& volume, const BeamFrame& frame, double far, double seconds);
}

#endif
