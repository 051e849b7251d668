// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamDirections.h
 * @brief Finds the beams of a scan whose cones contain a direction.
 *
 * The faces of a cube are divided into cells. Each cell lists the beams whose cones, widened by a
 * margin, may contain a direction of the cell. A larger margin has coarser cells.
 *
 * Source: none.
 * Valid: any directions; half-beamwidth plus margin up to pi/3 rad. On a cone's border, rounding
 * decides whether the cone contains a direction.
 * Test: TestBeamDirections.cxx (against all beams one by one).
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
  /// @param directions directions of the beams, finite and not zero @param halfBeamwidth
  /// half-beamwidth of all beams, rad
  /// @param margins angles outside a cone up to which forEachNear() finds the cone's beam,
  /// ascending, rad
  BeamDirections(const std::vector<Vec3>& directions, double halfBeamwidth,
    const std::vector<double>& margins = { 0.0 });

  /// Calls f(beam, cosine), in the order of the beams, for each beam whose cone, widened by
  /// `reach`, contains a direction. `cosine` is the cosine of the angle between the direction and
  /// the beam's axis. f may also be called for other beams.
  /// @param direction unit vector @param reach angle, rad, at most the largest margin
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

  /// Number of cells at the least margin, and the cell that contains a direction.
  std::size_t cells() const { return this->Grids[0].begins.size() - 1; }
  std::size_t cellOf(const Vec3& direction) const { return cellOf(direction, this->Grids[0].side); }

  /// Calls f(number of the beam) for the beams near the directions of a cell.
  template <class F>
  void forEachOfCell(std::size_t cell, F f) const
  {
    const Grid& grid = this->Grids[0];
    std::for_each(
      grid.beams.begin() + grid.begins[cell], grid.beams.begin() + grid.begins[cell + 1], f);
  }

  /// Upper bound of the number of beams whose cones, widened by the least margin, contain the same
  /// direction.
  std::size_t mostNear() const { return this->Most; }

  double leastMargin() const { return this->Grids[0].margin; }       ///< least margin, rad
  double largestMargin() const { return this->Grids.back().margin; } ///< largest margin, rad

  /// Axis of a beam, unit vector.
  const Vec3& axis(std::uint32_t beam) const { return this->Axes[beam]; }

private:
  struct Grid
  {
    double margin;                     ///< margin of the cones, rad
    std::size_t side;                  ///< number of cells along an edge of the cube
    std::vector<std::uint32_t> begins; ///< first index of each cell in `beams`
    std::vector<std::uint32_t> beams;
  };
  static std::size_t cellOf(const Vec3& direction, std::size_t side);
  void fill(Grid& grid, double halfBeamwidth) const;

  std::size_t Most = 0;
  std::vector<Vec3> Axes;
  std::vector<Grid> Grids; ///< grids by rising margin
};
}

#endif
