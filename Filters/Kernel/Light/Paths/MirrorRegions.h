// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MirrorRegions.h
 * @brief Mirror paths of a beam whose visible surfaces are known. Samples lie only in parts of the
 * beam whose light goes from one surface to another surface.
 *
 * In the mirror image of the scene behind a plane mirror, a mirror path continues as a straight
 * line. The point on the second surface is therefore a projective function of the ray. Rays to a
 * side of the second surface lie on a straight line of the beam's plane. The rays from one surface
 * to another surface fill a convex polygon of the plane, called a region, cut from the polygon of
 * the first surface. Samples lie in strata of equal area. The density of the samples is twice the
 * density of the rays in the disc. If a surface has at most 32 regions, each region has at least
 * two samples. More than 32 regions together have at least 64 samples.
 *
 * In an integrated beam all polygons are visible (VisiblePolygons.h), so both ends of a path are
 * visible. In a beam in cells the surfaces are whole triangles. Rays from the apex then test
 * whether both ends are visible. A ray that descends the collision tree tests whether a surface
 * blocks the segment between the ends (SecondaryTracer.h).
 *
 * Source: paper, Sec. 3.4, the beam constraint; Heckbert and Hanrahan, "Beam Tracing Polygonal
 * Objects", SIGGRAPH 1984, for the mirror image.
 * Differs: the paper follows the rays of the beam.
 * Valid: plane surfaces. Regions depend only on the beam and the visible surfaces, not on materials
 * or limits. In a beam in cells, paths start and end only on surfaces that rays of the cells meet.
 * Test: TestMirrorRegions.cxx, TestPolygonPaths.cxx.
 */
#ifndef avianlidar_MirrorRegions_h
#define avianlidar_MirrorRegions_h

#include "AABB.h"
#include "BeamSamples.h"
#include "BeamShape.h"
#include "ScanSetup.h"
#include "SecondaryTrace.h"
#include "VisiblePolygons.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Finds the mirror paths of one beam after the other, without allocation for each beam. Each
/// thread needs its own object.
class MirrorRegions
{
public:
  MirrorRegions(const ScanSetup& setup, const SceneTriangles& scene);

  /// Begin a beam. @param cells samples of a beam in cells, whose polygons have hidden parts; null
  /// for other beams
  void begin(std::uint64_t beam, const BeamFrame& frame, const VisiblePolygons& seen,
    const BeamSamples* cells);

  std::size_t surfaces() const { return this->Surfaces.size(); }

  /// Upper bound of the sum of the throughputs of the mirror paths that start on a surface.
  /// @param returned mirrorReturnBound()
  double bound(std::size_t surface, double returned) const;

  /// Append the paths that start on a surface. @return number of samples drawn for these paths
  std::size_t search(std::size_t surface, std::vector<MirrorPath>& paths);

  /// Append starts of mirror paths, spread over a whole surface, wherever the paths end
  /// (traceBeyond()). @return number of starts
  std::size_t spread(std::size_t surface, std::vector<MirrorPath>& starts);

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
    Vec3 normal;              ///< unit normal, towards the apex
    Vec3 mirror;              ///< `normal` by BeamFrame::toPlane()
    double height;            ///< distance of the plane from the apex, m
    PlaneLine along;          ///< scalar product of `normal` and the direction of a ray
    PlaneLine inverse;        ///< 1/z on the plane, 1/m
    std::uint32_t first, end; ///< numbers of the facets, [first, end)
    AABB corners;             ///< box of the facets' corners, by BeamFrame::toPlane()
    Box box;
    double share; ///< share of the pulse that arrives; for polygons an upper bound
  };
  /// A convex polygon of a surface.
  struct Facet
  {
    PlaneRing ring;
    Box box;
    std::uint32_t surface;
  };
  /// Point (x, y)/z at which a ray reflected by one surface meets another surface, as functions of
  /// the ray.
  struct Image
  {
    PlaneLine w; ///< 1/z of the second plane, mirrored on the first plane
    PlaneLine x, y, z;
  };
  /// Rays that go from one facet to another facet, or anywhere.
  struct Region
  {
    std::uint32_t one, two; ///< numbers of the facets; `two` may be Anywhere
    PlaneRing ring;
    double area;
  };
  void addFacets();
  void fillLanes();
  void setSurface(Surface& surface) const;
  void findNear(const Surface& one);
  bool imageOf(const Surface& one, const Surface& two, Image& image) const;
  void findRegions(
    const Surface& one, const Surface& two, const std::uint32_t* begin, const std::uint32_t* end);
  bool cutOut(const Facet& one, const Facet& two, const Image& image, PlaneRing& ring) const;
  void placeIn(std::size_t first, std::size_t end, std::vector<MirrorPath>& paths);
  void findStart(const Facet& facet, const PlanePoint& p, MirrorPath& path) const;
  bool findEnd(const Facet& facet, MirrorPath& path) const;
  void begin(std::size_t surface);

  const ScanSetup& Setup;
  const SceneTriangles& Scene;
  const BeamShape Shape;
  std::vector<Surface> Surfaces;
  std::vector<Facet> Facets;         ///< sorted by surface
  std::vector<AABB> Boxes;           ///< boxes of the facets' corners
  std::vector<std::uint64_t> Order;  ///< keys of facets along a curve through space, sorted
  std::vector<double> Lanes;         ///< rows, set by fillLanes(), of one value per facet
  std::vector<double> Blocks;        ///< rows, set by fillLanes(), of boxes around facets
  std::vector<std::uint32_t> Facing; ///< by block: result of findFacing() for `Start`
  std::vector<std::uint32_t> Near;   ///< facets to which `Start` may reflect rays
  std::vector<Box> Mirrored;         ///< boxes of the mirrored facets of a surface
  std::vector<Region> Regions;

  // The current beam.
  std::uint64_t Beam = 0;
  BeamFrame Frame;
  const VisiblePolygons* Seen = nullptr;
  double ShareOfArea = 0.0;
  std::uint32_t Sample = 0; ///< number of the next sample; samples 2k and 2k + 1 form a stratum
  std::uint64_t Pair = 0;   ///< pair of surfaces between which paths were placed last
  std::uint64_t Drawn = 0;  ///< number of samples drawn for `Pair`
  std::uint32_t Start = 0;  ///< surface on which paths start
};
}

#endif
