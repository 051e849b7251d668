// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamCells.h
 * @brief Direct echoes of a beam that many triangles enter: the beam's disc is divided into cells,
 * each with a list of the triangles that may be seen in it, and a dense grid of jittered rays is
 * tested against the lists of its cells alone.
 *
 * A cell is divided into 4 x 4 smaller ones. Its triangles are tested against all sixteen at once:
 * a triangle is kept where none of its sides separates it from the cell and no other covers the
 * cell in front of it. The cells of the smallest size hold 16 m^2 rays, one in each square of a
 * grid; in a cell that one triangle covers nothing is left to test.
 *
 * The density of rays is fixed: 32 for each of the beam's N rays (densityOfCells()). So nothing is
 * biased by what the first rays missed. A cell that holds an object on which fewer than
 * RaysOnObject rays would fall gets more, or is divided further.
 *
 * On a plane the range gives the angle of incidence. So rays are not samples by themselves: those
 * of a triangle within a strip of ranges, between two ranges where a pulse begins to enter a range
 * unit or to leave it, are one sample at their mean range. In between the unit's share of a pulse
 * is linear in the range. Strips are divided further by the angle of incidence, for specular lobes.
 *
 * Source: Warnock, "A Hidden Surface Algorithm for Computer Generated Halftone Pictures", 1969, for
 * the division; Catmull, 1978, for lists that are shorter the smaller the cell.
 * Differs: cells end in stratified rays, which have a standard error, and not in pixels.
 * Valid: any triangles. Depends on the beam, the triangles that enter its disc, and which of them
 * are one object; not on their order, their materials or the tree. Not for specular lobes that
 * change much within a strip (isSharp()).
 * Test: TestBeamCells.cxx.
 */
#ifndef avianlidar_BeamCells_h
#define avianlidar_BeamCells_h

#include "BeamFrame.h"
#include "BeamRays.h"
#include "BeamSamples.h"
#include "RangeUnits.h"
#include "ScanSetup.h"
#include "VisiblePolygons.h"

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace avianlidar
{
/// Most triangles of a beam that is divided into cells; beyond, its rays go through the tree.
constexpr std::size_t MostTrianglesOfCells = 4000;

/// Rays that are to fall on a small object, and the smallest share of the beam's disc that an
/// object is looked for with, by the area of its triangles.
constexpr double RaysOnObject = 128.0;
constexpr double LeastShareOfObject = 1e-6;

/// Samples of a beam by cells.
struct CellSamples
{
  BeamSamples samples;
  std::vector<double> variance; ///< of the weight of each sample

  std::size_t bytes() const
  {
    return sizeof(CellSamples) + this->samples.bytes() + this->variance.capacity() * sizeof(double);
  }

  /// Standard error, J, of the energy in some range units. @param shares of which those of the
  /// samples come first
  double errorOf(const RangeShares& shares) const;
};

/// True if beams that many triangles enter are divided into cells.
bool usesCells(const EchoSettings& settings);

/// Levels of division, and m: a cell of the last level holds 16 m^2 rays.
struct CellDensity
{
  int levels;
  int blocks; ///< m
};
CellDensity densityOfCells(int raysPerBeam);

struct RayBlock;

/// Finds the samples of one beam after the other. One per thread; the setup must outlive it.
class BeamCells
{
public:
  explicit BeamCells(const ScanSetup& setup);

  /// @param candidates that may be seen in the disc, nearest first (PolygonFinder::candidates())
  /// @return null if there are too many triangles, or too many strips
  std::unique_ptr<CellSamples> find(
    std::uint64_t beam, const BeamFrame& frame, const std::vector<PolygonCandidate>& candidates);

  /// The triangles that rays of the beam found last see, NoTriangle where they see none: of those
  /// that cells show. @return true if any ray sees one
  bool meet(const BeamRays& rays, std::vector<std::uint32_t>& triangles);

  /// True if a specular lobe changes too much within the strips of the samples for one sample to
  /// stand for a strip.
  bool isSharp(const CellSamples& cells) const;

private:
  struct Cell
  {
    double x, y, width; ///< corner and side, in half-beamwidths
    double occluder;    ///< 1/z, 1/m, of the nearest surface that covers it; nothing behind matters
    int level;
  };
  struct Level
  {
    std::vector<std::uint32_t> lists[16];
    double occluders[16];
  };
  struct Strip
  {
    double weight, moment, variance;
    std::uint32_t beam; ///< number of the beam that it was begun for
  };
  /// Where the strips of a candidate lie.
  struct Strips
  {
    std::uint32_t first = 0;
    std::uint32_t count = 0; ///< of each half
    bool halves = false;     ///< it is a quadrilateral
    double least = 0.0;      ///< number of the first
    double perMetre = 0.0;   ///< parts of range units
    double offsets[2] = {};  ///< of the borders of units, in parts of them
    double height = 0.0;     ///< of the plane, m
  };
  void divide(const Cell& cell, const std::vector<std::uint32_t>& list);
  void trace(const Cell& cell, const std::vector<std::uint32_t>& list, int blocks);
  int blocksFor(const Cell& cell, const std::vector<std::uint32_t>& list) const;
  bool place(std::uint32_t candidate);
  void add(RayBlock& rays, double share);
  void findObjects();
  std::unique_ptr<CellSamples> collect();

  const ScanSetup& Setup;
  const CellDensity Density;
  const double UnitLength; ///< m
  const double Gate;       ///< m: nothing beyond is received
  const double Offset; ///< from a border of a unit to where a pulse begins to enter it, in units
  std::vector<double> Jitter;

  // The beam.
  std::uint64_t Beam = 0;
  const std::vector<PolygonCandidate>* All = nullptr;
  double Tangent2 = 0.0;
  double ShareOfArea = 0.0;
  std::vector<double> ShareOfObject; ///< of each candidate; 0: it is of no small object
  std::vector<std::pair<int, std::uint32_t>> Objects; ///< id, candidate
  std::vector<Level> Levels;
  std::vector<Strips> Of; ///< each candidate's
  std::vector<Strip> Sums;
  std::uint32_t Number = 0;
  std::uint32_t Used = 0; ///< strips of all candidates so far
  bool TooMany = false;
  std::vector<std::uint32_t> Touched;
  std::vector<std::uint32_t> Visible; ///< candidates that a ray met, in the order of their strips
};
}

#endif
