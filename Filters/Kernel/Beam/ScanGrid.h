// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanGrid.h
 * @brief The grid that the beams of a scan form: columns by azimuth, rows by elevation.
 *
 * Three cases are tried in this order:
 * 1. The angles take few distinct values. Columns and rows are these values, sorted. Case 1 holds
 *    for a full scan, a sector, a piece of a scan or sector, and a table of unequal elevations. A
 *    sector across north is not divided.
 * 2. The angles take many values (the sensor is tilted), but the channel of every beam is known,
 *    and every channel has the same number of beams. Rows are channels, sorted by mean elevation.
 *    The column of a beam is its number among the beams of its channel, in the given order. With
 *    rotating prisms, rows are lasers and columns are firings. Such a grid does not show a picture
 *    of the scene.
 * 3. In all other cases the beams form no grid.
 *
 * Source: none.
 * Valid: angles that differ by less than GridTolerance share a column or row.
 * Test: TestScanGrid.cxx.
 */
#ifndef avianlidar_ScanGrid_h
#define avianlidar_ScanGrid_h

#include <vector>

namespace avianlidar
{
/// Difference, deg, below which two angles share a column or row. The value is far below any
/// sensor's step and above the rounding of a float.
constexpr double GridTolerance = 1e-4;

struct ScanGrid
{
  std::vector<double> azimuths;   ///< azimuth of each column (case 2: in the lowest row), deg
  std::vector<double> elevations; ///< elevation of each row, deg, ascending; mean in case 2
  std::vector<int> column;        ///< column of each beam
  std::vector<int> row;           ///< row of each beam
  bool byChannel = false;         ///< true in case 2

  bool empty() const { return this->azimuths.empty(); }
};

/// Grid of beams. The result is empty if the beams form no grid. @param azimuths azimuths, deg,
/// also below 0 or above 360 @param elevations elevations, deg @param channels channels, or empty
/// @param byChannel true if channels have their own azimuths, so that only case 2 applies
ScanGrid makeScanGrid(const std::vector<double>& azimuths, const std::vector<double>& elevations,
  const std::vector<int>& channels, bool byChannel = false);

/// Set `origin` to the first of some values, and `spacing` to their spacing (1 for a single value).
/// @return true if the values are equally spaced to 1e-3 of the spacing
bool equallySpaced(const std::vector<double>& values, double& origin, double& spacing);
}

#endif
