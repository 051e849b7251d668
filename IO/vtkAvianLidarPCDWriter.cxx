// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarPCDWriter.h"

#include "PcdFormat.h"
#include "ScanPattern.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCloudFields.h"
#include "vtkAvianLidarPrint.h"

#include "vtkDataArray.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace fields = vtkAvianLidarCloudFields;
namespace formats = avianlidar::formats;
namespace names = vtkAvianLidarArrays;
using avianlidar::failIf;
using formats::Field;
using formats::Scalar;

namespace
{
/// Returns the colours in the bytes of a float, as PCL stores them.
std::vector<Field> ToPackedColour(vtkDataArray* colours)
{
  return { { "rgb", "", Scalar::Float32,
    [colours](std::int64_t i)
    {
      std::uint32_t packed = 0;
      for (int c = 0; c < 3; ++c)
      {
        packed = packed << 8 | static_cast<std::uint32_t>(colours->GetComponent(i, c));
      }
      unsigned char bytes[4];
      formats::store(packed, bytes);
      return formats::loadAs(Scalar::Float32, bytes);
    } } };
}

/// Reads the pattern of the scan from the field data of the beam source. Returns an empty text, or
/// a sentence that names the missing field data.
std::string ReadPattern(vtkPointSet* input, avianlidar::ScanPattern& pattern)
{
  vtkFieldData* data = input->GetFieldData();
  double channels = 0.0;
  vtkDataArray* range = data->GetArray(names::AzimuthRange.name);
  if (!names::GetFieldValue(data, names::NumberOfChannels, channels) ||
    !names::GetFieldValue(data, names::AzimuthStep, pattern.azimuthStep) || !range ||
    range->GetNumberOfValues() != 2)
  {
    return std::string("the input has no field data '") + names::NumberOfChannels.name + "', '" +
      names::AzimuthRange.name + "' and '" + names::AzimuthStep.name + "' of a beam source";
  }
  const int width = range->GetNumberOfComponents();
  pattern.azimuthStart = range->GetComponent(0, 0);
  pattern.azimuthEnd = range->GetComponent(1 / width, 1 % width);
  pattern.channels = formats::nearest(Scalar::Int32, channels);
  try
  {
    names::ReadFieldValue(data, names::MinimumElevation, pattern.minimumElevation);
    names::ReadFieldValue(data, names::ElevationStep, pattern.elevationStep);
    names::RequireNumeric(data, names::ChannelElevations, "field data");
  }
  catch (const std::runtime_error& error)
  {
    return std::string("the ") + error.what();
  }
  vtkDataArray* table = data->GetArray(names::ChannelElevations.name);
  for (vtkIdType i = 0; table && i < table->GetNumberOfValues(); ++i)
  {
    pattern.elevations.push_back(table->GetComponent(i, 0));
  }
  // The grid does not depend on the clock of the scan.
  pattern.firingInterval = 0.0;
  return avianlidar::checkPattern(pattern);
}

std::int64_t BeamOf(vtkDataArray* beams, std::int64_t i)
{
  const double beam = fields::ValueOf(beams, i, 0.0);
  constexpr double most = 9007199254740992.0; // 2^53, limit of exact integers
  failIf(!(beam >= 0.0 && beam <= most && beam == std::floor(beam)),
    "the point array 'beam_id' is not a whole number from 0 to 2^53, at point ", i);
  return static_cast<std::int64_t>(beam);
}

/// Echoes in rows and columns. Rows are channels, the highest elevation first. Columns are the
/// columns of the scan, in the order of firing.
struct OrganisedCells
{
  std::int64_t width = 0;
  std::int64_t height = 0;
  std::vector<std::int64_t> points; ///< index of the point of a cell (row * width + column), or -1
  std::vector<int> channelOfRow;
  bool several = false; ///< whether a beam had more than one echo

