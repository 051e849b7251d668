// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarSurfaceLeaf.h
 * @brief Collects the vtkPolyData of a scene, triangulates them and checks their arrays. Not
 * installed.
 */
#ifndef vtkAvianLidarSurfaceLeaf_h
#define vtkAvianLidarSurfaceLeaf_h

#include "Reflectance.h"

#include "vtkDataArray.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

class vtkDataObject;
class vtkFieldData;
class vtkPolyData;

/// The cell arrays of a leaf; null for missing arrays.
struct vtkAvianLidarSurfaceArrays
{
  vtkDataArray* object = nullptr;
  vtkDataArray* material = nullptr;
  vtkDataArray* coefficients[std::size(avianlidar::MaterialCoefficients)] = {};
  vtkUnsignedCharArray* ghosts = nullptr;
  const char* notNumeric = nullptr; ///< name of an array without numbers; null: no such array

  vtkAvianLidarSurfaceArrays() = default;
  explicit vtkAvianLidarSurfaceArrays(vtkPolyData* poly);

  /// True if there are coefficients. To be called if Check() found no error.
  bool HasMaterials() const { return this->coefficients[0] != nullptr; }

  bool IsGhost(vtkIdType cell) const { return this->ghosts && this->ghosts->GetValue(cell); }

  /// All arrays except `ghosts`.
  std::vector<vtkDataArray*> Numbers() const;
};

struct vtkAvianLidarSurfaceLeaf
{
  vtkPolyData* data = nullptr;
  std::string name;       ///< name of the block; empty for a vtkPolyData that is the whole scene
  unsigned int index = 0; ///< flat index of the block; 0 for a vtkPolyData that is the whole scene
  bool named = false;     ///< true if the composite has the name; else `name` contains a number

  /// The name of a block that has no name in the composite. @param number number of the leaf
  static std::string NameOfBlock(std::size_t number) { return "block " + std::to_string(number); }

  /// The vtkPolyData of a scene in leaf order. If data of other types were found, `problem` becomes
  /// an error text.
  static std::vector<vtkAvianLidarSurfaceLeaf> Collect(vtkDataObject* input, std::string& problem);

  /// Hash of the names of objects and materials, and of the classes of objects. @param seed hash to
  /// continue
  static std::uint64_t HashOfNames(vtkFieldData* fields, std::uint64_t seed);

  /// Hash of everything that vtkAvianLidarSurfaces::Merge() reads of a vtkPolyData.
  static std::uint64_t HashOf(vtkPolyData* poly);

  /// The error text "surfaces, block 'name': what".
  std::string Message(const std::string& what) const;

  /// An error text if the cells or their arrays are bad, else an empty string.
  std::string Check(const vtkAvianLidarSurfaceArrays& arrays) const;

  /// A warning if points in single precision lie so far from the origin that neighbouring numbers
  /// are 4 mm apart or more; else an empty string.
  std::string WarningOnPoints() const;

  /// True if all cells are triangles.
  bool IsTriangulated() const;

  /// Approximate number of triangles in the polygons and strips.
  std::size_t NumberOfTriangles() const;

  /// The polygons and strips as triangles. Vertices, lines, and polygons and strips of fewer than
  /// three points are dropped. Returns `data` itself if all cells are triangles.
  /// @param warning becomes the warning of vtkAvianLidarTriangles() with the place, or empty
  vtkSmartPointer<vtkPolyData> Triangulated(std::string& warning) const;
};

/// An array of numbers of any type. Doubles and ints are read without a virtual call per value.
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

/// The materials of the cells of a leaf with material arrays.
class vtkAvianLidarMaterialColumns
{
public:
  explicit vtkAvianLidarMaterialColumns(const vtkAvianLidarSurfaceArrays& arrays);
  /// Write the material of a cell into `material`. A return by value would double the time of loops
  /// over cells. A coefficient without an array does not change.
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
