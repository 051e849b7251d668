// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamCells.h
 * @brief Samples of a beam that many triangles enter, from a grid of cells and rays.
 *
 * 1. The disc is divided into 4 x 4 cells. Each cell is divided into 4 x 4 smaller cells, its
 * children. The surfaces in the list of a cell are tested against the sixteen children at once
 * (CellLanes.h). A child keeps a surface unless a side of the surface separates surface and child,
 * or a nearer surface covers the child.
 * 2. A cell that one surface covers, with all ranges in one strip (RangeStrips.h), is one exact
 * sample.
 * 3. Every other cell of the last level holds m x m blocks of 16 jittered rays (CellDensity), one
 * ray in each square of a grid. These rays are tested only against the list of the cell.
 *
 * The density of rays follows from the number N of rays per beam (densityOfCells()) and never from
 * hits, so missed surfaces cause no bias. A cell has more rays, or is divided further, if it holds
 * a small object, on which fewer than CellDensity::raysOnObject() rays would fall. A cell that may
 * hold the middle of a specular lobe is also divided further.
 *
 * With more than MostTrianglesOfCells triangles there are no lists (place()). The boxes of the
 * triangles of small objects then mark the squares that need more rays. An object that returns far
 * less than the lower limit has proportionally fewer rays, so its error remains a small part of
 * the limit. If small objects cover ShareOfCrowd of the beam, the whole grid is finer.
 *
 * Source: Warnock, "A Hidden Surface Algorithm for Computer Generated Halftone Pictures", 1969, for
 * the division; Catmull, 1978, for lists that become shorter in smaller cells.
 * Differs: the smallest cells are not pixels. These cells hold stratified rays, whose sums have a
 * standard error.
 * Valid: any triangles. Samples depend only on the beam, and on the triangles that enter its disc
 * and their object ids. Without lists, samples also depend on materials, pulse energy, lower limit
 * and aperture (crowdKey()). Samples do not depend on the order of the triangles or the tree.
 * Specular lobes are resolved up to exponents of about 1e8 at a half-beamwidth of 5.6 mrad.
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
#include <vector>

namespace avianlidar
{
/// Largest number of triangles in a beam whose cells have lists of surfaces. With more triangles,
/// the cells have no lists, and each ray descends the collision tree.
constexpr std::size_t MostTrianglesOfCells = 2000;

/// Smallest share of the disc that the triangles of an object must cover for the object to have at
/// least CellDensity::raysOnObject() rays.
constexpr double LeastShareOfObject = 1e-6;

/// Finds the samples of one beam after the other. Each thread needs its own object. Setup and scene
/// must outlive the object.
class BeamCells
{
public:
  BeamCells(const ScanSetup& setup, const SceneTriangles& scene);

  /// @param entering the surfaces that enter the disc, nearest first (BeamTriangles::sort())
  /// @return the samples; null if there are too many strips
  std::unique_ptr<CellSamples> find(
    std::uint64_t beam, const BeamFrame& frame, const std::vector<const BeamSurface*>& entering);

  /// Place the rays of a beam with too many triangles for lists. The cells of the beam are divided
  /// as small objects require. The caller must then find the triangle of each ray by descents of
  /// the collision tree.
  /// @param numbers all triangles that enter the beam, often millions, in any order
  /// @return the rays, valid until the next beam
  const BeamRays& place(
    std::uint64_t beam, const BeamFrame& frame, const std::vector<std::uint32_t>& numbers);

