// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamDirections.h
 * @brief Finds the beams of a scan whose cones hold a direction.
 *
 * The sphere of directions is cut into the cells of a cube's faces; each cell lists the beams that
 * may hold a direction of it.
 *
 * Source: none.
 * Valid: any directions; a half-beamwidth up to pi/3. On the border of a cone rounding decides.
 * Test: TestBeamDirections.cxx (all beams one by one).
 */
#ifndef avianlidar_BeamDirections_h
#define avianlidar_BeamDirections_h

#include "Vector.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
class BeamDirections
{
public:
  /// @param directions of the beams, finite and not zero @param halfBeamwidth rad
  BeamDirections(const std::vector<Vec3>& directions, double halfBeamwidth);

  /// f(number of the beam) for each beam whose cone holds a direction, in the order of their
  /// numbers. @param direction unit vector
  template <class F>
  void forEachHolding(const Vec3& direction, F f) const
  {
    const std::size_t cell = this->cellOf(direction);
    for (std::uint32_t k = this->Begins[cell]; k < this->Begins[cell + 1]; ++k)
    {
      const std::uint32_t beam = this->Beams[k];
      if (glm::dot(this->Axes[beam], direction) >= this->Cosine)
      {
        f(beam);
      }
    }
  }

private:
  std::size_t cellOf(const Vec3& direction) const;
  template <class F>
  void forEachCell(const Vec3& axis, double halfBeamwidth, F f) const;

  std::size_t Side; ///< cells along an edge of the cube
  double Cosine;    ///< of the half-beamwidth
  std::vector<Vec3> Axes;
  std::vector<std::uint32_t> Begins; ///< of the cells' beams
  std::vector<std::uint32_t> Beams;
};
}

#endif
