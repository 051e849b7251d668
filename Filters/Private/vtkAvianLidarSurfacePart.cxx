// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSurfacePart.h"

#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarBytes.h"
#include "vtkAvianLidarCells.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkPoints.h"
#include "vtkTypeInt32Array.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace
{
namespace names = vtkAvianLidarArrays;
using Arrays = vtkAvianLidarSurfaceArrays;
using Column = vtkAvianLidarColumn;
using Corners = std::vector<std::uint32_t>;

const names::Name IdArrays[] = { names::ObjectId, names::MaterialId };
const names::Name CoefficientArrays[] = { names::Kd, names::Ks, names::Kp };
const names::Name NameArrays[] = { names::ObjectNames, names::MaterialNames };

std::vector<std::string> NamesOf(vtkPolyData* part, const names::Name& name)
{
  auto* strings = vtkStringArray::SafeDownCast(part->GetFieldData()->GetAbstractArray(name.name));
  std::vector<std::string> values;
  for (vtkIdType i = 0; strings && i < strings->GetNumberOfValues(); ++i)
  {
    values.push_back(strings->GetValue(i));
  }
  return values;
}

bool IsLean(vtkPolyData* poly)
{
  const bool triangles = poly->GetNumberOfStrips() == 0 && poly->GetNumberOfVerts() == 0 &&
    poly->GetNumberOfLines() == 0 && poly->GetNumberOfPolys() > 0 &&
    poly->GetPolys()->IsHomogeneous() == 3;
  return triangles && !Arrays(poly).ghosts;
}

template <class ArrayT>
vtkSmartPointer<vtkCellArray> CellsOf(const Corners& corners)
{
  const auto triangles = static_cast<vtkIdType>(corners.size() / 3);
  vtkNew<ArrayT> offsets;
  vtkNew<ArrayT> connectivity;
  vtkAvianLidarArrays::SetTuples(offsets.Get(), triangles + 1);
  vtkAvianLidarArrays::SetTuples(connectivity.Get(), 3 * triangles);
  std::copy(corners.begin(), corners.end(), connectivity->GetPointer(0));
  for (vtkIdType i = 0; i <= triangles; ++i)
  {
    offsets->SetValue(i, static_cast<typename ArrayT::ValueType>(3 * i));
  }
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  cells->SetData(offsets, connectivity);
  return cells;
}

void SetTriangles(vtkPolyData* part, const Corners& corners)
{
  constexpr std::size_t limit = std::numeric_limits<std::int32_t>::max();
  const auto points = static_cast<std::size_t>(part->GetNumberOfPoints());
  part->SetPolys(corners.size() < limit && points < limit ? CellsOf<vtkTypeInt32Array>(corners)
                                                          : CellsOf<vtkIdTypeArray>(corners));
}

/// Corners of the triangles of a part, each number `shift` higher.
void AddCorners(vtkPolyData* part, std::size_t shift, Corners& corners)
{
  const auto highest = shift + static_cast<std::size_t>(part->GetNumberOfPoints());
  if (highest > std::numeric_limits<std::uint32_t>::max())
  {
    throw std::length_error("A block of the surfaces has more than 4294967295 points");
  }
  vtkAvianLidarPointIds(part->GetPolys(),
    [&](const auto* ids, vtkIdType count)
    {
      std::transform(ids, ids + count, std::back_inserter(corners),
        [shift](auto id)
        { return static_cast<std::uint32_t>(shift + static_cast<std::size_t>(id)); });
    });
}

/// A cell array with the values of these cells of all parts, if they have one of that name.
template <class ArrayT>
void AddCellArray(vtkPolyData* to, const names::Name& name, const std::vector<vtkPolyData*>& parts,
  const std::vector<vtkIdType>* cells = nullptr)
{
  if (!parts[0]->GetCellData()->GetArray(name.name))
  {
    return;
  }
  auto array = names::Make<ArrayT>(name);
  for (vtkPolyData* part : parts)
  {
    const Column column(part->GetCellData()->GetArray(name.name));
    const vtkIdType count =
      cells ? static_cast<vtkIdType>(cells->size()) : part->GetNumberOfPolys();
    for (vtkIdType i = 0; i < count; ++i)
    {
      array->InsertNextValue(
        static_cast<typename ArrayT::ValueType>(column[cells ? (*cells)[i] : i]));
    }
  }
  to->GetCellData()->AddArray(array);
}

void AddCellArrays(vtkPolyData* to, const std::vector<vtkPolyData*>& parts,
  const std::vector<vtkIdType>* cells = nullptr)
{
  for (const names::Name& name : IdArrays)
  {
    AddCellArray<vtkIntArray>(to, name, parts, cells);
  }
  for (const names::Name& name : CoefficientArrays)
  {
    AddCellArray<vtkDoubleArray>(to, name, parts, cells);
  }
}

void CopyNames(vtkPolyData* from, vtkPolyData* to)
{
  for (const names::Name& name : NameArrays)
  {
    if (vtkAbstractArray* array = from->GetFieldData()->GetAbstractArray(name.name))
    {
      to->GetFieldData()->AddArray(array);
    }
  }
}

template <class ArrayT>
void WriteCellArray(vtkPolyData* part, const names::Name& name, vtkAvianLidarByteWriter& bytes)
{
  using ValueT = typename ArrayT::ValueType;
  vtkDataArray* array = part->GetCellData()->GetArray(name.name);
  bytes.Put<char>(array != nullptr);
  const Column column(array);
  for (vtkIdType i = 0; array && i < part->GetNumberOfPolys(); ++i)
  {
    bytes.Put(static_cast<ValueT>(column[i]));
  }
}

template <class ArrayT>
void ReadCellArray(
  vtkPolyData* part, const names::Name& name, vtkAvianLidarByteReader& bytes, vtkIdType count)
{
  if (bytes.Get<char>())
  {
    auto array = names::Make<ArrayT>(name, count);
    bytes.Get(array->GetPointer(0), static_cast<std::size_t>(count));
    part->GetCellData()->AddArray(array);
  }
}

template <class ArrayT>
void WriteCoordinates(vtkPolyData* part, vtkAvianLidarByteWriter& bytes)
{
  using ValueT = typename ArrayT::ValueType;
  for (vtkIdType i = 0; i < part->GetNumberOfPoints(); ++i)
  {
    double p[3];
    part->GetPoint(i, p);
    const ValueT values[3] = { static_cast<ValueT>(p[0]), static_cast<ValueT>(p[1]),
      static_cast<ValueT>(p[2]) };
    bytes.Put(values, 3);
  }
}

template <class ArrayT>
vtkSmartPointer<vtkPoints> ReadPoints(vtkAvianLidarByteReader& bytes, vtkIdType count)
{
  vtkNew<ArrayT> coordinates;
  coordinates->SetNumberOfComponents(3);
  vtkAvianLidarArrays::SetTuples(coordinates.Get(), count);
  bytes.Get(coordinates->GetPointer(0), 3 * static_cast<std::size_t>(count));
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetData(coordinates);
  return points;
}

bool HasFloatPoints(vtkPolyData* part)
{
  return part->GetPoints() && part->GetPoints()->GetDataType() == VTK_FLOAT;
}
}

