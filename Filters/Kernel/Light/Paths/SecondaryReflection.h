// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SecondaryReflection.h
 * @brief Paths with two reflections inside the beam (with an aperture also a third, by the mirror
 * of the first), and the light-energy constraint on them.
 *
 * By the beam constraint the second reflection point P2 lies inside the receiving beam. Two kinds
 * of paths start at a primary hit P1:
 *
 * 1. A mirror path follows the mirror direction of the incident ray, with weight 1 and only the
 * specular reflectance f_s at P1. If the visible surfaces are known, MirrorRegions.h places the
 * samples from which mirror paths start.
 * 2. Diffuse connections lead to the hit points of M other rays of the beam. The lidar both lights
 * and sees these points. Only the diffuse reflectance f_d counts at P1 (f_s would count the mirror
 * lobe twice). The partners follow from M random cyclic shifts of the ray numbers. The weighted sum
 * of the connections' throughputs estimates the mean over the cone's solid angle.
 *
 * At P2 both f_d and f_s count. A path counts only if P2 lies in the cone and is visible from the
 * apex, and if the segment leaves P1 and reaches P2 on the sides that face the apex. The energy of
 * a path is Q f(P1) f_sur(P2) exp(-mu length), with Q the energy of the ray, f_sur = f_d + f_s, and
 * mu the attenuation coefficient.
 *
 * A ray never returns more than Q times the albedo at P1. The direct echo leaves the budget B =
 * albedo - f_direct at P1. P1 passes on at most the share g of the energy. R2 = kd2 + ks2 is the
 * reflectance of the second surface. A path is scaled by min(1, B/(g R2)), which is 1 for the
 * materials of the paper. The weights of connections are random. Where the weights exceed their
 * mean, the excess over the budget is cut.
 *
 * The following holds for a receiver aperture A > 0, where Omega is the solid angle of the cone:
 *
 * 1. Matt light leaves P1 in a direction drawn from the mirror's lobe cos^kp, and is lost below the
 * horizon of P1. So P2 may lie where no exact mirror direction ends: more paths start all over the
 * mirror, and those whose exact end the apex sees are left to MirrorRegions.h. The light also comes
 * back by the reverse path, which ends on the mirror. The reverse path is weighted by the beam's
 * density at P2 divided by the density at P1, times the cosines of the drawn and of the lidar's
 * direction at P1. With NumberOfReflections 3 the light also comes back by the mirror. The third
 * point is drawn about the image of P2 from the lobe, narrowed by the share of the image's distance
 * that lies behind the mirror, and weighted by the true lobe. If both surfaces are mirrors, the
 * exact direction is followed, and the widths of the lobes add up.
 * 2. Both reflections of a connection are matt. The throughput of a connection contains the form
 * factor F = cos(out at P1) cos(in at P2) r2^2 Omega/(pi L^2 cos(lidar's incidence at P2)), at most
 * MostFormFactor = 1.
 * 3. Short paths account for the excess of F over 1. M short paths start at each hit, distributed
 * as the matt light of the hit. A path that ends in the cone with F > 1 has the weight 1 - 1/F. For
 * all kinds of paths, the cosine in f at P2 is the cosine of the outgoing direction.
 *
 * Geometry is found only where energies depend on the geometry. The geometry is stored
 * (KeptBeam.h). Throughputs are computed anew each time energies are computed.
 *
 * Source: paper, Sec. 3.4 and Eq. 6. The sum of bounded connections and short paths: Kollig and
 * Keller, "Illumination in the Presence of Weak Singularities", MCQMC 2004.
 * Differs: the paper leaves open how many secondary directions are followed, and with which weight.
 * The paper has neither the scale by the budget nor an aperture.
 * Valid: the paths of a ray together return at most B. No range unit of an echo loses more than
 * epsilon Qlow by the light-energy constraint (BeamLighting.h).
 * Test: TestSecondaryReflection.cxx, TestSecondaryPaths.cxx, TestSecondaryConstraints.cxx,
 * TestScanAgain.cxx.
 */
#ifndef avianlidar_SecondaryReflection_h
#define avianlidar_SecondaryReflection_h

#include "ConnectionFinder.h"
#include "MirrorPairs.h"
#include "MirrorRegions.h"
#include "ScanSetup.h"
#include "SecondaryBeam.h"
#include "SecondaryTrace.h"

#include <utility>
#include <vector>

namespace avianlidar
{
/// One path with two reflections that arrives at the lidar.
struct SecondaryPath
{
  double length;          ///< length of the whole path, m
  double energy;          ///< energy received, J
  std::uint32_t triangle; ///< triangle of the last reflection
  double cosIncidence;    ///< cosine of incidence at the last reflection
  std::uint32_t one;      ///< sample at P1; NoSample for mirror paths by MirrorRegions.h
  std::uint32_t two;      ///< sample at P2, numberAfter() of a mirror path, or NoSample
  double unsure = 0.0;    ///< share of the energy that the width of a mirror's lobe may change
};

/// Finds the paths of one beam after the other. Each thread needs its own object.
class SecondaryReflection
{
public:
  SecondaryReflection(const ScanSetup& setup, const SceneTriangles& scene);

  /// Upper bound of the sum of the throughputs of all paths of a beam: the part of the albedo that
  /// direct echoes leave. The throughputs of paths from rays may exceed this bound a little by
  /// chance. @param samples samples of the direct echo, from rays or not
  double bound(const BeamSamples& samples, const Throughput& direct) const;

  /// Upper bound of the sum of the throughputs of all paths of an integrated beam, which has no
  /// samples on surfaces without a direct echo.
  /// @param albedo largest albedo of the beam's surfaces @param nearest lower bound of ranges, m
  double bound(double albedo, double nearest) const;

  /// Set the paths of the beam: first mirror paths in the order of the samples, then connections,
  /// then short paths.
  /// @param lost energy, J, increased by the bounds of the paths that are dropped
  /// @return false if no range unit can have the energy SecondaryBeam::faintBelow, even if nothing
  /// blocks any path. In this case no path is traced, and `lost` is the bound of a unit.
  bool collect(const SecondaryBeam& beam, std::vector<SecondaryPath>& paths, double& lost);

private:
  /// Throughputs of a mirror path. With an aperture, only light from two mirrors follows the mirror
  /// direction exactly. Matt light takes the drawn direction: it comes from the matt end, by the
  /// mirror after direct light, and by the mirror after light from the mirror.
  struct MirrorThroughput
  {
    double exact = 0.0, there = 0.0, back = 0.0, again = 0.0;
    double most = 0.0; ///< bound of the matt light if the direction is not drawn
    double total() const
    {
      return this->exact + this->there + this->back + this->again + this->most;
    }
  };
  void prepare(const SecondaryBeam& beam, bool byRegions);
  double placeMirrors(const SecondaryBeam& beam, double least, double needed);
  double boundBeyond(std::size_t surface) const;
  double mostBeyond() const;
  double traceBeyondMirrors(const SecondaryBeam& beam, double least);
  double addPaths(const SecondaryBeam& beam, double most, double further, bool mirrors);
  double measureMirrors(const SecondaryBeam& beam, std::size_t from);
  double mostOfMirrors(bool byRegions) const;
  void measure(const SecondaryBeam& beam);
  double untracedMirrors(const SecondaryTrace& trace) const;
  double untracedBound(const SecondaryTrace& trace) const;
  void listPaths(const SecondaryBeam& beam, std::vector<SecondaryPath>& paths) const;
  MirrorThroughput mirrorThroughput(const SecondaryBeam& beam, const MirrorPath& path) const;
  double unsureShare(const MirrorPath& path) const;
  double shortThroughput(const SecondaryBeam& beam, const ShortPath& path) const;
  double mostOfShortPaths(const SecondaryBeam& beam) const;
  void cutToBudget(const SecondaryBeam& beam, std::vector<SecondaryPath>& paths);

  const ScanSetup& Setup;
  const BeamShape Shape;
  ConnectionFinder Finder;
  MirrorRegions Regions;
  MirrorPairs Pairs;
  std::vector<std::uint32_t> Triangles; ///< triangle of each sample
  MaterialLanes Materials;              ///< material of each sample
  std::vector<double> SpecularBounds;   ///< bound of the mirror path's throughput, by sample
  double OverMirror = 1.0;              ///< mirrorReturnBound()
  double OfMatt = 1.0;                  ///< mattReturnBound()
  std::vector<char> Wanted;             ///< whether mirror paths may matter, by surface
  /// Surfaces in the order of their search, each after minus the bound of its throughput.
  std::vector<std::pair<double, std::uint32_t>> Order;
  std::vector<MirrorThroughput> MirrorParts; ///< unblocked throughputs of mirror paths
  std::vector<double> MirrorThroughputs;     ///< sums of MirrorParts
  std::vector<double> ConnectionThroughputs; ///< unblocked throughput of connections
  std::vector<double> Returned;              ///< energy of paths with two reflections, by sample, J
};

}

#endif
