// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamLighting.h
 * @brief Computes the light of a beam: the energies of all its paths, in range units.
 *
 * The paths are the direct echoes of all samples, and the paths with two reflections that the
 * light-energy constraint keeps. The constraint has these rules, with epsilon =
 * EchoSettings::lightEnergyFraction:
 *
 * - A path is dropped if its energy is less than epsilon Qlow / (number of paths of the beam). A
 *   path is not traced if an upper bound shows that it would be dropped.
 * - All secondary paths of a beam are skipped if the sum of their bounds and of the energy already
 *   dropped is less than epsilon Qlow.
 * - A secondary path is not traced if no range unit that it may reach can have the energy Qlow,
 *   even if nothing blocks any path. No path reaches a unit before its ends. This rule applies only
 *   if noise and air are too weak to be perceived.
 *
 * The samples of an integrated beam are nodes on its polygons (PolygonQuadrature.h). If the
 * polygons face each other, connections start from rays that meet the polygons. The samples of a
 * beam in cells are its strips (RangeStrips.h). Connections of such a beam start from the beam's
 * rays. Mirror paths of integrated beams and of beams in cells come from MirrorRegions.h.
 *
 * Source: paper, Eq. 4-9 and Sec. 3.4.
 * Differs: the constraint limits the energy that a whole range unit loses. A comparison of each
 * ray's energy with Qlow would remove every wall.
 * Valid: no range unit of an echo loses more than epsilon Qlow. The third rule changes no echo,
 * unless paths from random rays exceed the bound of their surface by chance.
 * Test: TestEchoClosedForms.cxx, TestSecondaryConstraints.cxx, TestScanAgain.cxx.
 */
#ifndef avianlidar_BeamLighting_h
#define avianlidar_BeamLighting_h

#include "BeamLight.h"
#include "BeamView.h"
#include "PathStarts.h"
#include "PolygonQuadrature.h"
#include "SecondaryReflection.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace avianlidar
{
/// Computes the light of one beam after the other. Each thread needs its own object. The
/// constructor's arguments must outlive the object.
class BeamLighting
{
public:
  /// @param mayAlarm true if range units without light from surfaces may be perceived in any beam
  /// @param lightsAll true: compute the light of beams even where bounds show that no energy can be
  /// perceived
  /// @param wanted function called every 4096 steps within a beam; WorkStopped is thrown if it
  /// returns false
  /// @param parts number of parts of a range unit, by which polygons are divided
  BeamLighting(const ScanSetup& setup, const SceneTriangles& scene, bool mayAlarm, bool lightsAll,
    std::function<bool()> wanted, double parts);

  /// A beam, and what it sees.
  struct Beam
  {
    std::uint64_t id;
    const BeamFrame& frame;
    const BeamView& view;     ///< what the beam sees; must outlive the light
    const PathStarts& starts; ///< hits from which paths with two reflections start
    const BeamAir& air;       ///< the air along the beam
  };

  /// The light of a beam. @param strata strata of the beam's rays; null for Monte Carlo @param
  /// known geometry of paths that was found before, or null; new geometry is added @param cost
  /// costs of tracing, increased @param memory light whose memory is used again
  BeamLight light(const Beam& beam, const StrataPartition* strata,
    std::unique_ptr<SecondaryTrace>& known, TraceCounters& cost, BeamLight&& memory);

  /// The same light of an integrated beam with the parts of this object. @param coarse result of
  /// light() of another object, whose paths are taken. Range units are not accumulated.
  BeamLight divided(const Beam& beam, const BeamLight& coarse, BeamLight&& memory);

private:
  bool addDirect(const Beam& beam, BeamLight& light);
  bool hasPaths(BeamLight& light) const;
  void addUp(const Beam& beam, BeamLight& light) const;
  bool placeNodes(const Beam& beam, BeamLight& light);
  bool mayBePerceived(const Beam& beam, double most, double others, BeamLight& light);
  double passMedia(const Beam& beam, double sum, BeamLight& light);
  void drawLeaves(const Beam& beam, BeamLight& light);
  bool onlySurfacesMatter(const Beam& beam) const;
  bool isSkipped(
    const Beam& beam, double most, double farthest, double nearest, BeamLight& light) const;
  void dropFaintPaths(BeamLight& light) const;
  double boundOfPaths(const Beam& beam, const BeamLight& light) const;
  bool collectPaths(const Beam& beam, const StrataPartition* strata, SecondaryTrace& known,
    TraceCounters& cost, BeamLight& light);

  const ScanSetup& Setup;
  const SceneTriangles& Scene;
  const bool MayAlarm;
  const bool LightsAll;
  const double
    LeastShare; ///< energy below which light is neither perceived nor recorded, over Qlow
  const std::function<bool()> Wanted;
  SecondaryReflection Secondary;
  BeamTracer Tracer;
  PolygonQuadrature Quadrature;
  LeafGaps Gaps;
  // Memory of single calls.
  PolygonBounds Bounds;
  Throughput OfStarts;
  std::vector<LeafGaps::Sample> BehindLeaves;
};
}

#endif
