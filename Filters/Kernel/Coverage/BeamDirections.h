// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamDirections.h
 * @brief Finds the beams of a scan whose cones hold a direction.
 *
 * The sphere of directions is cut into the cells of a cube's faces; each cell lists the beams that
 * may hold a direction of it, or be near it. For beams farther away there are coarser cells.
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
  /// @param directions of the beams, finite and not zero @param halfBeamwidth rad @param margins
  /// rad, rising, how far outside a cone forEachNear() finds its beam; coarser cells for each
  BeamDirections(const std::vector<Vec3>& directions, double halfBeamwidth,
    const std::vector<double>& margins = { 0.0 });

  /// f(number of the beam, cosine of the angle from its axis) for each beam whose cone, wider by
  /// `reach`, holds a direction, and maybe some more, in the order of their numbers.
  /// @param direction unit vector @param reach rad, at most the largest margin
  template <class F>
  void forEachNear(const Vec3& direction, double reach, F f) const
  {
    std::size_t level = 0;
    while (level + 1 < this->Grids.size() && reach > this->Grids[level].margin)
    {
      ++level;
    }
    const Grid& grid = this->Grids[level];
    const std::size_t cell = cellOf(direction, grid.side);
    for (std::uint32_t k = grid.begins[cell]; k < grid.begins[cell + 1]; ++k)
    {
      const std::uint32_t beam = grid.beams[k];
      f(beam, glm::dot(this->Axes[beam], direction));
    }
  }

  /// Cells of the least margin, and the one of a direction: directions of one cell are near the
  /// same beams.
  std::size_t cells() const { return this->Grids[0].begins.size() - 1; }
  std::size_t cellOf(const Vec3& direction) const { return cellOf(direction, this->Grids[0].side); }

  /// f(number of the beam) for the beams that directions of a cell are near.
  template <class F>
  void forEachOfCell(std::size_t cell, F f) const
  {
    const Grid& grid = this->Grids[0];
    std::for_each(
      grid.beams.begin() + grid.begins[cell], grid.beams.begin() + grid.begins[cell + 1], f);
  }

  /// The most beams within the least margin of a direction.
  std::size_t mostNear() const { return this->Most; }

  double leastMargin() const { return this->Grids[0].margin; }       ///< rad
  double largestMargin() const { return this->Grids.back().margin; } ///< rad

  const Vec3& axis(std::uint32_t beam) const { return this->Axes[beam]; } ///< unit vector

private:
  struct Grid
  {
    double margin;                     ///< rad
    std::size_t side;                  ///< cells along an edge of the cube
    std::vector<std::uint32_t> begins; ///< of the cells' beams
    std::vector<std::uint32_t> beams;
  };
  static std::size_t cellOf(const Vec3& direction, std::size_t side);
  void fill(Grid& grid, double halfBeamwidth) const;

  std::size_t Most = 0;
  std::vector<Vec3> Axes;
  std::vector<Grid> Grids; ///< by rising margin
};
}

#endif
