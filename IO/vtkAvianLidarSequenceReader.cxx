// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarSequenceReader.h"

#include "ReadCloud.h"
#include "TextLines.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCloudFields.h"
#include "vtkAvianLidarGuard.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarText.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkExecutive.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <optional>
#include <sstream>

namespace formats = avianlidar::formats;
namespace fs = std::filesystem;
namespace names = vtkAvianLidarArrays;
using avianlidar::failIf;

namespace
{
constexpr char TimesFile[] = "times.txt";

/// Matrix from the sensor's frame (x forward, y left, z up) to the poses' frame.
using Pose = glm::dmat4x3;

/// Words of a line, at least one.
struct Line
{
  std::string where;
  std::vector<std::string> words;

  double NumberAt(std::size_t word) const
  {
    const double value = avianlidar::numberOf<double>(this->words[word], this->where.c_str());
    failIf(!std::isfinite(value), this->where, " has \"", avianlidar::shown(this->words[word]),
      "\", expected a finite number");
    return value;
  }
};

std::vector<Line> LinesOf(const std::string& file)
{
  avianlidar::FileSource source(file);
  avianlidar::TextLines lines(source, 0);
  const std::string name = " of " + fs::path(file).filename().string();
  std::vector<Line> all;
  std::size_t number = 0;
  for (std::string text; lines.get(text);)
  {
    Line line{ "line " + std::to_string(++number) + name, {} };
    std::istringstream stream(text);
    for (std::string word; stream >> word;)
    {
      line.words.push_back(word);
    }
    if (!line.words.empty())
    {
      all.push_back(std::move(line));
    }
  }
  return all;
}

std::vector<double> TimesOf(const std::string& file)
{
  std::vector<double> times;
  for (const Line& line : LinesOf(file))
  {
    times.push_back(line.NumberAt(0));
    failIf(times.size() > 1 && !(times.back() > times[times.size() - 2]), "the time in ",
      line.where, " is not above the one before, expected seconds that rise");
  }
  failIf(times.empty(), "there is no time in it, expected the time of a scan (s) in each line");
  return times;
}

Pose PoseOf(const Line& line, std::size_t first)
{
  failIf(line.words.size() != first + 12, line.where, " has ", line.words.size() - first,
    " numbers, expected the 12 of a pose");
  Pose pose;
  for (int i = 0; i < 12; ++i)
  {
    pose[i % 4][i / 4] = line.NumberAt(first + i); // rows one after the other
  }
  return pose;
}

/// Transformation of a scan by the pose and calibration of the sequence, or, without a file of
/// poses, only to x right and y forward.
class Placement
{
public:
  Placement(const fs::path& folder, std::size_t scan)
  {
    const std::string poses = (folder / "poses.txt").string();
    if (!fs::exists(poses))
    {
      return;
    }
    const std::vector<Line> lines = LinesOf(poses);
    failIf(scan >= lines.size(), "poses.txt has ", lines.size(),
      " lines, expected a pose for each scan");
    this->Of = PoseOf(lines[scan], 0);
    if (fs::exists(folder / "calib.txt"))
    {
      for (const Line& line : LinesOf((folder / "calib.txt").string()))
      {
        this->Calibration = line.words.front() == "Tr:" ? PoseOf(line, 1) : this->Calibration;
      }
    }
  }

  /// Transforms a point of KITTI's frame.
  glm::dvec3 operator()(const glm::dvec3& p) const
  {
    if (!this->Of)
    {
      return { -p.y, p.x, p.z };
    }
    const Pose& c = this->Calibration; // a rotation and a translation
    const glm::dvec3 placed = *this->Of * glm::dvec4(c * glm::dvec4(p, 1), 1);
    return (placed - c[3]) * glm::dmat3(c);
  }

private:
  std::optional<Pose> Of;
  Pose Calibration{ 1 };
};

/// Adds the eight corners and six sides of each box to `boxes`.
void ReadBoxes(const std::string& file, const Placement& place, vtkPolyData* boxes)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> sides;
  auto classes = names::Make<vtkStringArray>(names::Object);
  auto ids = names::Make<vtkIntArray>(names::ObjectId);
  for (const Line& line : LinesOf(file))
  {
    failIf(line.words.size() != 12, line.where, " has ", line.words.size(),
      " words, expected the 12 of a box");
    std::array<double, 12> v{};
    for (std::size_t i = 1; i < 12; ++i)
    {
      v[i] = line.NumberAt(i);
    }
    failIf(v[10] != std::trunc(v[10]) || std::abs(v[10]) > std::numeric_limits<int>::max(),
      line.where, " has \"", avianlidar::shown(line.words[10]),
      "\", expected a whole number of 32 bits: an id");
    const vtkIdType first = points->GetNumberOfPoints();
    for (int corner = 0; corner < 8; ++corner)
    {
      const double along = ((corner & 1) ? 0.5 : -0.5) * v[6];
      const double across = ((corner & 2) ? 0.5 : -0.5) * v[7];
      const double up = ((corner & 4) ? 0.5 : -0.5) * v[8];
      const double c = std::cos(v[9]);
      const double s = std::sin(v[9]);
      const glm::dvec3 at =
        place({ v[3] + c * along - s * across, v[4] + s * along + c * across, v[5] + up });
      points->InsertNextPoint(&at[0]);
    }
    constexpr int Sides[6][4] = { { 0, 2, 3, 1 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 }, { 2, 6, 7, 3 },
      { 0, 4, 6, 2 }, { 1, 3, 7, 5 } };
    for (const auto& side : Sides)
    {
      sides->InsertNextCell(4);
      for (const int corner : side)
      {
        sides->InsertCellPoint(first + corner);
      }
      classes->InsertNextValue(line.words[0]);
      ids->InsertNextValue(static_cast<int>(v[10]));
    }
  }
  boxes->SetPoints(points);
  boxes->SetPolys(sides);
  boxes->GetCellData()->AddArray(classes);
  boxes->GetCellData()->AddArray(ids);
}

