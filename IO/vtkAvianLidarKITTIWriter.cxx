// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarKITTIWriter.h"

#include "Private/KittiFormat.h"
#include "Private/SemanticLabels.h"
#include "Private/vtkAvianLidarCloudFields.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarNames.h"
#include "vtkAvianLidarText.h"

#include "vtkObjectFactory.h"
#include "vtkPointSet.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>

namespace fields = vtkAvianLidarCloudFields;
namespace formats = avianlidar::formats;
namespace names = vtkAvianLidarArrays;
using formats::FormatError;
using formats::Point;

namespace
{
/// SemanticKITTI's classes by object_id.
std::vector<int> LabelsOfObjects(vtkPointSet* input)
{
  std::vector<int> labels;
  auto* classes = fields::FindTexts(input, names::ObjectClasses.name);
  for (vtkIdType i = 0; classes && i < classes->GetNumberOfValues(); ++i)
  {
    labels.push_back(formats::labelOfClass(classes->GetValue(i)).kitti);
  }
  return labels;
}
}

vtkStandardNewMacro(vtkAvianLidarKITTIWriter);

//------------------------------------------------------------------------------
vtkAvianLidarKITTIWriter::vtkAvianLidarKITTIWriter() = default;

//------------------------------------------------------------------------------
vtkAvianLidarKITTIWriter::~vtkAvianLidarKITTIWriter() = default;

//------------------------------------------------------------------------------
void vtkAvianLidarKITTIWriter::WriteCloud(vtkPointSet* input)
{
  std::optional<formats::SensorPose> pose = fields::FindPose(input);
  if (!pose)
  {
    vtkWarningMacro("" << vtkAvianLidarText(this->FileName) << ": the input has no field data '"
                       << names::Position.name
                       << "' of a sensor: its points are taken for coordinates in the sensor's "
                          "frame, x right, y forward, z up.");
    pose.emplace();
  }

  formats::KittiOutput output;
  output.size = input->GetNumberOfPoints();
  output.point = [input, &pose](std::int64_t i)
  {
    Point p;
    input->GetPoint(i, p.data());
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
    {
      throw FormatError("point " + std::to_string(i) + " has a coordinate that is not finite");
    }
    p = pose->toSensor(p);
    if (std::max({ std::abs(p[0]), std::abs(p[1]), std::abs(p[2]) }) >
      std::numeric_limits<float>::max())
    {
      throw FormatError("point " + std::to_string(i) +
        " has a coordinate that single precision, KITTI's, has no number for");
    }
    return p;
  };
  vtkDataArray* intensity = fields::Find(input, names::Intensity.name);
  constexpr double greatest = 255.0;
  vtkIdType beyond = 0;
  output.intensity = [intensity, &beyond, greatest](std::int64_t i)
  {
    const double value = fields::ValueOf(intensity, i, 0.0);
    beyond += value < 0.0 || value > greatest ? 1 : 0;
    return std::clamp(value, 0.0, greatest);
  };

  std::optional<formats::OutputFile> labels;
  if (this->WriteLabels)
  {
    vtkDataArray* object = fields::Need(input, names::ObjectId.name);
    const bool byMaterial = this->LabelSource == LABEL_SOURCE_MATERIAL;
    vtkDataArray* material = byMaterial ? fields::Need(input, names::MaterialId.name) : nullptr;
    const std::vector<int> classes = LabelsOfObjects(input);
    output.label = [=](std::int64_t i)
    {
      const int id = fields::IntegerOf(object, i, -1);
      return byMaterial ? formats::labelOfMaterial(fields::IntegerOf(material, i, -1))
        : id >= 0 && id < static_cast<int>(classes.size()) ? classes[id]
                                                           : formats::labelWithoutObject(id).kitti;
    };
    output.instance = [=](std::int64_t i)
    {
      const int id = fields::IntegerOf(object, i, -1);
      return id >= 0 ? static_cast<int>((std::int64_t{ id } + 1) % 65536) : 0;
    };
    labels.emplace(std::filesystem::path(this->FileName).replace_extension(".label").string());
  }

  formats::OutputFile file(this->FileName);
  if (labels && labels->isSameAs(file))
  {
    throw FormatError("FileName is the name of the labels beside it, expected another ending than "
                      ".label, such as .bin");
  }
  formats::writeKitti(
    file, labels ? &*labels : nullptr, output, vtkAvianLidarAbort::KeepGoing(this));
  if (labels)
  {
    formats::OutputFile::commitBoth(*labels, file);
  }
  else
  {
    file.commit();
  }
  if (beyond > 0)
  {
    vtkWarningMacro("" << vtkAvianLidarText(this->FileName) << ": " << beyond
                       << " points have an intensity that is not within 0 and 255: the nearest of "
                          "the two is written for it.");
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarKITTIWriter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "WriteLabels: " << this->WriteLabels << "\n";
  os << indent << "LabelSource: " << this->LabelSource << "\n";
}
