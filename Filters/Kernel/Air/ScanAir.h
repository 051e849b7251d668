// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanAir.h
 * @brief The air of a scan, prepared for a sensor: the light that media which fill the scene return
 * in each range unit, and the columns into which a beam is divided.
 *
 * From the range R1 to R2 a medium returns E mu/S times the integral over R of O(R) min(A/R^2, 2
 * pi) exp(-depth(R)). E is the pulse energy, mu/S the backscatter (Air.h), A the aperture, O
 * Sensor::nearRangeShare(), and depth the optical depth of all air on the way to R and back.
 *
 * Columns are the cells of a grid of eight by eight over the beam's plane.
 *
 * Source: the lidar equation, single scattering, e.g. U. Wandinger, in: Lidar, Springer, 2005.
 * Differs: the paper's air sends nothing back.
 * Valid: the table of energies ends at a million units. Mean energies hold for a short pulse.
 * Test: TestAir.cxx.
 */
#ifndef avianlidar_ScanAir_h
#define avianlidar_ScanAir_h

#include "Air.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// A part of a beam that has one direction.
struct AirColumn
{
  double x, y;        ///< direction, as a point of the beam's plane
  double weight;      ///< share of the pulse
  std::uint64_t bits; ///< cells of the grid, one bit per cell
  // The point of the aperture to which light returns. Points of neighbouring columns lie far apart.
  std::array<double, 2> towards{}; ///< unit vector from the aperture's middle to this point
  double nearer = 0.0;             ///< share of the aperture nearer to the middle than this point
  std::size_t firstPart = 0;
  std::size_t lastPart = 0; ///< one past the last part

  /// Number of cells across the beam, along each axis.
  static constexpr int Across = 8;
  /// Bit of the cell that holds a point of the beam's plane.
  static std::uint64_t at(double x, double y)
  {
    const auto cell = [](double v)
    { return std::clamp(static_cast<int>(0.5 * Across * (v + 1.0)), 0, Across - 1); };
    return std::uint64_t{ 1 } << (Across * cell(y) + cell(x));
  }

  /// Bits of the cells that a square about (x, y) meets. @param half half the side of the square
  static std::uint64_t in(double x, double y, double half)
  {
    constexpr double step = 2.0 / Across;
    std::uint64_t columns = 0;
    for (double v = y - half; v < y + half + step; v += step)
    {
      for (double u = x - half; u < x + half + step; u += step)
      {
        columns |= at(std::min(u, x + half), std::min(v, y + half));
      }
    }
    return columns;
  }
};

/// The air of a scan. The object does not change, so threads share it.
class ScanAir
{
public:
  ScanAir(const Sensor& sensor, Air air);

  const Sensor& sensor() const { return this->Instrument; }
  const std::vector<PlacedMedium>& media() const { return this->All.media; }
  const Medium& mediumAt(std::uint32_t number) const { return this->All.media[number].medium; }

  /// Numbers of the media that fill the scene and return light, and their backscatter, 1/(m sr).
  const std::vector<std::uint32_t>& filling() const { return this->Filling; }
  double backscatter() const { return this->Backscatter; }
  /// Attenuation coefficient of all air that fills the scene, 1/m.
  double attenuation() const { return this->Attenuation; }

  /// Energy, J, that media which fill the scene return in each unit, from unit 0 on; empty if they
  /// return no light.
  const std::vector<double>& means() const { return this->Means; }
  /// True if media that fill the scene return light.
  bool fillsScene() const { return !this->Means.empty(); }
  /// Number of units, from unit 0 on, in which media that fill the scene return light.
  std::int64_t units() const { return static_cast<std::int64_t>(this->Means.size()); }

  double unitLength() const { return this->UnitLength; } ///< length of a range unit, m
  double solidAngle() const { return this->SolidAngle; } ///< solid angle of a beam, sr
  std::int64_t gateUnits() const { return this->Gate; }  ///< number of units inside the gate
  /// Number of units that the pulse of a drop reaches on each side of its own unit.
  std::int64_t reach() const { return this->Reach; }
  /// Half widths of a beam at a range of 1 m, and radius of the aperture, m.
  std::array<double, 2> halfWidths() const { return this->HalfWidths; }
  double apertureRadius() const { return this->ApertureRadius; }

  /// Cells of the grid that lie in a beam; empty if no medium has a volume.
  const std::vector<AirColumn>& grid() const { return this->Grid; }
  /// A beam that is not divided: one column.
  const std::vector<AirColumn>& whole() const { return this->Whole; }

  /// Solid angle, sr, at most 2 pi, in which the aperture appears from a range, m.
  double collected(double range) const;
  /// The same times the near range share.
  double gathered(double range) const;

  static constexpr double MostUnits = 1e6; ///< largest number of units in the table

private:
  void makeMeans();
  void makeGrid();

  Sensor Instrument;
  Air All;
  double Attenuation;
  double UnitLength;
  double SolidAngle;
  std::int64_t Gate;
  std::int64_t Reach;
  std::array<double, 2> HalfWidths{};
  double ApertureRadius;
  std::vector<std::uint32_t> Filling;
  double Backscatter = 0.0;
  std::vector<double> Means;
  std::vector<AirColumn> Grid;
  const std::vector<AirColumn> Whole{ { 0.0, 0.0, 1.0, ~std::uint64_t{ 0 } } };
};
}

#endif
