// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PlaneQuadrature.h
 * @brief The direct echo of a beam that a plane fills, integrated instead of sampled.
 *
 * In the paper's radiometry all that a point of a plane returns (Eq. 4-9), and when, depends on its
 * angle of incidence b alone: its range is h/cos b, h the plane's distance. With t the
 * half-beamwidth and a the angle between axis and normal, the directions of incidence b in the cone
 * are an arc of half-length phi_m(b) about the normal,
 *
 *   tan^2(phi_m/2) = sin((t+b-a)/2) sin((t-b+a)/2) / (sin((b+a-t)/2) sin((b+a+t)/2)),
 *
 * so the beam is an integral over b of 2 phi_m sin b / (4 pi sin^2(t/2)) (uniform profile; for the
 * Gaussian one with the integral of the profile along the arc, ten points of Gauss's rule). With
 * b = |a-t| + 2 min(a,t) sin^2 x the roots of phi_m at both ends of the arc vanish, and no
 * difference of nearly equal angles is left, however narrow the beam; where the normal lies in the
 * cone the full circles are a piece of their own.
 *
 * The interval is parted where something changes: where a pulse begins to enter a range unit or to
 * leave it (in between its share is linear in the range), and by the width of the specular lobe,
 * near a grazing direction, and where the cone just misses the normal. Every panel takes a pair of
 * Gauss-Kronrod rules (GaussKronrod.h) of 5 to 15 points. Their points become `BeamNodes`: hits
 * with shares of the pulse's energy of their own, for which light, range units, receiver and labels
 * are those of rays.
 *
 * Bound: the difference of the two rules, summed over panels in magnitude, which exceeds the error
 * of the better one by far, and what rounding and the tolerances of VisiblePatch.h can add.
 *
 * Loops over lanes (LaneMath.h): the same bits for every instruction set. Time: about 20 ns a node.
 */
#ifndef avianlidar_PlaneQuadrature_h
#define avianlidar_PlaneQuadrature_h

#include "BeamFrame.h"
#include "GaussKronrod.h"
#include "PrimaryHits.h"
#include "RangeUnits.h"
#include "ScanSetup.h"
#include "VisiblePatch.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Beams that would need more panels are left to their rays.
constexpr std::size_t MostPanels = 1024;

/// Where the energy of a beam arrives.
struct BeamNodes
{
  PrimaryHits hits;                  ///< `ray` is the number of the node, `rays` how many there are
  std::vector<double> doubt;         ///< (Kronrod's weight - Gauss's)/Kronrod's
  std::vector<std::uint32_t> panels; ///< end of each
  double misplaced = 0.0; ///< bound of the share of the beam's energy that rounding and tolerances
                          ///< bring into another range unit
};

/// Reusable without allocation; one per thread. The setup must outlive it.
class PlaneQuadrature
{
public:
  explicit PlaneQuadrature(const ScanSetup& setup);

  /// False if the beam needs rays: materials or objects differ within the patch, too many panels, a
  /// receiver so near that its aperture gathers all.
  bool fits(const BeamFrame& frame, const VisiblePatch& patch) const;

  /// Length in range, m, of what the beam sees of a plane; infinite or NaN beyond the horizon.
  static double footprintOf(const BeamFrame& frame, const PatchPlane& plane);

  /// Of a beam some rays of which hit these triangles (at least one; NoTriangle: none): false if
  /// the rays, but for mostRaysOff(), tell that materials or objects differ, or if the footprint
  /// goes over so many range units that the beam does not fit.
  bool mayFit(double footprint, const std::uint32_t* triangles, std::size_t count) const;

  /// Of a beam that fits. They stand until the next call.
  const BeamNodes& place(const BeamFrame& frame, const VisiblePatch& patch);

  /// What is known of a beam without its nodes.
  struct Extent
  {
    double nearest;      ///< m
    double farthest;     ///< m
    double mostReturned; ///< upper bound of the share of the pulse's energy that comes back
  };
  Extent extentOf(const BeamFrame& frame, const VisiblePatch& patch) const;

  /// Bound of the error, J, of what the nodes placed last put into some range units. @param total
  /// J, of all nodes
  double boundOf(const RangeShares& shares, double total) const;

private:
  /// What is integrated over.
  struct Disc
  {
    double height;   ///< h, m
    double tilt;     ///< a, rad
    double half;     ///< t, rad
    double sine2;    ///< sin^2(t/2)
    double least;    ///< b, rad, of the disc
    double most;     ///< b, rad
    double cosLeast; ///< of these
    double cosMost;
    double nearest() const { return this->height / this->cosLeast; }
    double farthest() const { return this->height / this->cosMost; }
  };
  static Disc discOf(const BeamFrame& frame, const PatchPlane& plane);
  bool mayFit(double footprint) const;
  bool isAlike(std::uint32_t one, std::uint32_t two) const;
  double bordersOf(double footprint) const;
  void findBorders(const Disc& disc, const Material& material);
  void addUnitBorders(const Disc& disc);
  void addLobeBorders(const Disc& disc, const Material& material);
  void addPoleBorders(const Disc& disc);
  void addPiece(const Material& material, bool circles, double from, double to);
  void addPanel(const GaussKronrodRule& rule, double lower, double upper);
  const GaussKronrodRule& ruleFor(
    const Material& material, double width, double from, double to, bool end) const;
  double misplacedOf(const BeamFrame& frame, const Disc& disc, const VisiblePatch& patch) const;
  void evaluate(const Disc& disc, std::size_t circles);
  double lobeWidth2(const Material& material) const;

  const ScanSetup& Setup;
  double UnitLength; ///< m
  double Offsets[2]; ///< of the ranges at which a pulse begins or ends at a border, in units
  int NumberOfOffsets;
  BeamNodes Nodes;
  std::vector<double> Borders; ///< b, rad, ascending
  std::vector<double> Places;  ///< of the borders of a piece, in its own variable
  std::vector<double> Ranges;
  std::vector<double> Variable; ///< of each node: b on full circles, else x
  std::vector<double> Weight;
};
}

#endif
