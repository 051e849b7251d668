// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RangeStrips.h
 * @brief Samples of a beam in cells: sums of what its rays meet, by strips of range and incidence.
 *
 * On a plane the range gives the angle of incidence. So rays are not samples by themselves: those
 * of a triangle within a strip of ranges, between two ranges where a pulse begins to enter a range
 * unit or to leave it, are one sample at their mean range. In between the unit's share of a pulse
 * is linear in the range. Strips are divided further by the angle of incidence, for specular lobes.
 *
 * Source: none.
 * Differs: each ray and two others of a square of four are the strata of the standard error. As
 * neighbours differ more than what lies within a stratum, the estimate is on the large side. What
 * no ray of a cell met is added by addVariance().
 * Valid: at most four million strips of a beam. The same bits for any width of lanes.
 * Test: TestBeamCells.cxx, TestCellErrors.cxx.
 */
#ifndef avianlidar_RangeStrips_h
#define avianlidar_RangeStrips_h

#include "BeamFrame.h"
#include "BeamSamples.h"
#include "BeamShape.h"
#include "BeamTriangles.h"
#include "CellLanes.h"
#include "RangeUnits.h"
#include "ScanSetup.h"
#include "VisiblePolygons.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace avianlidar
{
/// Strips are no longer than this part of the range.
constexpr double MostOfRange = 0.02;

/// Samples of a beam by cells.
struct CellSamples
{
  BeamSamples samples;
  std::vector<std::uint32_t> others; ///< the other half of each of its surfaces, or NoTriangle
  std::vector<double> variance;      ///< of the weight of each sample
  /// The same of what may move between neighbouring samples of one range unit, by incidence alone.
  std::vector<double> moves;
  std::vector<double> halves; ///< the same over the diagonal of a quadrilateral; empty: none
  /// The surfaces seen, with hidden parts, for paths over two reflections; null if none are wanted.
  std::unique_ptr<VisiblePolygons> surfaces;
  bool isCrowded = false; ///< its rays went through the tree (MostTrianglesOfCells)

  std::size_t bytes() const
  {
    return sizeof(CellSamples) + this->samples.bytes() +
      (this->surfaces ? this->surfaces->bytes() : 0) +
      this->others.capacity() * sizeof(std::uint32_t) +
      (this->variance.capacity() + this->moves.capacity() + this->halves.capacity()) *
      sizeof(double);
  }

  /// Standard error, J, of the energy in some range units. @param shares of which those of the
  /// samples come first
  double errorOf(const RangeShares& shares, const ScanSetup& setup) const;
};

/// The strips of a surface. Numbers are doubles for the sake of lanes.
struct SurfaceStrips
{
  double number; ///< of the surface
  PlaneLine inverse, diagonal;
  double height;         ///< distance of the plane from the apex, m
  double gate, perMetre; ///< m; parts of range units
  double one, two;       ///< offsets of the borders of units, in parts of them
  double least;          ///< number of the first strip
  double first;          ///< its key
  double count;          ///< of strips, of each half
};

/// Sums the rays of one beam after the other. One per thread; the setup must outlive it.
class RangeStrips
{
public:
  explicit RangeStrips(const ScanSetup& setup);

  /// @param surfaces that rays may meet; they must live until collect()
  void begin(const BeamFrame& frame, const std::vector<const BeamSurface*>& surfaces);

  /// Add a square inside the disc that one surface covers. @param share of the pulse
  /// @return false if it takes more than one sample
  bool addWhole(std::uint32_t surface, const PlanePoint& middle, double width, double share);

  /// Add sixteen rays. @param share of the pulse of each @return false if there are too many strips
  bool add(const CellRays& rays, double share);

  /// Add to the variance where a ray met a surface, which add() took.
  void addVariance(std::uint32_t surface, const PlanePoint& at, double variance);

  std::unique_ptr<CellSamples> collect();

private:
  struct Strip
  {
    double weight, moment, variance, moves;
    std::uint32_t key;
    std::uint64_t columns;
  };
  const SurfaceStrips* stripsOf(std::uint32_t surface);
  Strip& sumOf(double number);
  double secant2At(const PlanePoint& p) const;
  void addHalves(std::size_t strip, double variance);

  const ScanSetup& Setup;
  const double UnitLength; ///< m
  const double Gate;       ///< m: nothing beyond is received
  const double Offset; ///< from a border of a unit to where a pulse begins to enter it, in units
  const BeamShape Shape;
  double Tangent2 = 0.0;
  double Flatness2 = 1.0; ///< BeamFrame::flatness2
  const bool HasColumns;  ///< samples get columns
  bool Uneven = false;    ///< rays of a cell have unlike weights
  const std::vector<const BeamSurface*>* All = nullptr;
  std::vector<std::uint32_t> Of;      ///< place of each surface in Visible
  std::vector<SurfaceStrips> Visible; ///< in the order of their keys
  double Used = 0.0;                  ///< strips of all surfaces so far
  std::vector<Strip> Sums;            ///< strips that hold something
  std::vector<double> Halves;         ///< see CellSamples, of the first of these; mostly empty
  std::vector<std::uint32_t> Places;  ///< in Sums, of each key that stands there
  std::vector<std::uint64_t> Keys;    ///< of strips, in order
};
}

#endif
