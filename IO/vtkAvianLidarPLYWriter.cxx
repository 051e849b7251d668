// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarPLYWriter.h"

#include "Private/PlyFormat.h"
#include "Private/vtkAvianLidarCloudFields.h"
#include "vtkAvianLidarAbort.h"

#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkIdList.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"

namespace fields = vtkAvianLidarCloudFields;
namespace formats = avianlidar::formats;

namespace
{
/// The components of an array as properties: red, green and blue, or its name and a number.
void AddComponents(vtkDataArray* array, bool colours, std::vector<formats::Field>& all)
{
  const char* const names[] = { "red", "green", "blue" };
  for (int c = 0; c < array->GetNumberOfComponents(); ++c)
  {
    formats::Field field = fields::TableField(array, c);
    field.name = colours ? names[c] : field.name + "_" + std::to_string(c);
    if (fields::HasName(all, field.name))
    {
      throw formats::FormatError("the point arrays '" + field.name + "' and '" + array->GetName() +
        "' have one name in the file: take away one of them");
    }
    all.push_back(field);
  }
}
}

vtkStandardNewMacro(vtkAvianLidarPLYWriter);

//------------------------------------------------------------------------------
void vtkAvianLidarPLYWriter::WriteCloud(vtkPointSet* input)
{
  formats::TableOutput output = fields::ToTable(input, this->Precision == PRECISION_SINGLE,
    [this](const std::string& text) { this->Warn(text); });
  output.ascii = this->FileType == FILE_TYPE_ASCII;
  vtkDataArray* colours = fields::FindColours(input);
  vtkPointData* data = input->GetPointData();
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = data->GetArray(i);
    if (array && array->GetName() && array->GetNumberOfComponents() > 1)
    {
      AddComponents(array, array == colours, output.fields);
    }
  }
  formats::PlyFaces faces;
  vtkNew<vtkIdList> ids;
  if (auto* mesh = vtkPolyData::SafeDownCast(input))
  {
    if (mesh->GetNumberOfStrips() > 0)
    {
      throw formats::FormatError("it has triangle strips, expected polygons: triangulate them");
    }
    faces.count = mesh->GetNumberOfPolys();
    faces.pointsOf = [mesh, &ids](std::int64_t i, std::vector<std::int64_t>& points)
    {
      mesh->GetPolys()->GetCellAtId(i, ids);
      points.assign(ids->GetPointer(0), ids->GetPointer(0) + ids->GetNumberOfIds());
    };
  }

  formats::OutputFile file(this->FileName);
  formats::writePly(file, output, static_cast<std::uint64_t>(input->GetNumberOfPoints()), faces,
    vtkAvianLidarAbort::KeepGoing(this));
  file.commit();
}

//------------------------------------------------------------------------------
void vtkAvianLidarPLYWriter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileType: " << this->FileType << "\n";
  os << indent << "Precision: " << this->Precision << "\n";
}
