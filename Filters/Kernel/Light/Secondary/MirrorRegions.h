// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MirrorRegions.h
 * @brief Mirror paths of a beam whose visible surfaces are known: for each pair of surfaces the
 * part of the beam whose light goes from one to the other.
 *
 * Behind a plane mirror lies a mirrored world, and in it a path over the mirror is straight. So the
 * rays that go from one surface to another fill a convex polygon of the beam's plane: a point of
 * the second surface is a projective function of the ray, and each of its sides a straight line of
 * rays. The polygon is found by cutting that of the first surface. Samples fill it alone, in strata
 * of equal area, as densely as rays in the disc, and at least two.
 *
 * Where polygons are what the beam sees (VisiblePolygons.h), both ends of a path are visible. Of a
 * beam in cells the surfaces are whole triangles, and both ends are looked at from the apex. What
 * lies between the ends is asked of the tree.
 *
 * Source: paper, Sec. 3.4, the beam constraint; Heckbert and Hanrahan, "Beam Tracing Polygonal
 * Objects", SIGGRAPH 1984, for the mirrored world.
 * Differs: the paper follows rays.
 * Valid: plane surfaces. Depends on the beam and what it sees alone, not on materials or limits. Of
 * a beam in cells paths start and end on surfaces that its grid of rays meets.
 * Test: TestMirrorRegions.cxx, TestPolygonPaths.cxx.
 */
#ifndef avianlidar_MirrorRegions_h
#define avianlidar_MirrorRegions_h

#include "BeamSamples.h"
#include "BeamShape.h"
#include "ScanSetup.h"
#include "SecondaryTrace.h"
#include "VisiblePolygons.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Finds the mirror paths of one beam after the other. Reusable without allocation; one per thread.
class MirrorRegions
{
public:
  MirrorRegions(const ScanSetup& setup, const SceneTriangles& scene);

  /// False if a beam sees too many polygons.
  static bool takes(const VisiblePolygons& seen);

  /// Begin a beam. @param cells samples of what it sees, if polygons have hidden parts; else null
  void begin(std::uint64_t beam, const BeamFrame& frame, const VisiblePolygons& seen,
    const BeamSamples* cells);

  std::size_t surfaces() const { return this->Surfaces.size(); }

  /// Bound of the sum of the throughputs of the mirror paths that start on a surface.
  /// @param returned mostOverMirror()
  double bound(std::size_t surface, double returned) const;

  /// Append the paths that start on a surface and end on another. @return samples drawn for them
  std::size_t search(std::size_t surface, std::vector<MirrorPath>& paths);

private:
  /// A box in the beam's plane.
  struct Box
  {
    PlanePoint low{ 1e300, 1e300 }, high{ -1e300, -1e300 };
    void extend(const PlanePoint& p);
    bool meets(const Box& other) const;
  };
  /// A plane that the beam sees.
  struct Surface
  {
    const PlaneSurface* seen;
    Vec3 normal;                       ///< unit, towards the apex
    Vec3 mirror;                       ///< the same as BeamFrame::toPlane()
    double height;                     ///< distance of the plane from the apex, m
    PlaneLine along;                   ///< normal . direction of a ray
    PlaneLine inverse;                 ///< 1/z, 1/m
    std::uint32_t first, end;          ///< of its facets
    Vec3 low{ 1e300 }, high{ -1e300 }; ///< box of their corners, as BeamFrame::toPlane()
    Box box;
    double share; ///< of the pulse that arrives, at most
  };
  /// A convex polygon of it.
  struct Facet
  {
    PlaneRing ring;
    Box box;
    std::uint32_t surface;
    std::uint32_t firstPoint;
  };
  /// Where the rays of a surface end on another one: (x, y)/z.
  struct Image
  {
    PlaneLine w; ///< 1/z of the second plane, mirrored on the first
    PlaneLine x, y, z;
  };
  /// Rays that go from one facet to another.
  struct Region
  {
    std::uint32_t one, two; ///< facets
    PlaneRing ring;
    double area;
  };
  void addFacets();
  void fillLanes();
  void setSurface(Surface& surface) const;
  Box mirror(const Surface& one, const Surface& two);
  bool imageOf(const Surface& one, const Surface& two, Image& image) const;
  void findRegions(const Surface& one, const Surface& two);
  bool cutOut(const Facet& one, const Facet& two, const Image& image, PlaneRing& ring) const;
  void placeIn(std::size_t first, std::size_t end, std::vector<MirrorPath>& paths);
  bool findPath(const Region& region, const PlanePoint& p, MirrorPath& path);

  const ScanSetup& Setup;
  const SceneTriangles& Scene;
  const BeamShape Shape;
  std::vector<Surface> Surfaces;
  std::vector<Facet> Facets;   ///< by surface
  std::vector<Vec3> Points;    ///< corners of all facets, as BeamFrame::toPlane()
  std::vector<double> Lanes;   ///< planes and boxes of surfaces, one value of all after the other
  std::vector<double> Facing;  ///< 1 for surfaces that face the one on which paths start
  std::vector<double> Heights; ///< of corners above the plane of a mirror, m
  std::vector<Box> Mirrored;   ///< boxes of the facets of a surface, mirrored
  std::vector<Region> Regions;

  // The beam.
  std::uint64_t Beam = 0;
  BeamFrame Frame;
  const VisiblePolygons* Seen = nullptr;
  double ShareOfArea = 0.0;
  std::uint32_t Sample = 0; ///< number of the sample on the surface; two neighbours are a stratum
  std::uint64_t Pair = 0;   ///< surfaces between which paths were placed last
  std::uint64_t Drawn = 0;  ///< for these
  std::uint32_t Start = 0;  ///< surface on which paths start
};
}

#endif
