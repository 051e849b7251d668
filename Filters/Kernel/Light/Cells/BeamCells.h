// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamCells.h
 * @brief Direct echoes of a beam that many triangles enter: the beam's disc is divided into cells,
 * each with a list of the triangles that may be seen in it, and a dense grid of jittered rays is
 * tested against the lists of its cells alone.
 *
 * A cell is divided into 4 x 4 smaller ones. Its surfaces are tested against all sixteen at once
 * (CellLanes.h): a surface is kept where none of its sides separates it from the cell and nothing
 * that covers the cell lies in front of it. A cell that one surface covers within one strip
 * (RangeStrips.h) is one exact sample. The others of the smallest size hold 16 m^2 rays, one in
 * each square of a grid.
 *
 * The density of rays is fixed by N (densityOfCells()). So nothing is biased by what the first rays
 * missed. A cell gets more rays, or is divided further, if it holds an object on which fewer than
 * CellDensity::raysOnObject() would fall. So is a cell that may hold the middle of a specular lobe,
 * where light comes back from a mirror.
 *
 * Source: Warnock, "A Hidden Surface Algorithm for Computer Generated Halftone Pictures", 1969, for
 * the division; Catmull, 1978, for lists that are shorter the smaller the cell.
 * Differs: cells end in stratified rays, which have a standard error, and not in pixels.
 * Valid: any triangles. Depends on the beam, the triangles that enter its disc, and which of them
 * are one object; not on their order, their materials or the tree. Specular lobes are resolved to
 * exponents of about 1e8 in a beam of 5.6 mrad.
 * Test: TestBeamCells.cxx, TestCellErrors.cxx, TestBird.cxx.
 */
#ifndef avianlidar_BeamCells_h
#define avianlidar_BeamCells_h

#include "BeamFrame.h"
#include "BeamRays.h"
#include "BeamShape.h"
#include "BeamTriangles.h"
#include "CellLanes.h"
#include "RangeStrips.h"
#include "ScanSetup.h"

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace avianlidar
{
/// Most triangles of a beam whose cells have lists of them; beyond, the rays go through the tree.
constexpr std::size_t MostTrianglesOfCells = 2000;

/// The smallest share of the beam's disc that an object is looked for with, by the area of its
/// triangles in the disc.
constexpr double LeastShareOfObject = 1e-6;

/// Finds the samples of one beam after the other. One per thread; setup and scene must outlive it.
class BeamCells
{
public:
  BeamCells(const ScanSetup& setup, const SceneTriangles& scene);

  /// @param entering the surfaces that enter the disc, nearest first (BeamTriangles::sort())
  /// @return null if there are too many strips
  std::unique_ptr<CellSamples> find(
    std::uint64_t beam, const BeamFrame& frame, const std::vector<const BeamSurface*>& entering);

  /// Of triangles, all that enter a beam among them, leave those of small objects: they alone
  /// decide where the rays of place() lie, and millions may enter.
  void leaveSmallObjects(
    std::uint64_t beam, const BeamFrame& frame, std::vector<std::uint32_t>& numbers);

  /// The rays of a beam that too many triangles enter for lists: those of its cells, which are
  /// divided as small objects ask for it. They have to be traced through the tree. @param numbers
  /// of triangles, those of all small objects among them, in any order; changed. Valid until the
  /// next beam.
  const BeamRays& place(
    std::uint64_t beam, const BeamFrame& frame, std::vector<std::uint32_t>& numbers);

  /// The samples of these rays. @param triangles that they hit
  std::unique_ptr<CellSamples> find(const std::uint32_t* triangles);

private:
  struct Cell
  {
    int level;
    std::uint32_t column, row; ///< of 4^level
    float occluder;            ///< 1/z of what covers it, scaled; 0: nothing does
    double x, y, width;        ///< corner and side, in half-beamwidths
    double area;               ///< of its part in the beam
  };
  struct List
  {
    const std::uint32_t* surfaces; ///< numbers
    std::uint32_t count;
  };
  struct Level
  {
    std::vector<std::uint32_t> numbers;
    CellChildren children;
  };
  void begin(std::uint64_t beam, const BeamFrame& frame);
  void planAll();
  void setSurfaces();
  double areaInDiscOf(std::uint32_t triangle) const;
  bool isLarge(int id) const;
  void addToObject(int id, double area);
  void addToObject(const BeamSurface& s);
  void addPart(std::uint32_t triangle);
  void sumObjects();
  float smallShareOf(int id) const;
  double areaOf(double x, double y, double width) const;
  double areaOf(int level, std::uint32_t column, std::uint32_t row) const;
  void divideAll(bool plans);
  void divide(const Cell& cell, List list);
  void solve(const Cell& cell, List list);
  int blocksFor(const Cell& cell, List list) const;
  bool mayHoldFoot(const Cell& cell, List list) const;
  void trace(const Cell& cell, List list, int blocks);
  void place(const Cell& cell, int block, int blocks, float pull, CellRays& rays) const;
  void plan(const CellRays& block, double share);

  const ScanSetup& Setup;
  const SceneTriangles& Scene;
  const CellDensity Density;
  const BeamShape Shape;
  std::vector<double> Areas; ///< of the cells of the first two levels
  std::vector<float> Jitter; ///< places of rays in a block, in their spacing

  // The beam.
  std::uint64_t Beam = 0;
  BeamFrame Frame;
  const std::vector<const BeamSurface*>* All = nullptr;
  double Tangent2 = 0.0;
  double ShareOfArea = 0.0;
  double LeastShare = LeastShareOfObject;             ///< of objects that count as small
  bool HasObjects = false;                            ///< small ones
  bool HasFeet = false;                               ///< middles of specular lobes in the disc
  std::vector<CellSurface> Surfaces;                  ///< as in All
  std::vector<std::pair<int, std::uint64_t>> Objects; ///< id and area of each, after sumObjects()
  std::vector<int> Large;                             ///< ids of objects that are not small
  std::vector<Level> Levels;
  std::vector<std::uint64_t> MetIn; ///< last traced cell, by surface
  std::uint64_t Traced = 0;         ///< cells, of all beams
  bool TooMany = false;             ///< strips, or blocks of rays
  RangeStrips Strips;
  std::vector<std::uint32_t> Whole; ///< all surfaces

  // A beam whose rays are traced through the tree.
  bool Plans = false; ///< rays are placed and not tested
  BeamTriangles Seen;
  BeamRays Rays; ///< those in the disc
  std::vector<CellRays> Blocks;
  std::size_t MostBlocks = 0;
  std::vector<double> Shares;         ///< of the pulse, of each ray of a block
  std::vector<std::uint64_t> Hits;    ///< triangle and ray
  std::vector<std::uint64_t> Numbers; ///< triangle and surface
  std::vector<std::int32_t> OfRays;   ///< surfaces
};
}

#endif
