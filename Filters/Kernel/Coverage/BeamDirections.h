// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamDirections.h
 * @brief Finds the beams of a scan whose cones hold a direction.
 *
 * The sphere of directions is cut into the cells of a cube's faces; each cell lists the beams that
 * may hold a direction of it.
 *
 * Source: none.
 * Valid: any directions; a half-beamwidth with margin up to pi/3. On the border of a cone rounding
 * decides.
 * Test: TestBeamDirections.cxx (all beams one by one).
 */
#ifndef avianlidar_BeamDirections_h
#define avianlidar_BeamDirections_h

#include "Vector.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
class BeamDirections
{
public:
  /// @param directions of the beams, finite and not zero @param halfBeamwidth rad @param margin
  /// rad, how far outside a cone forEachNear() finds its beam
  BeamDirections(const std::vector<Vec3>& directions, double halfBeamwidth, double margin = 0.0);

  /// f(number of the beam, cosine of the angle from its axis) for each beam whose cone, wider by
  /// the margin, holds a direction, and maybe some more, in the order of their numbers.
  /// @param direction unit vector
  template <class F>
  void forEachNear(const Vec3& direction, F f) const
  {
    const std::size_t cell = this->cellOf(direction);
    for (std::uint32_t k = this->Begins[cell]; k < this->Begins[cell + 1]; ++k)
    {
      const std::uint32_t beam = this->Beams[k];
      f(beam, glm::dot(this->Axes[beam], direction));
    }
  }

  /// Cells, and the one of a direction: directions of one cell are near the same beams.
  std::size_t cells() const { return this->Begins.size() - 1; }
  std::size_t cellOf(const Vec3& direction) const;

  /// f(number of the beam) for the beams that directions of a cell are near.
  template <class F>
  void forEachOfCell(std::size_t cell, F f) const
  {
    std::for_each(
      this->Beams.begin() + this->Begins[cell], this->Beams.begin() + this->Begins[cell + 1], f);
  }

  /// The most beams that forEachNear() finds.
  std::size_t mostNear() const { return this->Most; }

  const Vec3& axis(std::uint32_t beam) const { return this->Axes[beam]; } ///< unit vector

private:
  template <class F>
  void forEachCell(const Vec3& axis, double halfBeamwidth, F f) const;

  std::size_t Side; ///< cells along an edge of the cube
  std::size_t Most = 0;
  std::vector<Vec3> Axes;
  std::vector<std::uint32_t> Begins; ///< of the cells' beams
  std::vector<std::uint32_t> Beams;
};
}

#endif
