// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ClutterMap.h
 * @brief Map of the cells in which a fixed sensor has repeated echoes: persistence by azimuth,
 * elevation and range.
 *
 * With W the window and n the number of scans learned, each scan has q = 1 - 1/W times the weight
 * of the next scan. The persistence of a cell is the sum of the weights of scans with an echo in
 * the cell, divided by the sum of all n weights, W (1 - q^n). Cells with a persistence below
 * persistenceKept() are removed.
 *
 * The map is a sorted list of cells. A new scan is sorted and merged with the list. To find
 * probabilities, a sorted scan is compared with the list once for each row of neighbours. Learning
 * a scan and finding probabilities each take about p log p + m steps for p points and m cells.
 *
 * Source: background subtraction by the share of scans, as in Examples/sequence. The exponential
 * window is added.
 * Valid: finite points. The order of the points changes no bit of the result. Neighbours wrap
 * around at azimuths of +-180 degrees, but not across the zenith.
 * Test: TestClutterMap.cxx; TestClutterFilter.py (NumPy, point by point).
 */
#ifndef avianlidar_ClutterMap_h
#define avianlidar_ClutterMap_h

#include "Vector.h"

#include <cstdint>
#include <string>
#include <vector>

namespace avianlidar
{
/// Cells about the sensor. Angles are rounded to the nearest multiple of their step. Ranges are
/// rounded down.
struct ClutterGrid
{
  double rangeStep = 1.5;     ///< length of a cell along the range, m, 0.001 to 1000
  double azimuthStep = 0.375; ///< width of a cell, degrees, 0.001 to 90; rounded to fit the circle
  double elevationStep = 0.375; ///< height of a cell, degrees, 0.001 to 90

  int columns() const; ///< number of cells of the whole circle
};

struct ClutterCell
{
  int azimuth = 0;   ///< number of the azimuth, 0 to columns() - 1, clockwise from y
  int elevation = 0; ///< number of the elevation; 0 is the horizon
  int range = 0;
};

class ClutterMap
{
public:
  /// Number of a cell. The list of cells is sorted by this number.
  using Key = std::uint64_t;

  static constexpr double LongestWindow = 100000.0;
  static constexpr int MostTolerance = 10;
  /// Number of cells along the range. The last cell holds all larger ranges.
  static constexpr int MostRanges = (1 << 26) - 2 * MostTolerance - 1;

  /// @param window W, in scans, 1 to LongestWindow
  explicit ClutterMap(const ClutterGrid& grid = {}, double window = 200.0);

  /// Returns what is wrong with a grid or a window, or an empty string.
  static std::string check(const ClutterGrid& grid, double window);

  /// Number of the cell of a point. @param offset position relative to the sensor, m
  static Key keyOf(const ClutterGrid& grid, const Vec3& offset);
  static Key keyOf(const ClutterCell& cell);
  static ClutterCell cellOf(Key key);
  /// True if the grid has this cell.
  static bool holds(const ClutterGrid& grid, const ClutterCell& cell);
  /// The middles of all cells relative to the sensor, m, in the order of keys().
  std::vector<Vec3> middles() const;

  /// The map after one more scan. @param points keys of the scan's points, in any order
  ClutterMap learned(std::vector<Key> points) const;

  /// A map with the given cells. @param scans number of scans learned
  ClutterMap restored(
    const std::vector<Key>& cells, const std::vector<double>& persistences, int scans) const;

  /// The largest persistence of the cells around each point.
  /// @param rangeTolerance, angularTolerance number of cells to each side, 0 to MostTolerance
  std::vector<double> probabilities(
    const std::vector<Key>& points, int rangeTolerance, int angularTolerance) const;

  const std::vector<Key>& keys() const { return this->Keys; } ///< keys of all cells, increasing
  double persistence(std::size_t index) const { return this->shareOf(this->Sums[index]); }
  int scans() const { return this->Scans; }
  const ClutterGrid& grid() const { return this->Grid; }

  /// Persistence below which cells are removed: 0.5/W, but at most 0.001.
  double persistenceKept() const;

private:
  void setScans(int scans);
  double shareOf(double sum) const;

  ClutterGrid Grid;
  double Window;
  int Scans = 0;
  double Total = 0.0; ///< sum of the weights of all scans
  std::vector<Key> Keys;
  std::vector<double> Sums; ///< sum of the weights of scans with an echo, by cell
};
}

#endif