  /// The samples of the rays of place(); null if there are too many strips. @param triangles
  /// nearest triangle of each ray, or NoTriangle
  std::unique_ptr<CellSamples> find(const std::uint32_t* triangles);

private:
  struct Cell
  {
    int level;
    std::uint32_t column, row; ///< column and row of the cell, below 4^level
    float occluder;            ///< least CellSurface::inverse of the covering surface; 0: uncovered
    double x, y, width;        ///< corner and side of the cell, half-beamwidths
    double area;               ///< area of the cell's part in the beam, half-beamwidths squared
  };
  struct List
  {
    const std::uint32_t* surfaces; ///< numbers of surfaces
    std::uint32_t count;
  };
  struct Level
  {
    std::vector<std::uint32_t> numbers;
    CellChildren children;
  };
  /// Sums over the triangles of an object, in units of 2^-40 half-beamwidths squared.
  struct ObjectSums
  {
    int id;
    std::uint64_t area;  ///< area in the disc
    std::uint64_t heard; ///< area, times the energy returned by a share of 1 over the lower limit
  };
  /// A triangle of an object that may be small, and the box around it.
  struct Part
  {
    std::uint32_t triangle;
    int id;
    float low[2], high[2]; ///< least and largest x and y, half-beamwidths
  };
  void begin(std::uint64_t beam, const BeamFrame& frame);
  void setSurfaces();
  double areaInDiscOf(const Corners& corners) const;
  bool isLarge(int id) const;
  void addToObject(int id, double area, double heard);
  void addToObject(const BeamSurface& s);
  void addPart(std::uint32_t triangle);
  void sumObjects();
  float smallShareOf(int id) const;
  double heardOf(std::uint32_t triangle, const Corners& corners, double area, double nearest);
  bool mark(const Part& part, float share);
  const std::vector<std::uint32_t>& markAll();
  double areaOf(double x, double y, double width) const;
  double areaOf(int level, std::uint32_t column, std::uint32_t row) const;
  void divideAll(bool plans);
  void divide(const Cell& cell, List list);
  void solve(const Cell& cell, List list);
  int blocksFor(double width, float share) const;
  float smallestIn(const Cell& cell, List list) const;
  bool mayHoldFoot(const Cell& cell, List list) const;
  void trace(const Cell& cell, List list, int blocks);
  void place(const Cell& cell, int block, int blocks, float pull, CellRays& rays) const;
  void plan(const CellRays& block, double share);
  void planSquares(const Cell& cell, List list, int blocks);

  const ScanSetup& Setup;
  const SceneTriangles& Scene;
  const CellDensity Density;
  const BeamShape Shape;
  /// Area of each cell's part in the beam, for cells of two levels, half-beamwidths squared.
  std::vector<double> Areas;
  std::vector<float> Jitter; ///< places of rays in a block, in units of their spacing

  // The current beam.
  std::uint64_t Beam = 0;
  BeamFrame Frame;
  const std::vector<const BeamSurface*>* All = nullptr;
  double Tangent2 = 0.0;
  double ShareOfArea = 0.0;
  double LeastShare = LeastShareOfObject; ///< least share of the disc that a small object covers
  bool HasObjects = false;                ///< whether small objects enter the disc
  bool HasFeet = false;                   ///< whether middles of specular lobes may be in the disc
  std::vector<CellSurface> Surfaces;      ///< surfaces of `All` in single precision
  std::vector<ObjectSums> Objects; ///< small objects, in the order of their ids after sumObjects()
  std::vector<int> Large;          ///< ids of objects that are large for certain
  std::vector<Level> Levels;
  std::vector<std::uint64_t> MetIn; ///< by surface: last traced cell in which a ray met the surface
  std::uint64_t Traced = 0;         ///< number of cells traced so far, in all beams
  bool TooMany = false;             ///< whether there are too many strips or blocks of rays
  RangeStrips Strips;
  /// Numbers of all surfaces, of triangles that need lists, or of triangles that are hit.
  std::vector<std::uint32_t> Whole;

  // A beam with more than MostTrianglesOfCells triangles.
  bool Plans = false; ///< whether rays are only placed, not tested
  BeamTriangles Seen;
  BeamRays Rays;          ///< rays that lie in the beam
  bool IsCrowded = false; ///< whether the beam has more than MostTrianglesOfCells triangles
  double MostHeard = 1.0; ///< factor of rays of objects that are heard surely
  int LeastBlocks = 1;    ///< m of the coarsest cells
  Vec3 AcrossX{ 0.0 }, AcrossY{ 0.0 }; ///< scaled axes: AcrossX v = x z (BeamFrame::toPlane())
  Material OfReturn;                   ///< material of `Return`
  Reflectance Return{ 0.0, 0.0 };      ///< bound of what the material returns at any angle
  std::vector<Part> Parts;
  /// For each square, a sixteenth of a cell of the last usual level: least share of the small
  /// objects that may enter the square; infinity: none.
  std::vector<float> Marks;
  std::vector<CellRays> Blocks;
  std::size_t MostBlocks = 0;
  std::vector<double> Shares;         ///< share of the pulse for each ray, by block of rays
  std::vector<std::uint64_t> Hits;    ///< keyAbove() of triangle and ray
  std::vector<std::uint64_t> Numbers; ///< keyAbove() of triangle and surface
  std::vector<std::int32_t> OfRays;   ///< surface that each ray sees; -1: none
};
}

#endif
