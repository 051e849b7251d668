// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LeafGaps.h
 * @brief Single leaves in a narrow beam: the light that they return and the light that they
 * transmit.
 *
 * A beam is divided into rays, one through each cell of its grid (BeamAir.h). The light of a ray
 * returns to one point of the aperture. Leaves are discs of one size at random places (Poisson),
 * with all orientations equally likely. A ray ends at the first leaf that it meets. The way back
 * lies beside the way out. The light of the ray comes back unless another leaf stops this light on
 * the way back. So a leaf may stop one part of a beam and not the rest. A range unit receives the
 * light of the rays that end in this unit. Light from a range behind leaves is scaled by the share
 * of rays that no leaf stops on the way to this range and back, divided by the mean of this share.
 * Beams much wider than a leaf are not divided. The leaves in such beams follow the compound
 * Poisson law of Drops.h.
 *
 * Source: the Boolean model of leaves at random places (Nilson, Agricultural Meteorology 8, 1971).
 * Differs: the paper has no leaves.
 * Valid: leaves are projected along the beam's axis. A leaf exists for a ray if the medium in the
 * ray's column is dense enough. Mean energies are the same as in BeamAir.h.
 * Test: TestBeamCrowns.cxx.
 */
#ifndef avianlidar_LeafGaps_h
#define avianlidar_LeafGaps_h

#include "BeamAir.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
class LeafGaps
{
public:
  /// Begin a beam that has no leaves or is not divided.
  void clear() { this->Rays.clear(); }

  /// Begin a beam. `along` must not be destroyed before the next beam. @param along air of the beam
  /// @param solidAngle solid angle of the beam, sr
  void begin(BeamAir& along, double solidAngle, std::int32_t seed, std::uint64_t beam,
    std::int32_t revolution);

  bool any() const { return !this->Rays.empty(); }

  /// Transmission of the leaves to a range, m, and back, divided by the mean transmission.
  double openAt(double range) const;

  /// Energy, J, that the leaves of a medium return from ranges [from, to), m. Surfaces take their
  /// shares of the pulse as in BeamAir::returnedBy().
  double returnedBetween(double from, double to, std::uint32_t medium) const;

  /// Largest cross-section of a divided beam where its first leaves begin, in projected leaf areas.
  static constexpr double MostLeaves = 64.0;
  /// Largest cross-section of the beam where the leaves of a medium behind the first medium begin,
  /// in projected leaf areas. This number limits the number of leaves that are drawn.
  static constexpr double MostLeavesBehind = 4096.0;
  /// Largest area of a square about all ways out and back, in projected leaf areas. This number
  /// limits the aperture.
  static constexpr double MostLeavesAcross = 1000.0;

private:
  struct Ray
  {
    std::array<double, 2> slope;    ///< tangents across the beam
    std::array<double, 2> aperture; ///< point of the aperture to which the ray's light returns, m
    double share;                   ///< share of the pulse in the ray
    const BeamAir::Column* column;
    MetLeaf leaf; ///< leaf at which the ray ends, with an infinite range if there is no such leaf
    bool isSeen;  ///< true if no leaf stops the light that `leaf` returns
  };
  /// Ranges, m, from which a leaf stops the light of a ray on its way back.
  struct Shadow
  {
    std::size_t ray;
    double from, to;
  };
  /// Leaves of a medium, by range: either all leaves that are the same in every scan, or all leaves
  /// that are drawn anew in each scan.
  struct Stream
  {
    BeamAir::Leaves leaves;
    std::int32_t scan; ///< revolution, or a fixed number for leaves that are the same in every scan
    double perVolume;  ///< number of leaves per volume, 1/m^3
    double radius;     ///< radius of a leaf, m
    double rim;        ///< greatest distance from a ray at which a leaf matters, m
    std::uint64_t number; ///< number of the first draw of the next leaf
    double range;         ///< range of the next leaf, m
  };
  void makeStreams(double growth, double solidAngle, std::int32_t revolution);
  void makeRays(double turn, double shift);
  template <class F>
  void place(const std::array<double, 2>& centre, const Stream& of, F draw);
  std::uint64_t shadedAt(double range) const;

  std::vector<Ray> Rays;
  std::vector<std::size_t> Going; ///< rays that no leaf has stopped so far
  std::vector<Shadow> Shadows;
  std::vector<BeamAir::Leaves> Leaves;
  std::vector<Stream> Streams;
  BeamAir* Along = nullptr;
};
}

#endif