  /// Returns the beam of a cell, as the beam source numbers beams.
  std::int64_t beamOf(std::int64_t cell) const
  {
    return cell % this->width * this->height + this->channelOfRow[cell / this->width];
  }
};

/// Sorts echoes into cells. A cell holds the echo of its beam with the most energy. Returns an
/// empty text or a fault: no pattern, too many cells, a beam outside the pattern, or a wrong
/// channel.
std::string Organise(vtkPointSet* input, OrganisedCells& cells)
{
  avianlidar::ScanPattern pattern;
  const std::string problem = ReadPattern(input, pattern);
  vtkDataArray* beams = fields::Find(input, names::BeamId.name);
  vtkDataArray* lasers = fields::Find(input, names::LaserId.name);
  vtkDataArray* received = fields::Find(input, names::EnergyReceived.name);
  if (!problem.empty())
  {
    return problem;
  }
  if (!beams || !lasers)
  {
    return std::string("the input has no point arrays '") + names::BeamId.name + "' and '" +
      names::LaserId.name + "'";
  }
  const vtkIdType size = input->GetNumberOfPoints();
  for (vtkIdType i = 0; i < size; ++i)
  {
    fields::ValueOf(received, i, 0.0); // throws unless the value is finite
  }
  constexpr std::int64_t mostCells = 100000000;
  const int channels = numberOfChannels(pattern);
  cells.width = numberOfColumns(pattern);
  if (cells.width > mostCells / channels)
  {
    return "its scan has " + std::to_string(cells.width) + " columns of " +
      std::to_string(channels) + " channels, more than 100 million cells";
  }
  cells.height = channels;
  cells.channelOfRow.resize(channels);
  std::iota(cells.channelOfRow.begin(), cells.channelOfRow.end(), 0);
  std::stable_sort(cells.channelOfRow.begin(), cells.channelOfRow.end(),
    [&](int a, int b) { return channelElevation(pattern, a) > channelElevation(pattern, b); });
  std::vector<int> rowOfChannel(channels);
  for (int row = 0; row < channels; ++row)
  {
    rowOfChannel[cells.channelOfRow[row]] = row;
  }
  cells.points.assign(static_cast<std::size_t>(cells.width * cells.height), -1);
  for (vtkIdType i = 0; i < size; ++i)
  {
    const std::int64_t id = BeamOf(beams, i);
    const int channel = fields::IntegerOf(lasers, i, 0);
    if (id < 0 || id >= cells.width * cells.height || channel != id % channels)
    {
      return "point " + std::to_string(i) + " has the beam_id " + std::to_string(id) +
        " and the laser_id " + std::to_string(channel) + ", which are not a beam of a scan of " +
        std::to_string(cells.width) + " columns and " + std::to_string(channels) + " channels";
    }
    std::int64_t& at = cells.points[rowOfChannel[id % channels] * cells.width + id / channels];
    cells.several = cells.several || at >= 0;
    if (at < 0 || fields::ValueOf(received, i, 0.0) > fields::ValueOf(received, at, 0.0))
    {
      at = i;
    }
  }
  return std::string();
}

/// Returns the value of a field in a cell without an echo.
double EmptyValue(const Field& field, const OrganisedCells& cells, std::int64_t cell)
{
  if (field.name == names::LaserId.name)
  {
    return cells.channelOfRow[static_cast<std::size_t>(cell / cells.width)];
  }
  if (field.name == names::BeamId.name)
  {
    return static_cast<double>(cells.beamOf(cell));
  }
  if (formats::isFloat(field.type))
  {
    return std::numeric_limits<double>::quiet_NaN();
  }
  // Identifiers are -1. Counts, which have the unit 1, are 0.
  return field.unit.empty() && formats::isSigned(field.type) ? -1.0 : 0.0;
}
}

vtkStandardNewMacro(vtkAvianLidarPCDWriter);

//------------------------------------------------------------------------------
void vtkAvianLidarPCDWriter::WriteCloud(vtkPointSet* input)
{
  formats::PcdOutput output{ fields::ToTable(input, this->Precision, ToPackedColour,
    [this](const std::string& text) { this->Warn(text); }) };
  output.ascii = this->FileType == FILE_TYPE_ASCII;
  output.width = static_cast<std::uint64_t>(input->GetNumberOfPoints());
  OrganisedCells cells;
  if (this->Organisation != ORGANISATION_LIST && input->GetNumberOfPoints() > 0)
  {
    const bool asked = this->Organisation == ORGANISATION_ORGANISED;
    const std::string problem = Organise(input, cells);
    failIf(asked && !problem.empty(), "it cannot be organised: ", problem);
    if (problem.empty() && (asked || !cells.several))
    {
      output.width = static_cast<std::uint64_t>(cells.width);
      output.height = static_cast<std::uint64_t>(cells.height);
      output.cells = cells.points;
      output.empty = [&](std::size_t field, std::int64_t cell)
      { return EmptyValue(output.fields[field], cells, cell); };
    }
  }
  if (const auto pose = fields::FindPose(input))
  {
    output.viewpoint = pose->viewpoint();
  }

  avianlidar::OutputFile file(this->FileName);
  formats::writePcd(file, output, vtkAvianLidarAbort::KeepGoing(this));
  file.commit();
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarPCDWriter, FileType, Organisation, Precision);
