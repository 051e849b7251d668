// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarKITTIWriter.h"

#include "KittiFormat.h"
#include "OutputFile.h"
#include "ReadCloud.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarCloudFields.h"
#include "vtkAvianLidarNames.h"
#include "vtkAvianLidarPrint.h"

#include "vtkObjectFactory.h"
#include "vtkPointSet.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>

namespace fields = vtkAvianLidarCloudFields;
namespace formats = avianlidar::formats;
namespace names = vtkAvianLidarArrays;
using avianlidar::failIf;
using formats::Point;

namespace
{
/// Returns a point in the sensor's frame. Throws FormatError if single precision cannot hold it.
Point PlaceOf(vtkPointSet* input, const fields::SensorPose& pose, vtkIdType i)
{
  Point p;
  input->GetPoint(i, p.data());
  failIf(!avianlidar::isFinite({ p[0], p[1], p[2] }), "point ", i,
    " has a coordinate that is not finite");
  p = pose.toSensor(p);
  failIf(std::max({ std::abs(p[0]), std::abs(p[1]), std::abs(p[2]) }) >
      std::numeric_limits<float>::max(),
    "point ", i, " has a coordinate beyond the range of single precision, which KITTI uses");
  return p;
}

/// Labels of SemanticKITTI, with the class in the lower and the instance in the upper 16 bits.
class Labels
{
public:
  Labels(vtkPointSet* input, bool byMaterial)
    : Objects(fields::Find(input, names::ObjectId.name))
    , Materials(byMaterial ? fields::Need(input, names::MaterialId.name) : nullptr)
    , Given(Objects ? nullptr : fields::Find(input, names::SemanticLabel.name))
    , Instances(Given ? fields::Find(input, names::InstanceId.name) : nullptr)
    , ByMaterial(byMaterial)
    , LabelOf(fields::LabelsOf(input))
  {
  }

  /// Returns whether the input has arrays for the labels.
  bool Known() const { return this->Objects || this->Materials || this->Given; }

  std::uint32_t At(vtkIdType i) const
  {
    if (this->Given && !this->ByMaterial)
    {
      return (static_cast<std::uint32_t>(fields::IntegerOf(this->Given, i, 0)) & 0xFFFF) |
        static_cast<std::uint32_t>(fields::IntegerOf(this->Instances, i, 0)) << 16;
    }
    const int id = fields::IntegerOf(this->Objects, i, -1);
    const int label = this->ByMaterial
      ? formats::labelOfMaterial(fields::IntegerOf(this->Materials, i, -1))
      : this->LabelOf(id).kitti;
    const auto instance =
      static_cast<std::uint32_t>(id >= 0 ? (std::int64_t{ id } + 1) % 65536 : 0);
    return static_cast<std::uint32_t>(label & 0xFFFF) | instance << 16;
  }

private:
  vtkDataArray *Objects, *Materials;
  vtkDataArray *Given, *Instances; ///< labels of an input without objects, such as a KITTI scan
  bool ByMaterial;
  std::function<formats::SemanticLabel(int)> LabelOf;
};
}

vtkStandardNewMacro(vtkAvianLidarKITTIWriter);

//------------------------------------------------------------------------------
void vtkAvianLidarKITTIWriter::WriteCloud(vtkPointSet* input)
{
  std::optional<fields::SensorPose> pose = fields::FindPose(input);
  if (!pose)
  {
    this->Warn(std::string(": the input has no field data '") + names::Position.name +
      "' of a sensor: its points are taken for coordinates in the sensor's frame, x right, y "
      "forward, z up. Set the field data, or --position of avianlidar convert.");
    pose.emplace();
  }

  vtkDataArray* intensity = fields::Find(input, names::Intensity.name);
  std::optional<Labels> labels;
  std::optional<avianlidar::OutputFile> labelFile;
  avianlidar::OutputFile file(this->FileName);
  if (this->WriteLabels)
  {
    labels.emplace(input, this->LabelSource == LABEL_SOURCE_MATERIAL);
  }
  if (labels && !labels->Known() && input->GetNumberOfPoints() > 0)
  {
    const std::string beside = formats::labelFileOf(this->FileName);
    failIf(!beside.empty(), "the input has no point array '", names::ObjectId.name, "' or '",
      names::SemanticLabel.name, "' for labels, but the file would get the labels of ", beside,
      ": remove this file");
    this->Warn(std::string(": no labels are written, because the input has no point array '") +
      names::ObjectId.name + "' or '" + names::SemanticLabel.name + "'.");
    labels.reset();
  }
  if (labels)
  {
    // beside the target if FileName is a link
    labelFile.emplace(std::filesystem::path(file.name()).replace_extension(".label").string());
  }
  failIf(labelFile && labelFile->isSameAs(file),
    "FileName is the name of the labels beside it, expected another ending than .label, such as "
    ".bin");

  const auto keepGoing = vtkAvianLidarAbort::KeepGoing(this);
  const vtkIdType size = input->GetNumberOfPoints();
  vtkIdType beyond = 0;
  double rounding = 0.0;
  constexpr double greatest = formats::KittiGreatestIntensity;
  for (vtkIdType i = 0; i < size; ++i)
  {
    const Point p = PlaceOf(input, *pose, i);
    rounding = std::max(rounding, fields::RoundingOf(p));
    const double value = fields::ValueOf(intensity, i, 0.0);
    beyond += value < 0.0 || value > greatest ? 1 : 0;
    unsigned char bytes[16];
    formats::storeAs(formats::Scalar::Float32, p[1], bytes);
    formats::storeAs(formats::Scalar::Float32, -p[0], bytes + 4);
    formats::storeAs(formats::Scalar::Float32, p[2], bytes + 8);
    formats::storeAs(
      formats::Scalar::Float32, std::clamp(value, 0.0, greatest) / greatest, bytes + 12);
    file.write(bytes, sizeof bytes);
    if (labels)
    {
      formats::store(labels->At(i), bytes);
      labelFile->write(bytes, sizeof(std::uint32_t));
    }
    formats::goOn(keepGoing, i, size);
  }
  if (labels)
  {
    avianlidar::OutputFile::commitBoth(*labelFile, file);
  }
  else
  {
    file.commit();
  }
  if (rounding > fields::NoticeableRounding)
  {
    this->Warn(": single precision, which KITTI uses," + fields::Moves(rounding) +
      ": set the field data '" + names::Position.name +
      "', or --position of avianlidar convert, to the position of the sensor.");
  }
  if (beyond > 0)
  {
    this->Warn(": " + std::to_string(beyond) +
      " points have an intensity that is not within 0 and 255: the nearer of the two limits is "
      "written.");
  }
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarKITTIWriter, WriteLabels, LabelSource);
