// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MovedBeams.h
 * @brief Beams that movers may touch: finds them, and simulates each with the movers placed where
 * they are at its time.
 *
 * Such a beam goes through the same stages as any other, and nothing of it is kept. What is kept of
 * it from scans without movers stays for the scan in which they have gone.
 *
 * Movers are found for many beams first, then for a block, by spheres about their paths while it is
 * fired, and then for each beam, by spheres where they are.
 *
 * Source: none. arXiv 2605.10457 asks which beams a moving triangle can hit, too, instead of
 * building a tree again.
 * Valid: a mover at rest gives the bits of the same triangles at the end of the static mesh, but
 * for costs and where faces of it coincide with others. Movers of equal content count in the order
 * in which they come.
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
/// Simulates the beams of one block after the other that movers may touch. One per thread; the
/// constructor's arguments must outlive it.
class MovedBeams
{
public:
  /// @param setup with movers @param beams with times @param sights find what beams receive of each
  /// mover
  MovedBeams(const ScanSetup& setup, const ScanBeams& beams, BeamSampler& sampler,
    std::function<bool()> wanted, bool sights);

  /// Find the movers that beams [begin, end) may touch.
  void find(std::size_t begin, std::size_t end);

  /// True if a beam of the block may touch a mover.
  bool isTouched(std::size_t beam) const { return !this->Touching[beam - this->First].empty(); }

  /// Append the echoes of such a beam and what it receives of each mover, and fill its report.
  void simulate(std::size_t beam, std::vector<Echo>& echoes, BeamReport& report,
    std::vector<MoverSight>& sights);

  /// What lit the beam simulated last.
  const BeamSimulator& simulator() const { return this->Simulator; }

private:
  struct Touch
  {
    std::uint32_t mover;
    Pose pose;
  };
  void findAmong(const std::vector<std::uint32_t>& movers, std::size_t begin, std::size_t end,
    std::vector<std::uint32_t>& found) const;
  MoverSight sightOf(const Touch& touch, const BeamFrame& frame, const BeamLighting& lighting);
  void addLightOf(std::uint32_t first, std::uint32_t end, const BeamLighting& lighting);

  const ScanSetup& Setup;
  const ScanBeams& Beams;
  const BeamWidth Width;
  const bool Sights;
  std::vector<std::uint32_t> All;    ///< movers
  std::vector<std::uint32_t> OfMany; ///< that beams [ManyBegin, ManyEnd) may touch
  std::size_t ManyBegin = 0;
  std::size_t ManyEnd = 0;
  std::size_t First = 0;                    ///< beam of the block
  std::vector<std::uint32_t> OfBlock;       ///< movers that the block may touch
  std::vector<std::vector<Touch>> Touching; ///< by beam of the block

  // The beam being simulated.
  ScanBeams One;
  BeamSimulator Simulator;
  RangeUnitAccumulator Units; ///< energies that one mover returns
  std::vector<BeamTrace> Trace;
  TriangleMesh Mesh; ///< triangles of one mover, placed
};
}

#endif
