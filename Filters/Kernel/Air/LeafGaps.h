// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LeafGaps.h
 * @brief Single leaves in a beam: the light that they return and the light that they transmit.
 *
 * A beam is divided into rays, one through each cell of its grid (BeamAir.h). The light of a ray
 * returns to one point of the aperture. Leaves are discs of one size at random places (Poisson),
 * with all orientations equally likely. A ray ends at the first leaf that it meets. The way back
 * lies beside the way out. The light of the ray comes back unless another leaf stops this light on
 * the way back. So a leaf may stop one part of a beam and not the rest. A range unit receives the
 * light of the rays that end in this unit. Light of the air from a range behind leaves is scaled by
 * the share of rays that no leaf stops on the way to this range and back, divided by the mean of
 * this share. Beams much wider than a leaf are not divided. The leaves in such beams follow the
 * compound Poisson law of Drops.h.
 *
 * The samples of an object in a range unit form a target, with its own rays to random points of the
 * samples. A ray that no leaf stops carries the light that reaches the target on average, divided
 * by the ray's mean transmission. In a divided beam, targets share the leaves of the beam. In any
 * other beam, leaves are drawn about each object that is not much wider than a leaf. The light of
 * wider objects has its mean.
 *
 * Source: the Boolean model of leaves at random places (Nilson, Agricultural Meteorology 8, 1971).
 * Differs: the paper has no leaves.
 * Valid: leaves are projected along the beam's axis. A leaf exists for a ray if the medium in the
 * ray's column is dense enough. Mean energies are the same as in BeamAir.h.
 * Test: TestBeamCrowns.cxx.
 */
#ifndef avianlidar_LeafGaps_h
#define avianlidar_LeafGaps_h

#include "AirLight.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// The leaves drawn in a beam that is divided into rays; no rays in any other beam.
class DrawnLeaves
{
public:
  /// True if the beam is divided.
  bool any() const { return !this->Rays.empty(); }

  /// Transmission of the leaves to a range, m, and back, divided by the mean transmission. @param
  /// air air of the beam
  double openAt(const BeamAir& air, double range) const;

  /// Energy, J, that the leaves of a medium return from ranges [from, to), m. @param light light of
  /// the beam's air, whose surfaces take their shares of the pulse as in AirLight::returnedBy()
  double returnedBetween(
    const BeamAir& air, const AirLight& light, double from, double to, std::uint32_t medium) const;

  struct Ray
  {
    double share; ///< share of the pulse in the ray; to a target, share of the target's mean light
    std::size_t column; ///< number of the column in BeamAir::columns()
    MetLeaf leaf; ///< leaf at which the ray ends, with an infinite range if there is no such leaf
    bool isSeen;  ///< true if no leaf stops the light that `leaf` or the target returns
  };
  /// Ranges, m, from which a leaf stops the light of a ray on its way back.
  struct Shadow
  {
    std::size_t ray;
    double from, to;
  };

private:
  friend class LeafGaps;

  std::vector<Ray> Rays; ///< one ray for each cell of the beam's grid
  std::vector<Shadow> Shadows;
};

/// Draws the leaves of one beam after the other. Each thread needs its own object.
class LeafGaps
{
public:
  /// A sample of a surface.
  struct Sample
  {
    int object;                         ///< object id
    std::int64_t unit;                  ///< number of the range unit
    std::size_t number;                 ///< number for the caller
    double range;                       ///< range, m
    double energy;                      ///< mean energy that returns, J
    std::uint64_t bits;                 ///< cells of the grid that the sample meets
    std::array<double, 2> middle, half; ///< place in the beam's plane: an ellipse
    double open = 1.0;                  ///< light that leaves let through, over its mean
  };

  /// Draw the leaves of a beam that meets leaves. @param leaves result of BeamAir::leaves()
  /// @param samples samples of surfaces, which are sorted and get `open`
  DrawnLeaves draw(const BeamAir& air, const std::vector<BeamAir::Leaves>& leaves,
    std::int32_t seed, std::uint64_t beam, std::int32_t revolution, std::vector<Sample>& samples);

  /// Largest cross-section of a divided beam where its first leaves begin, in projected leaf areas.
  static constexpr double MostLeaves = 64.0;
  /// Largest cross-section of the beam where the leaves of a medium behind the first medium begin,
  /// in projected leaf areas. This number limits the number of leaves that are drawn.
  static constexpr double MostLeavesBehind = 4096.0;
  /// Largest area of a square about all ways out and back, in projected leaf areas. This number
  /// limits the aperture.
  static constexpr double MostLeavesAcross = 1000.0;
  /// Number of rays to an object, which its targets share, and least number of rays to a target.
  static constexpr double RaysToObject = 64.0;
  static constexpr double LeastRaysToTarget = 8.0;

private:
  struct Ray : DrawnLeaves::Ray
  {
    std::array<double, 2> slope;    ///< tangents across the beam
    std::array<double, 2> aperture; ///< point of the aperture to which the ray's light returns, m
    double end;                     ///< range of the target, m; infinite if the ray has no target
  };
  /// Samples of a target, up to `sample`, and the target's rays, up to `ray`.
  struct Target
  {
    std::size_t sample, ray;
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
  void makeStreams(const BeamAir& air, double growth, double solidAngle, std::uint64_t first,
    std::int32_t revolution);
  void makeRays(const BeamAir& air, double turn, double shift);
  template <class F>
  void addTargets(const BeamAir& air, const std::vector<Sample>& samples, std::size_t first,
    std::size_t last, F draw);
  template <class F>
  void place(const BeamAir& air, const std::array<double, 2>& middle,
    const std::array<double, 2>& half, F draw);
  void open(std::size_t first, std::vector<Sample>& samples);
  template <class F>
  void placeOne(const BeamAir& air, const std::array<double, 2>& centre, const Stream& of, F draw);

  std::vector<Ray> Rays; ///< rays of the grid, then rays to targets
  std::size_t Grid = 0;  ///< number of rays of the grid
  std::vector<Target> Targets;
  std::vector<std::size_t> Going; ///< rays that no leaf has stopped so far
  std::vector<DrawnLeaves::Shadow> Shadows;
  std::vector<BeamAir::Leaves> Leaves;
  std::vector<Stream> Streams;
};
}

#endif
