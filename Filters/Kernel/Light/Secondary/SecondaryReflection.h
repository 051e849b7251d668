// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SecondaryReflection.h
 * @brief Paths with two reflections inside the beam, and the light-energy constraint on them.
 *
 * The beam constraint says that the second reflection point P2 lies inside the receiving beam. For
 * a primary hit P1:
 *
 * 1. mirror path: the mirror direction of the incident ray is followed, weight 1, with f_s alone at
 * P1. Where what the beam sees is known, such paths start from samples of their own
 * (MirrorRegions.h);
 * 2. diffuse connections: f_d alone at P1 (with f_s the mirror lobe would count twice), to the hit
 * points of M other rays of the beam, which the lidar both lights and sees. The partners come from
 * M random cyclic shifts of the ray numbers, weighted so that the sum estimates the mean over the
 * cone's solid angle.
 *
 * At P2 the whole of f_sur acts. A path counts only if P2 lies in the cone and is visible from the
 * apex, and the segment leaves P1 and reaches P2 on the sides that face the apex. A path carries Q
 * f(P1) f_sur(P2) exp(-mu length).
 *
 * A ray never returns more than its albedo times Q: with B = (albedo - f_direct) the budget that
 * its direct echo leaves at P1, and g the largest share that P1 can pass on, a path to a surface of
 * reflectance R2 = kd2 + ks2 is scaled by min(1, B/(g R2)). For the materials of the paper the
 * factor is 1. Where the random weights of the connections exceed their mean, what would still pass
 * the budget is cut.
 *
 * With a receiver aperture A > 0, and Omega the solid angle of the cone:
 *
 * 1. The matt part of what a mirror path returns at P2 comes back by the reverse path as well,
 * which ends on the mirror. It weighs by the beam's density at P2 over that at P1. The lobes of two
 * mirrors add up where the light arrives.
 * 2. A connection is matt at both ends. It carries the form factor F = cos(out at P1) cos(in at P2)
 * r2^2 Omega/(pi L^2 cos(lidar's incidence at P2)), at most MostFormFactor = 1.
 * 3. Short paths carry the rest: M directions of each ray, drawn as its matt light is spread. A
 * path that ends in the cone with F > 1 carries 1 - 1/F. Then f at P2 takes the cosine of the
 * outgoing direction, as that of connections and mirror paths does.
 *
 * Geometry is found once and kept (BeamTrace.h), and only as far as energies need it. Throughputs
 * are computed each time a beam is lit.
 *
 * Source: paper, Sec. 3.4 and Eq. 6. The sum of bounded connections and short paths: Kollig and
 * Keller, "Illumination in the Presence of Weak Singularities", MCQMC 2004.
 * Differs: the paper leaves open how many secondary directions are followed and with what weight;
 * the scale by the budget and all that an aperture changes are ours.
 * Valid: the paths of a ray return at most B together. No range unit loses more than epsilon Qlow
 * by the light-energy constraint (BeamLighting.h).
 * Test: TestSecondaryReflection.cxx, TestSecondaryPaths.cxx, TestSecondaryConstraints.cxx,
 * TestScanAgain.cxx.
 */
#ifndef avianlidar_SecondaryReflection_h
#define avianlidar_SecondaryReflection_h

#include "ConnectionFinder.h"
#include "MirrorRegions.h"
#include "ScanSetup.h"
#include "SecondaryBeam.h"
#include "SecondaryTrace.h"

#include <vector>

namespace avianlidar
{
/// One path over two reflections that arrived.
struct SecondaryPath
{
  double length;          ///< of the whole path, m
  double energy;          ///< J
  std::uint32_t triangle; ///< at P2
  double cosIncidence;    ///< at P2
  std::uint32_t one;      ///< sample at P1; NoSample of a mirror path by regions
  std::uint32_t two;      ///< sample at P2; else NoSample, by regions the sample of the path
  double unsure = 0.0;    ///< share of the energy that the width of a mirror's lobe may change
};

/// Paths of one beam after the other. One per thread.
class SecondaryReflection
{
public:
  SecondaryReflection(const ScanSetup& setup, const SceneTriangles& scene);

  /// Bound of the sum of the throughputs of all paths of a beam. @param samples of its direct echo,
  /// rays or not. Paths that start from rays may bring somewhat more by chance. @param tight false:
  /// what the direct echoes leave of the albedo suffices
  double bound(const BeamSamples& samples, const Throughput& direct, bool tight) const;

  /// The same of an integrated beam, which has no samples where nothing comes straight back.
  /// @param albedo the largest of what it sees @param nearest m: no surface of it is nearer
  double bound(double albedo, double nearest) const;

  /// Set the paths of the beam: mirror paths in the order of the samples, then connections.
  /// @param lost sum of the bounds of dropped paths, J; those dropped here are added
  /// @return false if all paths together, whatever is in their way, bring less than
  /// SecondaryBeam::silentBelow: none is traced then, and `lost` is the bound of all
  bool collect(const SecondaryBeam& beam, std::vector<SecondaryPath>& paths, double& lost);

private:
  /// Throughputs of a mirror path and, through an aperture, of the same path back.
  struct BothWays
  {
    double there, back;
  };
  void prepare(const SecondaryBeam& beam, bool byRegions);
  double placeMirrors(const SecondaryBeam& beam, double least);
  void measureMirrors(const SecondaryBeam& beam);
  double mostOfMirrors(bool byRegions) const;
  void measure(const SecondaryBeam& beam);
  double untracedSum(const SecondaryTrace& trace) const;
  void listPaths(const SecondaryBeam& beam, std::vector<SecondaryPath>& paths) const;
  BothWays mirrorThroughput(const SecondaryBeam& beam, const MirrorPath& path) const;
  double unsureShare(const MirrorPath& path) const;
  double shortThroughput(const SecondaryBeam& beam, const ShortPath& path) const;
  double mostOfShortPaths(const SecondaryBeam& beam) const;
  void cutToBudget(const SecondaryBeam& beam, std::vector<SecondaryPath>& paths);

  const ScanSetup& Setup;
  const BeamShape Shape;
  ConnectionFinder Finder;
  MirrorRegions Regions;
  std::vector<std::uint32_t> Triangles;      ///< by sample
  MaterialLanes Materials;                   ///< by sample
  std::vector<double> SpecularBounds;        ///< bounds of mirror paths' throughputs, by sample
  double OverMirror = 1.0;                   ///< mostOverMirror()
  double NumberWanted = 0.0;                 ///< of mirror paths
  std::vector<char> Wanted;                  ///< by surface: its mirror paths may matter
  std::vector<double> MirrorThroughputs;     ///< by mirror path, both ways, if it is not blocked
  std::vector<double> BackThroughputs;       ///< the way back of these
  std::vector<double> ConnectionThroughputs; ///< by connection, if it is not blocked
  std::vector<double> Returned;              ///< over two reflections, by sample, J
};

}

#endif
