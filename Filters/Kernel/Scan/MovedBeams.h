// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MovedBeams.h
 * @brief Beams that movers may touch: finds them, and simulates each with a scene of its own.
 *
 * A beam meets movers where they are at its own time. Direct echoes and paths over two reflections
 * lie in the beam's cone, which is convex; so the scene of a beam is the static triangles that its
 * cone may meet, in the order of their numbers, and the triangles of the movers that it may touch,
 * placed at its time. It goes through the same stages as any other beam. Static hits of the beam
 * are left as they are, for the scan in which the movers have gone.
 *
 * Movers are found for a block of beams first, by spheres about their paths while it is fired, and
 * then for each beam, by spheres where they are.
 *
 * Source: none. arXiv 2605.10457 asks which beams a moving triangle can hit, too, instead of
 * building a tree again.
 * Valid: a mover at rest gives the bits of the same triangles at the end of the static mesh, but
 * for costs. Movers of equal content count in the order in which they come.
 * Test: TestMovedBeams.cxx.
 */
#ifndef avianlidar_MovedBeams_h
#define avianlidar_MovedBeams_h

#include "BeamSimulator.h"
#include "Mover.h"
#include "Traversal.h"

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
  /// @param setup with movers @param beams with times
  MovedBeams(const ScanSetup& setup, const ScanBeams& beams, std::uint32_t shading,
    BeamSamplers& samplers, std::function<bool()> wanted);

  /// Find the movers that beams [begin, end) may touch.
  void find(std::size_t begin, std::size_t end);

  /// True if a beam of the block may touch a mover.
  bool isTouched(std::size_t beam) const { return !this->Touching[beam - this->First].empty(); }

  /// Append the echoes of such a beam, and fill its report.
  void simulate(std::size_t beam, std::vector<Echo>& echoes, BeamReport& report);

private:
  struct Touch
  {
    std::uint32_t mover;
    Pose pose;
  };
  void findForBlock(std::size_t begin, std::size_t end);
  void makeScene(const BeamFrame& frame, const std::vector<Touch>& touching);
  void addStatic(const BeamFrame& frame);
  void addTriangle(std::size_t number);

  const ScanSetup& Setup;
  const ScanBeams& Beams;
  const BeamWidth Width;
  const std::uint32_t Shading;
  BeamSamplers& Samplers;
  std::function<bool()> Wanted;
  std::vector<std::size_t> Numbers;   ///< of each mover's first triangle, after all static ones
  std::size_t First = 0;              ///< beam of the block
  std::vector<std::uint32_t> OfBlock; ///< movers that the block may touch
  std::vector<std::vector<Touch>> Touching; ///< by beam of the block

  // The scene of a beam.
  ScanSetup Scene;
  ScanBeams One; ///< the beam
  std::vector<BeamTrace> Trace;
  TraversalStack Stack;
  std::vector<std::uint32_t> Static; ///< triangles that the cone may meet
  std::vector<Material> Materials;
  std::vector<int> ObjectIds;
  std::vector<int> MaterialIds;
  std::shared_ptr<TriangleMesh> Mesh;
  std::size_t Last = 0; ///< number of the triangle added last, in the scene of all movers
};
}

#endif