std::string NumberedFile(const fs::path& folder, std::size_t scan, const char* ending)
{
  char number[32];
  std::snprintf(number, sizeof(number), "%06zu", scan);
  return (folder / (number + std::string(ending))).string();
}

/// Reads a scan into the outputs.
void ReadScan(vtkAlgorithm* self, const fs::path& folder, std::size_t scan, vtkPolyData* points,
  vtkPolyData* boxes)
{
  const std::string file = NumberedFile(folder / "velodyne", scan, ".bin");
  formats::Cloud cloud;
  try
  {
    cloud = formats::readCloud(file, vtkAvianLidarAbort::KeepGoing(self));
  }
  catch (const formats::FormatError& error)
  {
    avianlidar::fail(fs::path(file).filename().string(), ": ", error.what());
  }
  for (const std::string& warning : cloud.warnings)
  {
    vtkWarningWithObjectMacro(self, "" << vtkAvianLidarText(file + ": " + warning) << ".");
  }
  const Placement place(folder, scan);
  for (std::size_t i = 0; i < cloud.size(); ++i)
  {
    double* at = cloud.points.data() + 3 * i;
    const glm::dvec3 moved = place({ at[1], -at[0], at[2] }); // KITTI's axes
    std::copy_n(&moved[0], 3, at);
  }
  if (cloud.sensor)
  {
    const glm::dvec3 sensor = place({ 0.0, 0.0, 0.0 });
    cloud.sensor = formats::Point{ sensor.x, sensor.y, sensor.z };
  }
  vtkAvianLidarCloudFields::ToPolyData(cloud, points);
  vtkPointData* data = points->GetPointData();
  const char* label = names::SemanticLabel.name;
  data->SetActiveScalars(data->HasArray(label) ? label : names::Intensity.name);
  const std::string boxFile = NumberedFile(folder / "boxes", scan, ".txt");
  if (fs::exists(boxFile))
  {
    ReadBoxes(boxFile, place, boxes);
  }
}
}

vtkStandardNewMacro(vtkAvianLidarSequenceReader);

//------------------------------------------------------------------------------
vtkAvianLidarSequenceReader::vtkAvianLidarSequenceReader()
{
  this->SetNumberOfInputPorts(0);
  this->SetNumberOfOutputPorts(2);
}

//------------------------------------------------------------------------------
vtkAvianLidarSequenceReader::~vtkAvianLidarSequenceReader()
{
  this->SetFileName(nullptr);
}

//------------------------------------------------------------------------------
int vtkAvianLidarSequenceReader::CanReadFile(const char* fileName)
{
  std::error_code ignored;
  const fs::path file = fileName ? fileName : "";
  return file.filename() == TimesFile && fs::is_regular_file(file, ignored) &&
      fs::is_directory(fs::absolute(file, ignored).parent_path() / "velodyne", ignored)
    ? 1
    : 0;
}

//------------------------------------------------------------------------------
int vtkAvianLidarSequenceReader::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  std::vector<double> times;
  // RequestData() finds and reports an error.
  vtkAvianLidarGuard::ProblemOf([&] { times = TimesOf(this->FileName ? this->FileName : ""); });
  for (int port = 0; port < 2; ++port)
  {
    vtkAvianLidarCloudFields::SetTimes(times, outputVector->GetInformationObject(port));
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarSequenceReader::RequestData(
  vtkInformation* request, vtkInformationVector**, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]()
    {
      const int port = std::max(0, request->Get(vtkExecutive::FROM_OUTPUT_PORT()));
      vtkInformation* info = outputVector->GetInformationObject(port);
      failIf(!this->FileName || !*this->FileName,
        "FileName is not set, expected the times.txt of a sequence");
      if (vtkAvianLidarCloudFields::IsOtherPiece(info))
      {
        return;
      }
      vtkAvianLidarCloudFields::Within(this->FileName, "there is not enough memory for a scan",
        [&]
        {
          const std::vector<double> times = TimesOf(this->FileName);
          const std::size_t scan = vtkAvianLidarCloudFields::StepOf(times, info);
          vtkPolyData* points = vtkPolyData::GetData(outputVector, 0);
          vtkPolyData* boxes = vtkPolyData::GetData(outputVector, 1);
          ReadScan(this, fs::absolute(this->FileName).parent_path(), scan, points, boxes);
          for (vtkPolyData* output : { points, boxes })
          {
            output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), times[scan]);
          }
        });
    });
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarSequenceReader, ErrorsAsData, FileName);
