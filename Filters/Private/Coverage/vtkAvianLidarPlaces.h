// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarPlaces.h
 * @brief Holds the places for which coverage is evaluated (points of a data set or of an image),
 * and the regions in which the places lie. Not installed.
 */
#ifndef vtkAvianLidarPlaces_h
#define vtkAvianLidarPlaces_h

#include "Vector.h"
#include "vtkAvianLidarRanks.h"

#include "vtkSmartPointer.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

class vtkDataSet;
class vtkInformation;
class vtkUnsignedCharArray;

class vtkAvianLidarPlaces
{
public:
  vtkAvianLidarPlaces() = default; ///< empty set of places

  /// Number of points of a data set. VTK's own number overflows for large structured data sets.
  static double CountOf(vtkDataSet* points);

  /// Take the points of a data set. Throws std::runtime_error if the data set is bad.
  explicit vtkAvianLidarPlaces(vtkDataSet* points);

  /// An error text if a region or the spacing of its points is bad, else an empty string. The
  /// points fill the region from its lower corner. @param bounds bounds of the region, m @param
  /// spacing distances between neighbouring points along the axes, m
  static std::string CheckRegion(const double bounds[6], const double spacing[3]);

  /// Extent of the image whose points fill a region, as for CheckRegion().
  static void ExtentOf(const double bounds[6], const double spacing[3], int extent[6]);

  /// Take the points of an image.
  vtkAvianLidarPlaces(const int extent[6], const double origin[3], const double spacing[3]);

  /// Set the part of structured points that belongs to the requested piece, without ghosts. A
  /// single piece has the whole extent. @param info information of the output
  void SetMine(vtkInformation* info);

  std::size_t Size() const;
  avianlidar::Vec3 At(std::size_t k) const;

  /// False for ghosts and for points of other pieces. Points where two structured pieces meet
  /// belong to the second piece.
  bool IsMine(std::size_t k) const;

  /// Hash of all coordinates.
  std::uint64_t Hash() const;

  const std::vector<std::string>& RegionNames() const { return this->Names; }
  std::size_t RegionOf(std::size_t k) const { return this->Regions.empty() ? 0 : this->Regions[k]; }

  /// Number the regions in the same way on all ranks.
  void ShareRegions(const vtkAvianLidarRanks& ranks);

  vtkDataSet* GetPoints() const { return this->Points; } ///< points; null for an image
  const int* GetExtent() const { return this->Extent; }
  const double* GetOrigin() const { return this->Origin; }
  const double* GetSpacing() const { return this->Spacing; }

private:
  std::array<int, 3> IndexOf(std::size_t k) const;
  int Dimension(int axis) const { return this->Extent[2 * axis + 1] - this->Extent[2 * axis] + 1; }
  void ReadRegions();

  vtkSmartPointer<vtkDataSet> Points;
  vtkSmartPointer<vtkUnsignedCharArray> Ghosts; ///< ghost flags; null: no ghosts
  int Extent[6] = { 0, -1, 0, -1, 0, -1 };
  int Mine[6] = { 0, -1, 0, -1, 0,
    -1 }; ///< extent of this rank's points, without points that the next piece has, too
  bool HasMine = false;
  double Origin[3] = { 0.0, 0.0, 0.0 };
  double Spacing[3] = { 1.0, 1.0, 1.0 };
  std::vector<std::string> Names = { "all" };
  std::vector<std::size_t> Regions; ///< region of each place; empty: one region
};

#endif
