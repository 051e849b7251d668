// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarSurfaceLeaf.h
 * @brief One vtkPolyData of a scene: found, triangulated, its arrays checked. Not installed.
 */
#ifndef vtkAvianLidarSurfaceLeaf_h
#define vtkAvianLidarSurfaceLeaf_h

#include "Reflectance.h"

#include "vtkDataArray.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"

#include <cstddef>
#include <iterator>
#include <string>
#include <vector>

class vtkDataObject;
class vtkPolyData;

/// The cell arrays of a leaf; null where it has none.
struct vtkAvianLidarSurfaceArrays
{
  vtkDataArray* object = nullptr;
  vtkDataArray* material = nullptr;
  vtkDataArray* coefficients[std::size(avianlidar::MaterialCoefficients)] = {};
  vtkUnsignedCharArray* ghosts = nullptr;
  const char* notNumeric = nullptr; ///< name of one that holds no numbers

  vtkAvianLidarSurfaceArrays() = default;
  explicit vtkAvianLidarSurfaceArrays(vtkPolyData* poly);

  /// True if there are coefficients, given that Check() finds nothing wrong.
  bool HasMaterials() const { return this->coefficients[0] != nullptr; }

  bool IsGhost(vtkIdType cell) const { return this->ghosts && this->ghosts->GetValue(cell); }

  /// All but ghosts.
  std::vector<vtkDataArray*> Numbers() const;
};

struct vtkAvianLidarSurfaceLeaf
{
  vtkPolyData* data = nullptr;
  std::string name;       ///< name of the block; empty for a vtkPolyData that is the whole scene
  unsigned int index = 0; ///< flat index of the block; 0 for a vtkPolyData that is the whole scene
  bool named = false;     ///< by the composite; else by its number

  /// The name of a block without one. @param number among the leaves
  static std::string NameOfBlock(std::size_t number) { return "block " + std::to_string(number); }

  /// The vtkPolyData of a scene in leaf order; `problem` says what else was found.
  static std::vector<vtkAvianLidarSurfaceLeaf> Collect(vtkDataObject* input, std::string& problem);

  /// "surfaces, block 'name': what"
  std::string Message(const std::string& what) const;

  /// What is wrong with its cells or their arrays; empty if nothing is.
  std::string Check(const vtkAvianLidarSurfaceArrays& arrays) const;

  /// Empty, or what is suspicious: points in single precision so far from the origin that
  /// neighbours are 4 mm apart or more.
  std::string WarningOnPoints() const;

  /// True if it has no cells but triangles.
  bool IsTriangulated() const;

  /// About how many triangles its polygons and strips are.
  std::size_t NumberOfTriangles() const;

  /// Its polygons and strips as triangles; vertices and lines are dropped, and so are polygons and
  /// strips of fewer than three points. Its own data if it is triangulated.
  vtkSmartPointer<vtkPolyData> Triangulated() const;
};

/// An array of numbers of any type; those of doubles and ints are read without a call for each.
class vtkAvianLidarColumn
{
public:
  explicit vtkAvianLidarColumn(vtkDataArray* array = nullptr);
  explicit operator bool() const { return this->Any != nullptr; }
  double operator[](vtkIdType i) const
  {
    return this->Doubles ? this->Doubles[i]
      : this->Ints       ? this->Ints[i]
                         : this->Any->GetComponent(i, 0);
  }

private:
  vtkDataArray* Any;
  const double* Doubles;
  const int* Ints;
};

/// The materials of the cells of a leaf that has some.
class vtkAvianLidarMaterialColumns
{
public:
  explicit vtkAvianLidarMaterialColumns(const vtkAvianLidarSurfaceArrays& arrays);
  /// In place: with materials returned by value, loops over cells take twice as long. A coefficient
  /// without an array stays as it is.
  void Read(vtkIdType cell, avianlidar::Material& material) const
  {
    for (std::size_t k = 0; k < std::size(this->Columns); ++k)
    {
      if (this->Columns[k])
      {
        material.*avianlidar::MaterialCoefficients[k].member = this->Columns[k][cell];
      }
    }
  }

private:
  vtkAvianLidarColumn Columns[std::size(avianlidar::MaterialCoefficients)];
};

#endif
