// SPDX-License-Identifier: BSD-3-Clause
#include "BeamDirections.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace avianlidar
{
namespace
{
/// Largest number of cells along an edge of the cube (25 MB).
constexpr double MostCells = 1024.0;

/// The face of the cube that a direction meets, and the coordinates there, -1 to 1.
struct OnCube
{
  int face;
  double u, v;
};

OnCube onCube(const Vec3& d)
{
  const double x = std::fabs(d.x);
  const double y = std::fabs(d.y);
  const double z = std::fabs(d.z);
  if (x >= y && x >= z)
  {
    return { d.x < 0.0 ? 1 : 0, d.y / x, d.z / x };
  }
  return y >= z ? OnCube{ d.y < 0.0 ? 3 : 2, d.x / y, d.z / y }
                : OnCube{ d.z < 0.0 ? 5 : 4, d.x / z, d.y / z };
}

/// Direction of a point on a face, not normalised.
Vec3 fromCube(int face, double u, double v)
{
  const double sign = face % 2 == 0 ? 1.0 : -1.0;
  return face < 2 ? Vec3(sign, u, v) : (face < 4 ? Vec3(u, sign, v) : Vec3(u, v, sign));
}

std::size_t placeOf(double u, std::size_t side)
{
  const double place = 0.5 * (u + 1.0) * static_cast<double>(side);
  return std::min(side - 1, static_cast<std::size_t>(std::max(0.0, place)));
}

/// Calls f(cell) for each cell that a cone may meet. @param side cells along an edge of the cube
template <class F>
void forEachCell(std::size_t side, const Vec3& axis, double halfBeamwidth, F f)
{
  const double size = 2.0 / static_cast<double>(side);
  // Bound of the angle between a cell's middle and its points: on a face, angles are smaller than
  // distances.
  const double cell = 0.5 * size * std::sqrt(2.0);
  for (int face = 0; face < 6; ++face)
  {
    const Vec3 normal = fromCube(face, 0.0, 0.0);
    const double along = glm::dot(axis, normal);
    const double angle = std::acos(std::clamp(along, -1.0, 1.0));
    // A face reaches 54.8 degrees away from its middle.
    if (angle > 0.9555 + halfBeamwidth + cell)
    {
      continue;
    }
    // The cone meets the face within a square about the axis, unless the face is too oblique.
    std::size_t range[4] = { 0, side - 1, 0, side - 1 };
    const double reach = angle + halfBeamwidth;
    if (reach < 1.4)
    {
      const Vec3 onFace = axis / along;
      const double radius = std::tan(reach) - std::tan(angle) + cell;
      const double wide = std::max(radius, std::tan(halfBeamwidth) / std::cos(reach) + cell);
      const double u = face < 2 ? onFace.y : onFace.x;
      const double v = face < 4 ? onFace.z : onFace.y;
      if (u - wide > 1.0 || u + wide < -1.0 || v - wide > 1.0 || v + wide < -1.0)
      {
        continue;
      }
      range[0] = placeOf(u - wide, side);
      range[1] = placeOf(u + wide, side);
      range[2] = placeOf(v - wide, side);
      range[3] = placeOf(v + wide, side);
    }
    const double least = std::cos(std::min(Pi, halfBeamwidth + cell));
    for (std::size_t j = range[2]; j <= range[3]; ++j)
    {
      for (std::size_t i = range[0]; i <= range[1]; ++i)
      {
        const Vec3 middle = fromCube(face, (static_cast<double>(i) + 0.5) * size - 1.0,
          (static_cast<double>(j) + 0.5) * size - 1.0);
        if (glm::dot(middle, axis) >= least * glm::length(middle))
        {
          f((static_cast<std::size_t>(face) * side + j) * side + i);
        }
      }
    }
  }
}
}

BeamDirections::BeamDirections(
  const std::vector<Vec3>& directions, double halfBeamwidth, const std::vector<double>& margins)
{
  this->Axes.reserve(directions.size());
  for (const Vec3& direction : directions)
  {
    this->Axes.push_back(unitVector(direction));
  }
  for (const double margin : margins)
  {
    const double size = margins.size() > 1 ? std::max(halfBeamwidth, margin) : halfBeamwidth;
    const auto side = static_cast<std::size_t>(std::clamp(2.0 / size, 4.0, MostCells));
    this->fill(this->Grids.emplace_back(Grid{ margin, side, {}, {} }), halfBeamwidth);
  }
  const std::vector<std::uint32_t>& begins = this->Grids[0].begins;
  for (std::size_t cell = 1; cell < begins.size(); ++cell)
  {
    this->Most = std::max<std::size_t>(this->Most, begins[cell] - begins[cell - 1]);
  }
}

void BeamDirections::fill(Grid& grid, double halfBeamwidth) const
{
  grid.begins.assign(6 * grid.side * grid.side + 1, 0);
  std::vector<std::pair<std::size_t, std::uint32_t>> pairs; // cell and beam
  for (std::uint32_t beam = 0; beam < this->Axes.size(); ++beam)
  {
    forEachCell(grid.side, this->Axes[beam], halfBeamwidth + grid.margin,
      [&](std::size_t cell)
      {
        ++grid.begins[cell + 1];
        pairs.emplace_back(cell, beam);
      });
  }
  std::partial_sum(grid.begins.begin(), grid.begins.end(), grid.begins.begin());
  grid.beams.resize(pairs.size());
  std::vector<std::uint32_t> next(grid.begins.begin(), grid.begins.end() - 1);
  for (const auto& [cell, beam] : pairs)
  {
    grid.beams[next[cell]++] = beam;
  }
}

std::size_t BeamDirections::cellOf(const Vec3& direction, std::size_t side)
{
  const OnCube at = onCube(direction);
  return (static_cast<std::size_t>(at.face) * side + placeOf(at.v, side)) * side +
    placeOf(at.u, side);
}
}
