// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MovedBeams.h
 * @brief Finds the beams that movers may touch, and simulates each of these beams with the movers
 * at their poses at the beam's time.
 *
 * A beam with movers passes the same stages as any other beam, but its results are not kept.
 * Results of scans without movers are kept for later scans without movers.
 *
 * Spheres around the paths of movers are tested against many beams, then against a block. Spheres
 * around the places of movers are tested against each beam.
 *
 * Source: none. arXiv 2605.10457 also searches for the beams that a moving triangle can hit,
 * instead of building a tree again.
 * Valid: results with a mover at rest are bitwise identical to results with its triangles at the
 * end of the static mesh. Exceptions are the costs in reports, and faces of the mover that coincide
 * with other faces. Movers of equal content keep the order of the input.
 * Test: TestMovedBeams.cxx.
 */
#ifndef avianlidar_MovedBeams_h
#define avianlidar_MovedBeams_h

#include "BeamSimulator.h"
#include "Mover.h"
#include "RangeUnits.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace avianlidar
{
/// Simulates the beams that movers may touch, block by block. Each thread needs its own object. The
/// constructor's arguments must outlive the object.
class MovedBeams
{
public:
  /// @param setup setup with movers @param beams beams with times @param sights true: find the
  /// light that each mover returns
  MovedBeams(const ScanSetup& setup, const ScanAir& air, const ScanBeams& beams,
    BeamSampler& sampler, std::function<bool()> wanted, bool sights);

  /// Find the movers that beams [begin, end) may touch.
  void find(std::size_t begin, std::size_t end);

  /// True if a beam of the block may touch a mover.
  bool isTouched(std::size_t beam) const { return !this->Touching[beam - this->First].empty(); }

  /// What a beam with movers sees, and its light.
  struct Followed
  {
    BeamView view;
    BeamLight light;
  };
  /// Append the echoes of a beam with movers, append the light that the beam receives from each
  /// mover, and fill the beam's report. @param memory light whose memory is used again
  Followed simulate(std::size_t beam, BeamResults& results, BeamReport& report,
    std::vector<MoverLight>& sights, BeamLight&& memory);

  /// Static triangles, and the triangles of the movers that the beam simulated last may touch.
  const SceneTriangles& scene() const { return this->Simulator.scene(); }

private:
  struct Touch
  {
    std::uint32_t mover;
    Pose pose;
  };
  void findAmong(const std::vector<std::uint32_t>& movers, std::size_t begin, std::size_t end,
    std::vector<std::uint32_t>& found) const;
  MoverLight sightOf(
    const Touch& touch, const BeamFrame& frame, const BeamLight& light, AirLight& air);
  void addLightOf(std::uint32_t first, std::uint32_t end, const BeamLight& light);

  const ScanSetup& Setup;
  const ScanBeams& Beams;
  const BeamWidth Width;
  const bool Sights;
  std::vector<std::uint32_t> All;      ///< numbers of all movers
  std::vector<std::uint32_t> NearMany; ///< movers that may touch the beams [ManyBegin, ManyEnd)
  std::size_t ManyBegin = 0;
  std::size_t ManyEnd = 0;
  std::size_t First = 0;                    ///< first beam of the block
  std::vector<std::uint32_t> NearBlock;     ///< movers that may touch the block
  std::vector<std::vector<Touch>> Touching; ///< movers that may touch each beam of the block

  // Memory of simulate().
  ScanBeams CurrentBeam; ///< the beam alone
  BeamSimulator Simulator;
  BeamSimulator::Traced Traced;
  AirFinder AirAlong;
  AirLight LightOfAir;
  RangeUnitAccumulator Units; ///< energies that one mover returns
  TriangleMesh Mesh;          ///< triangles of one mover, placed
};
}

#endif
