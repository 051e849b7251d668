// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LeafGaps.h
 * @brief Leaves that stop a narrow beam one by one: what they return, and what is seen behind them.
 *
 * A beam is divided into rays, one through each cell of its grid (BeamAir.h), whose light returns
 * to one point of the aperture each. Leaves are discs of one size that face all ways alike, at
 * random places (Poisson). A ray ends at the first leaf that it meets. Its light comes back unless
 * another leaf stops it on its way back, which lies beside its way there. So a part of a beam may
 * meet a leaf while the rest passes it. A range unit receives the light of the rays that end in it.
 * What stands behind leaves is scaled by the share of rays that get there and back, over its mean.
 * Beams much wider than a leaf are not divided: the compound Poisson law of Drops.h stands for
 * their leaves.
 *
 * Source: the Boolean model of leaves at random places (Nilson, Agricultural Meteorology 8, 1971).
 * Differs: the paper has no leaves.
 * Valid: leaves are seen along the beam's axis, and exist where the medium of the ray's own column
 * does. Means are those of BeamAir.h.
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
  /// Begin a beam without leaves, or one that is not divided.
  void clear() { this->Rays.clear(); }

  /// Begin a beam. @param along its air, which must live as long
  void begin(BeamAir& along, double solidAngle, std::int32_t seed, std::uint64_t beam,
    std::int32_t revolution);

  bool any() const { return !this->Rays.empty(); }

  /// Share of the light that leaves let through to a range, m, and back, over its mean.
  double openAt(double range) const;

  /// Energy, J, that the leaves of a medium return between two ranges, m. Surfaces take what they
  /// meet before the unit of the last BeamAir::sharesOf().
  double returnedBetween(double from, double to, std::uint32_t medium) const;

  /// Largest section of a beam that is divided, where it meets its first crown, in areas of leaves.
  static constexpr double MostLeaves = 64.0;
  /// The same where it meets crowns behind the first one: it limits the leaves that are drawn.
  static constexpr double MostLeavesBehind = 4096.0;
  /// The same of the square that holds all ways there and back: it limits wide apertures.
  static constexpr double MostLeavesAcross = 1000.0;

private:
  struct Ray
  {
    std::array<double, 2> slope;    ///< across the beam
    std::array<double, 2> aperture; ///< point to which its light returns, m
    double share;                   ///< share of the pulse
    const BeamAir::Column* column;
    MetLeaf leaf; ///< at which it ends; at an infinite range: none
    bool isSeen;  ///< no leaf stops the light of that leaf on its way back
  };
  /// A leaf stops the light of a ray on its way back from these ranges, m.
  struct Shadow
  {
    std::size_t ray;
    double from, to;
  };
  /// Leaves of a medium, by range: those that stay, or those that are others in each scan.
  struct Stream
  {
    BeamAir::Leaves leaves;
    std::int32_t scan;
    double perVolume;     ///< 1/m^3
    double radius;        ///< radius of a leaf, m
    double rim;           ///< greatest distance from a ray at which a leaf matters, m
    std::uint64_t number; ///< number of draws
    double range;         ///< m, of the next leaf
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
