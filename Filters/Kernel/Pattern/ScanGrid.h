// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanGrid.h
 * @brief The grid that the beams of a scan form: columns by azimuth, rows by elevation.
 *
 * Three cases, in this order:
 * 1. The angles take few distinct values. Columns and rows are these values, sorted. This is the
 *    case for a full scan, a sector, a piece of either and a table of unequal elevations. A sector
 *    across north stays in one piece.
 * 2. The angles take many values (the sensor is tilted), but every channel is known and has the
 *    same number of beams. Rows are channels, sorted by mean elevation. Columns count the beams of
 *    a channel in the given order. With rotating prisms, each laser has a row and each of its
 *    firings a column, which gives no picture.
 * 3. Otherwise there is no grid.
 *
 * Source: none.
 * Valid: angles that differ by less than GridTolerance are one column or row.
 * Test: TestScanGrid.cxx.
 */
#ifndef avianlidar_ScanGrid_h
#define avianlidar_ScanGrid_h

#include <vector>

namespace avianlidar
{
/// Difference of angles, deg, below which they share a column or row. It is far below any sensor's
/// step and above the rounding of a float.
constexpr double GridTolerance = 1e-4;

struct ScanGrid
{
  std::vector<double> azimuths;   ///< deg, one per column; in case 2 from the lowest row
  std::vector<double> elevations; ///< deg, one per row, ascending; in case 2 means
  std::vector<int> column;        ///< column of each beam
  std::vector<int> row;           ///< row of each beam
  bool byChannel = false;         ///< case 2

  bool empty() const { return this->azimuths.empty(); }
};

/// Grid of beams with these angles (deg, azimuths of any turn) and, if given, channels. Empty if
/// there is no grid. @param byChannel channels have their own azimuths; only case 2 applies
ScanGrid makeScanGrid(const std::vector<double>& azimuths, const std::vector<double>& elevations,
  const std::vector<int>& channels, bool byChannel = false);

/// True if the values are equally spaced to 1e-3 of their spacing; sets the first value and the
/// spacing. The spacing of a single value is 1.
bool equallySpaced(const std::vector<double>& values, double& origin, double& spacing);
}

#endif
