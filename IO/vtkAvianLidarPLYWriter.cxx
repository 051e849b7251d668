// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarPLYWriter.h"

#include "PlyFormat.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarCloudFields.h"
#include "vtkAvianLidarPrint.h"

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
std::vector<formats::Field> ToRedGreenBlue(vtkDataArray* colours)
{
  std::vector<formats::Field> properties = fields::ToFields(colours);
  properties[0].name = "red";
  properties[1].name = "green";
  properties[2].name = "blue";
  return properties;
}
}

vtkStandardNewMacro(vtkAvianLidarPLYWriter);

//------------------------------------------------------------------------------
void vtkAvianLidarPLYWriter::WriteCloud(vtkPointSet* input)
{
  formats::TableOutput output = fields::ToTable(
    input, this->Precision, ToRedGreenBlue, [this](const std::string& text) { this->Warn(text); });
  output.ascii = this->FileType == FILE_TYPE_ASCII;
  formats::PlyFaces faces;
  vtkNew<vtkIdList> ids;
  if (auto* mesh = vtkPolyData::SafeDownCast(input))
  {
    avianlidar::failIf(
      mesh->GetNumberOfStrips() > 0, "it has triangle strips, expected polygons: triangulate them");
    faces.count = mesh->GetNumberOfPolys();
    faces.pointsOf = [mesh, &ids](std::int64_t i, std::vector<std::int64_t>& points)
    {
      mesh->GetPolys()->GetCellAtId(i, ids);
      points.assign(ids->GetPointer(0), ids->GetPointer(0) + ids->GetNumberOfIds());
    };
  }

  avianlidar::OutputFile file(this->FileName);
  formats::writePly(file, output, static_cast<std::uint64_t>(input->GetNumberOfPoints()), faces,
    vtkAvianLidarAbort::KeepGoing(this));
  file.commit();
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarPLYWriter, FileType, Precision);
