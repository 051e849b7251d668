// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file AirLight.h
 * @brief The light that the air along one beam returns in each range unit, from the part of the
 * pulse that no nearer surface has met.
 *
 * ScanAir.h gives the energy that a medium returns. Each surface takes its share of the pulse from
 * the columns (BeamAir.h) that it meets. A tree that is half hidden by a wall returns half of its
 * light.
 *
 * Source: see ScanAir.h and BeamAir.h.
 * Differs: see ScanAir.h and BeamAir.h.
 * Valid: along each column the relative error of a unit's energy is at most 2e-6, and at most 1e-3
 * in unit 0. With leaves, the relative error is at most 1e-2 up to an optical depth of 4 one way.
 * The sum of all shares that surfaces take is exact, unit by unit.
 * Test: TestAir.cxx, TestBeamAir.cxx.
 */
#ifndef avianlidar_AirLight_h
#define avianlidar_AirLight_h

#include "BeamAir.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// The leaf at which a ray of the beam ends.
struct MetLeaf
{
  std::uint32_t medium; ///< number of the medium for BeamAir::mediumAt()
  double range;         ///< range of the leaf, m
  double cosine;        ///< cosine of incidence, in [0, 1]
};

/// Follows the light of the air outward along a beam. An object is reused without allocation. Each
/// thread needs its own object.
class AirLight
{
public:
  /// The ScanAir must outlive the object.
  explicit AirLight(const ScanAir& scan)
    : Scan(scan)
  {
  }

  /// Begin a beam. @param air, surfaces air of the beam, and result of BeamAir::arrange(); both
  /// must outlive the use of the object
  void begin(const BeamAir& air, const std::vector<MetSurface>& surfaces);
  /// Forget the beam, and keep the memory.
  void end()
  {
    this->Air = nullptr;
    this->Surfaces = nullptr;
  }

  /// Light that one medium returns in a unit.
  struct Share
  {
    std::uint32_t medium; ///< number of the medium for BeamAir::mediumAt()
    double mean;          ///< mean energy, J
    double drops;         ///< mean number of drops
  };
  /// Shares of the media in a unit, in an order that does not depend on earlier calls. Units in
  /// ascending order are fastest.
  const std::vector<Share>& sharesOf(std::int64_t unit);

  /// Mean energy, J, that a unit receives from all media that a threshold may follow.
  double followed(std::int64_t unit);

  /// First unit, from `unit` on, in which the air may be perceived without light from surfaces. The
  /// largest integer means that no such unit follows. @param everywhere number of units, from unit
  /// 0 on, in which media that fill the scene may be perceived
  std::int64_t nextLooked(std::int64_t unit, std::int64_t everywhere) const;

  /// Energy, J, that a leaf returns from a share of the pulse, if no leaf stops this light on the
  /// way back. Surfaces nearer than the middle of the unit last given to sharesOf() have taken
  /// their shares. @param column column of BeamAir::columns() in which the leaf lies
  double returnedBy(const MetLeaf& leaf, const AirColumn& column, double share) const;

private:
  void takeUpTo(double range);
  void takeOne(const MetSurface& surface);
  double openOf(const AirColumn& column) const { return this->Open[this->Air->numberOf(column)]; }
  void addColumn(const AirColumn& column, double from, double to);
  void addPiece(const AirColumn& column, double before, double from, double to);

  const ScanAir& Scan;
  const BeamAir* Air = nullptr;
  const std::vector<MetSurface>* Surfaces = nullptr;
  std::vector<double> Open; ///< share of each column's light that no surface has met so far
  std::int64_t Dark = 0;    ///< unit from which on volumes return no light that matters
  double MostOfUnit = 0.0;  ///< bound of a unit's energy from media, J per sr of collected()
  std::size_t Taken = 0;    ///< number of surfaces that have taken their shares
  double TakenTo = 0.0;     ///< range before which surfaces have taken their shares, m
  double Left = 1.0;        ///< share of the pulse that no surface has met so far
  std::int64_t Unit = -1;   ///< unit to which `Shares` belong
  std::vector<Share> Shares;
  std::vector<double> Breaks;      ///< borders of parts in a unit, m
  std::vector<BeamAir::Part> Here; ///< parts of a column between two `Breaks`
  std::vector<Share> Sums;         ///< shares of a unit, in the order of BeamAir::mediumMet()
  std::array<double, 3> Known{};   ///< ends, m, and decay, 1/m, of the last piece of one density
  double OfKnown = 0.0;            ///< integral of `Known`'s piece without extinction, m sr
};
}

#endif