namespace vtkAvianLidarSurfacePart
{
//------------------------------------------------------------------------------
bool HasTriangles(const vtkAvianLidarSurfaceLeaf& leaf)
{
  const vtkIdType cells = leaf.data->GetNumberOfPolys() + leaf.data->GetNumberOfStrips();
  vtkUnsignedCharArray* ghosts = Arrays(leaf.data).ghosts;
  bool all = ghosts != nullptr;
  for (vtkIdType i = 0; all && i < ghosts->GetNumberOfValues(); ++i)
  {
    all = ghosts->GetValue(i) != 0;
  }
  return cells > 0 && !all;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> Lean(const vtkAvianLidarSurfaceLeaf& leaf)
{
  if (IsLean(leaf.data))
  {
    return leaf.data;
  }
  auto lean = vtkSmartPointer<vtkPolyData>::New();
  CopyNames(leaf.data, lean);
  if (!HasTriangles(leaf))
  {
    return lean;
  }
  const vtkSmartPointer<vtkPolyData> poly = leaf.Triangulated();
  vtkUnsignedCharArray* ghosts = Arrays(poly).ghosts;
  Corners all;
  Corners corners;
  AddCorners(poly, 0, all);
  std::vector<vtkIdType> cells;
  for (vtkIdType i = 0; i < poly->GetNumberOfPolys(); ++i)
  {
    if (!ghosts || ghosts->GetValue(i) == 0)
    {
      cells.push_back(i);
      corners.insert(corners.end(), all.begin() + 3 * i, all.begin() + 3 * i + 3);
    }
  }
  lean->SetPoints(poly->GetPoints());
  SetTriangles(lean, corners);
  AddCellArrays(lean, { poly }, &cells);
  return lean;
}

//------------------------------------------------------------------------------
void Write(vtkPolyData* part, vtkAvianLidarByteWriter& bytes)
{
  Corners corners;
  AddCorners(part, 0, corners);
  bytes.Put<std::int64_t>(part->GetNumberOfPoints());
  bytes.Put<std::int64_t>(part->GetNumberOfPolys());
  bytes.Put<char>(HasFloatPoints(part));
  if (HasFloatPoints(part))
  {
    WriteCoordinates<vtkFloatArray>(part, bytes);
  }
  else
  {
    WriteCoordinates<vtkDoubleArray>(part, bytes);
  }
  bytes.Put(corners.data(), corners.size());
  for (const names::Name& name : IdArrays)
  {
    WriteCellArray<vtkIntArray>(part, name, bytes);
  }
  for (const names::Name& name : CoefficientArrays)
  {
    WriteCellArray<vtkDoubleArray>(part, name, bytes);
  }
  for (const names::Name& name : NameArrays)
  {
    bytes.Put<char>(part->GetFieldData()->HasArray(name.name));
    bytes.Put(NamesOf(part, name));
  }
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> Read(vtkAvianLidarByteReader& bytes)
{
  auto part = vtkSmartPointer<vtkPolyData>::New();
  const auto points = static_cast<vtkIdType>(bytes.Get<std::int64_t>());
  const auto triangles = static_cast<vtkIdType>(bytes.Get<std::int64_t>());
  part->SetPoints(bytes.Get<char>() ? ReadPoints<vtkFloatArray>(bytes, points)
                                    : ReadPoints<vtkDoubleArray>(bytes, points));
  Corners corners(3 * static_cast<std::size_t>(triangles));
  bytes.Get(corners.data(), corners.size());
  SetTriangles(part, corners);
  for (const names::Name& name : IdArrays)
  {
    ReadCellArray<vtkIntArray>(part, name, bytes, triangles);
  }
  for (const names::Name& name : CoefficientArrays)
  {
    ReadCellArray<vtkDoubleArray>(part, name, bytes, triangles);
  }
  for (const names::Name& name : NameArrays)
  {
    const bool present = bytes.Get<char>() != 0;
    const std::vector<std::string> values = bytes.GetTexts();
    if (present)
    {
      names::SetFieldStrings(part->GetFieldData(), name, values);
    }
  }
  return part;
}

//------------------------------------------------------------------------------
bool AreAlike(vtkPolyData* one, vtkPolyData* other)
{
  const Arrays a(one);
  const Arrays b(other);
  bool alike = !a.object == !b.object && !a.material == !b.material && !a.kd == !b.kd;
  for (const names::Name& name : NameArrays)
  {
    alike = alike && NamesOf(one, name) == NamesOf(other, name);
  }
  return alike;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> Join(const std::vector<vtkPolyData*>& parts)
{
  auto joined = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataType(
    std::all_of(parts.begin(), parts.end(), HasFloatPoints) ? VTK_FLOAT : VTK_DOUBLE);
  Corners corners;
  for (vtkPolyData* part : parts)
  {
    AddCorners(part, static_cast<std::size_t>(points->GetNumberOfPoints()), corners);
    for (vtkIdType i = 0; i < part->GetNumberOfPoints(); ++i)
    {
      points->InsertNextPoint(part->GetPoint(i));
    }
  }
  joined->SetPoints(points);
  SetTriangles(joined, corners);
  AddCellArrays(joined, parts);
  CopyNames(parts[0], joined);
  return joined;
}
}
