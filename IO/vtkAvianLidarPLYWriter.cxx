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

#include <algorithm>
#include <limits>

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
    formats::Field field = fields::ToField(array);
    std::replace_if(
      field.name.begin(), field.name.end(), [](unsigned char x) { return x <= ' '; }, '_');
    field.name = colours ? names[c] : field.name + "_" + std::to_string(c);
    field.value = [array, c](std::int64_t i) { return array->GetComponent(i, c); };
    if (field.type == formats::Scalar::Int64 || field.type == formats::Scalar::UInt64)
    {
      field.type = formats::Scalar::Float64;
    }
    if (std::any_of(all.begin(), all.end(),
          [&](const formats::Field& other) { return other.name == field.name; }))
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
vtkAvianLidarPLYWriter::vtkAvianLidarPLYWriter() = default;

//------------------------------------------------------------------------------
vtkAvianLidarPLYWriter::~vtkAvianLidarPLYWriter() = default;

//------------------------------------------------------------------------------
void vtkAvianLidarPLYWriter::WriteCloud(vtkPointSet* input)
{
  formats::TableOutput output;
  output.ascii = this->FileType == FILE_TYPE_ASCII;
  output.fields =
    fields::TableFields(this, this->FileName, input, this->Precision == PRECISION_SINGLE);
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
  std::vector<std::string> cut; // nothing: a comment may be as long as it is
  output.comment =
    formats::toText(fields::ToNotes(input), std::numeric_limits<std::size_t>::max(), cut);

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
