// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MirrorRegions.h
 * @brief Mirror paths of a beam whose visible surfaces are known, sampled in the parts of the beam
 * whose light goes from one surface to another.
 *
 * In the mirror image of the scene behind a plane mirror, a mirror path continues as a straight
 * line. The point on the second surface is therefore a projective function of the ray, and each
 * side of the second surface is a straight line of rays. The rays from one surface to another fill
 * a convex polygon of the beam's plane, a region, which is cut from the polygon of the first
 * surface. Samples lie only in regions, in strata of equal area. They are twice as dense as rays in
 * the disc, and each region has at least two.
 *
 * In an integrated beam all polygons are visible (VisiblePolygons.h), and so are both ends of a
 * path. In a beam in cells the surfaces are whole triangles, and rays from the apex test both ends.
 * A ray through the tree tests the segment between the ends (SecondaryTracer.h).
 *
 * Source: paper, Sec. 3.4, the beam constraint; Heckbert and Hanrahan, "Beam Tracing Polygonal
 * Objects", SIGGRAPH 1984, for the mirror image.
 * Differs: the paper follows rays.
 * Valid: plane surfaces. Regions depend only on the beam and the visible surfaces, not on materials
 * or limits. In a beam in cells paths start and end on surfaces that its grid of rays meets.
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

  /// Begin a beam. @param cells samples of a beam in cells (polygons have hidden parts), or null
  void begin(std::uint64_t beam, const BeamFrame& frame, const VisiblePolygons& seen,
    const BeamSamples* cells);

  std::size_t surfaces() const { return this->Surfaces.size(); }

  /// Upper bound of the sum of the throughputs of the mirror paths that start on a surface.
  /// @param returned mirrorReturnBound()
  double bound(std::size_t surface, double returned) const;

  /// Append the paths that start on a surface. @return number of samples drawn for them
  std::size_t search(std::size_t surface, std::vector<MirrorPath>& paths);

private:
  /// A box in the beam's plane.
  struct Box
  {
    PlanePoint low{ 1e300, 1e300 }, high{ -1e300, -1e300 };
    void extend(const PlanePoint& p);
    bool meets(const Box& other) const;
  };
  /// A plane surface that the beam sees.
  struct Surface
  {
    const PlaneSurface* seen;
    Vec3 normal;                       ///< unit, towards the apex
    Vec3 mirror;                       ///< `normal` by BeamFrame::toPlane()
    double height;                     ///< distance of the plane from the apex, m
    PlaneLine along;                   ///< scalar product of `normal` and the direction of a ray
    PlaneLine inverse;                 ///< 1/z, 1/m
    std::uint32_t first, end;          ///< its facets
    Vec3 low{ 1e300 }, high{ -1e300 }; ///< box of their corners, by BeamFrame::toPlane()
    Box box;
    double share; ///< share of the pulse that arrives; an upper bound for polygons
  };
  /// A convex polygon of a surface.
  struct Facet
  {
    PlaneRing ring;
    Box box;
    std::uint32_t surface;
    std::uint32_t firstPoint; ///< place of its first corner in `Points`
  };
  /// Point (x, y)/z at which a ray reflected by one surface meets another, as functions of the ray.
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
  std::vector<Facet> Facets;   ///< sorted by surface
  std::vector<Vec3> Points;    ///< corners of all facets, by BeamFrame::toPlane()
  std::vector<double> Lanes;   ///< fillLanes(): rows of one value for each surface
  std::vector<double> Facing;  ///< findFacing() of the surface on which paths start
  std::vector<double> Heights; ///< heights of corners above the plane of a mirror, m
  std::vector<Box> Mirrored;   ///< boxes of the mirrored facets of a surface
  std::vector<Region> Regions;

  // The current beam.
  std::uint64_t Beam = 0;
  BeamFrame Frame;
  const VisiblePolygons* Seen = nullptr;
  double ShareOfArea = 0.0;
  std::uint32_t Sample = 0; ///< number of the next sample on `Start`; 2k and 2k + 1 are a stratum
  std::uint64_t Pair = 0;   ///< pair of surfaces between which paths were placed last
  std::uint64_t Drawn = 0;  ///< number of samples drawn for this pair
  std::uint32_t Start = 0;  ///< surface on which paths start
};
}

#endif
