// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RangeStrips.h
 * @brief Samples of a beam in cells: sums over rays, by strips of range and angle of incidence.
 *
 * On a plane the range gives the angle of incidence. The rays of a triangle within a strip of
 * ranges are therefore one sample, at the mean range of these rays. A strip lies between two ranges
 * at which a pulse begins to enter or to leave a range unit. Between these ranges the unit's share
 * of the pulse is linear in the range. Strips are divided further by the angle of incidence, for
 * specular lobes.
 *
 * Source: none.
 * Differs: in the standard error, a stratum consists of a ray and one of the ray's two neighbours
 * in a square of four rays. Neighbours differ more than two rays in one square of the grid would,
 * so the estimate tends to be too large. addVariance() accounts for surfaces that no ray of a cell
 * met.
 * Valid: at most four million strips per beam. SIMD lanes of any width give the same bits.
 * Test: TestBeamCells.cxx, TestCellErrors.cxx.
 */
#ifndef avianlidar_RangeStrips_h
#define avianlidar_RangeStrips_h

#include "BeamFrame.h"
#include "BeamSamples.h"
#include "BeamShape.h"
#include "BeamTriangles.h"
#include "CellLanes.h"
#include "ScanSetup.h"
#include "VisiblePolygons.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace avianlidar
{
/// Largest length of a strip, divided by the range of the strip.
constexpr double MostOfRange = 0.02;

/// Samples of a beam by cells.
struct CellSamples
{
  BeamSamples samples;
  std::vector<std::uint32_t> others; ///< PlaneSurface::other of each surface of `samples`
  std::vector<double> variance;      ///< variance of the weight of each sample
  /// Variance, by sample, of the weight that may move to a neighbouring sample of the same unit.
  std::vector<double> moves;
  std::vector<double> halves; ///< part of `moves` across diagonals of quadrilaterals; empty: zero
  /// The surfaces that the beam sees, including their hidden parts. Null if nothing is seen.
  std::unique_ptr<VisiblePolygons> surfaces;
  bool isCrowded = false; ///< whether more than MostTrianglesOfCells triangles enter

  std::size_t bytes() const
  {
    return sizeof(CellSamples) + this->samples.bytes() +
      (this->surfaces ? this->surfaces->bytes() : 0) +
      this->others.capacity() * sizeof(std::uint32_t) +
      (this->variance.capacity() + this->moves.capacity() + this->halves.capacity()) *
      sizeof(double);
  }
};

/// The strips of a surface. Range units are divided into equal parts, so that strips are short
/// (MostOfRange). Integers are stored as doubles, for SIMD lanes.
struct SurfaceStrips
{
  double number; ///< number of the surface
  PlaneLine inverse, diagonal;
  double height;         ///< distance of the plane from the apex, m
  double gate, perMetre; ///< largest range, m; number of parts of range units per metre
  double one, two;       ///< offsets of the two kinds of borders, parts of range units
  double least;          ///< number of the first strip
  double first;          ///< key of the first strip
  double count;          ///< number of strips of each half
};

/// Number of parts of a range unit, each with strips of its own.
double partsOfStrips(const ScanSetup& setup);

/// Sums the rays of one beam after the other. Each thread needs its own object. The setup must
/// outlive the object.
class RangeStrips
{
public:
  explicit RangeStrips(const ScanSetup& setup);

  /// @param surfaces surfaces that rays may meet, which the caller must keep until collect()
  void begin(const BeamFrame& frame, const std::vector<const BeamSurface*>& surfaces);

  /// Add a square that lies inside the disc and that one surface covers. @param share share of the
  /// pulse
  /// @return false if the square needs more than one sample
  bool addWhole(std::uint32_t surface, const PlanePoint& middle, double width, double share);

  /// Add sixteen rays. @param share share of the pulse of each ray
  /// @return false if there are too many strips
  bool add(const CellRays& rays, double share);

  /// Add `variance` to the strip of a ray that was passed to add(). @param at point where the ray
  /// met the surface
  void addVariance(std::uint32_t surface, const PlanePoint& at, double variance);

  std::unique_ptr<CellSamples> collect();

private:
  struct Strip
  {
    double weight, moment, variance, moves;
    std::uint32_t key;
    SamplePlace place;
  };
  const SurfaceStrips* stripsOf(std::uint32_t surface);
  Strip& sumOf(double number);
  double secant2At(const PlanePoint& p) const;
  void addHalves(std::size_t strip, double variance);

  const ScanSetup& Setup;
  const double UnitLength; ///< length of a range unit, or of a part of it (partsOfStrips()), m
  const double Gate;       ///< range beyond which nothing is received, m
  const double Offset;     ///< half the length of the pulse, range units
  const BeamShape Shape;
  double Tangent2 = 0.0;
  double Flatness2 = 1.0; ///< flatness2 of the current beam's BeamFrame
  const bool HasPlaces;   ///< whether samples have places (BeamSamples::places)
  bool Uneven = false;    ///< whether weights of the rays of a cell differ
  const std::vector<const BeamSurface*>* All = nullptr;
  std::vector<std::uint32_t> Of;      ///< place of each surface in `Visible`, or None
  std::vector<SurfaceStrips> Visible; ///< visible surfaces, in the order of their keys
  double Used = 0.0;                  ///< number of strips of all surfaces so far
  std::vector<Strip> Sums;            ///< strips with rays
  std::vector<double> Halves;         ///< CellSamples::halves of the first entries of `Sums`
  std::vector<std::uint32_t> Places;  ///< by key: place in `Sums`, if the strip there has the key
  std::vector<std::uint64_t> Keys;    ///< keys of the strips with rays, sorted
};
}

#endif
