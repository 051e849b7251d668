// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarGeodeticTransform.h"

#include "GeodeticFrame.h"
#include "ValueError.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarPrint.h"
#include "vtkAvianLidarRanks.h"
#include "vtkAvianLidarRequire.h"

#include "vtkCompositeDataIterator.h"
#include "vtkDataObjectTree.h"
#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"

#include <algorithm>
#include <array>
#include <string>

namespace Arrays = vtkAvianLidarArrays;
using avianlidar::Frame;
using avianlidar::GeodeticFrame;

//------------------------------------------------------------------------------
// Conversion of one input, block by block.
class vtkAvianLidarGeodeticTransform::vtkWork
{
public:
  vtkWork(vtkAvianLidarGeodeticTransform* self, vtkDataObject* whole)
    : Self(self)
    , Whole(whole)
    , Source(static_cast<Frame>(self->SourceFrame))
    , Target(self->MovePoints ? static_cast<Frame>(self->TargetFrame) : Frame::Geodetic)
  {
    auto* tree = vtkDataObjectTree::SafeDownCast(whole);
    this->TotalPoints =
      tree ? tree->GetNumberOfPoints() : vtkPointSet::SafeDownCast(whole)->GetNumberOfPoints();
  }

  // Converts `input` into `output`.
  void Run(vtkPointSet* input, const std::string& block, vtkPointSet* output)
  {
    output->ShallowCopy(input);
    const vtkIdType size = input->GetNumberOfPoints();
    if (size > 0)
    {
      this->Block = block.empty() ? "" : " (block '" + block + "')";
      this->PrepareFrame(input->GetFieldData(), output->GetFieldData());
    }
    const std::string where = " of input port 0" + (block.empty() ? "" : ", block '" + block + "'");
    auto longitudes = Arrays::Make<vtkDoubleArray>(Arrays::Longitude, size);
    auto latitudes = Arrays::Make<vtkDoubleArray>(Arrays::Latitude, size);
    auto heights = Arrays::Make<vtkDoubleArray>(Arrays::Height, size);
    auto moved = Arrays::MakePoints(this->Self->MovePoints ? size : 0);
    for (vtkIdType i = 0; i < size; ++i)
    {
      std::array<double, 3> p;
      input->GetPoint(i, p.data());
      const auto convert = [&](Frame to) { return this->Convert(p, to, i, where); };
      const std::array<double, 3> geodetic = convert(Frame::Geodetic);
      const std::array<double, 3> target =
        this->Target == Frame::Geodetic ? geodetic : convert(this->Target);
      longitudes->SetValue(i, geodetic[0]);
      latitudes->SetValue(i, geodetic[1]);
      heights->SetValue(i, geodetic[2]);
      if (this->Self->MovePoints)
      {
        moved->SetPoint(i, target.data());
      }
      this->CountPoint();
    }
    for (vtkDataArray* array : { longitudes.Get(), latitudes.Get(), heights.Get() })
    {
      output->GetPointData()->AddArray(array);
    }
    if (this->Self->MovePoints && size > 0)
    {
      output->SetPoints(moved);
      // The coordinate system given by a reader does not apply to the moved points.
      output->GetFieldData()->RemoveArray(Arrays::CrsWkt.name);
    }
  }

  // Converts every block of a composite.
  void RunTree(vtkDataObjectTree* input, vtkDataObjectTree* output)
  {
    output->ShallowCopy(input);
    auto leaves = vtkSmartPointer<vtkCompositeDataIterator>::Take(input->NewIterator());
    for (leaves->InitTraversal(); !leaves->IsDoneWithTraversal(); leaves->GoToNextItem())
    {
      const char* given = leaves->HasCurrentMetaData()
        ? leaves->GetCurrentMetaData()->Get(vtkCompositeDataSet::NAME())
        : nullptr;
      const std::string name = given ? given : std::to_string(leaves->GetCurrentFlatIndex());
      auto* leaf = vtkPointSet::SafeDownCast(leaves->GetCurrentDataObject());
      if (!leaf)
      {
        vtkAvianLidarRequire("block '" + name + "' of input port 0 is a " +
          leaves->GetCurrentDataObject()->GetClassName() + ", expected a vtkPointSet");
      }
      auto converted = vtkSmartPointer<vtkPointSet>::Take(leaf->NewInstance());
      this->Run(leaf, name, converted);
      output->SetDataSet(leaves, converted);
    }
  }

private:
  bool Uses(Frame frame) const { return this->Source == frame || this->Target == frame; }

  // Sets origin and zone from the field data or the properties, and writes both to `output`.
  void PrepareFrame(vtkFieldData* fields, vtkFieldData* output)
  {
    const bool automatic = this->Uses(Frame::UTM) && this->Self->UTMZone == 0;
    int zone = this->Self->UTMZone;
    if (this->Uses(Frame::ENU) || automatic)
    {
      double origin[3];
      this->FindOrigin(fields, origin);
      this->Geodesy.setOrigin(origin[0], origin[1], origin[2]);
      zone = automatic ? GeodeticFrame::zoneOf(origin[0], origin[1]) : zone;
      Arrays::SetFieldVector(output, Arrays::GeodeticOrigin, origin);
    }
    if (this->Uses(Frame::UTM))
    {
      this->Geodesy.setZone(zone);
      Arrays::SetFieldInteger(output, Arrays::UTMZone, zone);
    }
  }

  void FindOrigin(vtkFieldData* fields, double origin[3])
  {
    std::string where = "Origin";
    std::copy(this->Self->Origin, this->Self->Origin + 3, origin);
    if (this->Self->UseFieldDataOrigin)
    {
      where = std::string("the field data '") + Arrays::GeodeticOrigin.name + "'";
      vtkDataArray* array = fields->GetArray(Arrays::GeodeticOrigin.name);
      array = array ? array : this->Whole->GetFieldData()->GetArray(Arrays::GeodeticOrigin.name);
      if (!array || array->GetNumberOfValues() != 3)
      {
        vtkAvianLidarRequire("input port 0 has no field data '" +
          std::string(Arrays::GeodeticOrigin.name) +
          "' with latitude (deg), longitude (deg) and height (m): switch UseFieldDataOrigin off "
          "and set Origin" +
          this->Block);
      }
      for (int i = 0; i < 3; ++i)
      {
        origin[i] = array->GetComponent(
          i / array->GetNumberOfComponents(), i % array->GetNumberOfComponents());
      }
    }
    const std::string bad = GeodeticFrame::checkOrigin(origin[0], origin[1], origin[2]);
    vtkAvianLidarRequire(bad.empty() ? bad : bad + this->Block, where + ": ");
  }

  // Converts point `i`. Errors name the block of the point by `where`.
  std::array<double, 3> Convert(
    const std::array<double, 3>& point, Frame to, vtkIdType i, const std::string& where)
  {
    std::string problem = GeodeticFrame::checkPoint(this->Source, point);
    std::array<double, 3> converted = point;
    if (problem.empty())
    {
      converted = this->Geodesy.convert(this->Source, to, point);
      problem = GeodeticFrame::checkPoint(to, converted);
    }
    if (!problem.empty())
    {
      vtkAvianLidarRequire(problem, "point " + std::to_string(i) + where + ": ");
    }
    return converted;
  }

  void CountPoint()
  {
    constexpr vtkIdType block = 16384;
    if (++this->DonePoints % block == 0)
    {
      this->Self->UpdateProgress(
        static_cast<double>(this->DonePoints) / static_cast<double>(this->TotalPoints));
      vtkAvianLidarAbort::StopIfWanted(this->Self);
    }
  }

  vtkAvianLidarGeodeticTransform* Self;
  vtkDataObject* Whole;
  Frame Source;
  Frame Target;
  GeodeticFrame Geodesy;
  std::string Block; // text that names the block in errors of the origin
  vtkIdType TotalPoints = 0;
  vtkIdType DonePoints = 0;
};

vtkStandardNewMacro(vtkAvianLidarGeodeticTransform);

//------------------------------------------------------------------------------
int vtkAvianLidarGeodeticTransform::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(INPUT_REQUIRED_DATA_TYPE(), "vtkPointSet");
  // A composite is one input, because the origin may be field data of the composite.
  info->Append(INPUT_REQUIRED_DATA_TYPE(), "vtkDataObjectTree");
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarGeodeticTransform::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return vtkAvianLidarGuarded(this, outputVector,
    [&]()
    {
      vtkDataObject* input = vtkDataObject::GetData(inputVector[0]);
      vtkDataObject* output = vtkDataObject::GetData(outputVector);
      if (this->SourceFrame < FRAME_ENU || this->SourceFrame > FRAME_UTM ||
        this->TargetFrame < FRAME_ENU || this->TargetFrame > FRAME_UTM)
      {
        vtkAvianLidarRequire("SourceFrame is " + std::to_string(this->SourceFrame) +
          " and TargetFrame " + std::to_string(this->TargetFrame) +
          ", expected 0 (ENU), 1 (geodetic), 2 (ECEF) or 3 (UTM)");
      }
      vtkAvianLidarRequire(avianlidar::rangeError(
        "UTMZone", this->UTMZone, -60, 60, "1 to 60, -1 to -60 in the south, or 0 (automatic)"));
      vtkAvianLidarWithin("Geodetic transform: ",
        [&]()
        {
          vtkWork work(this, input);
          if (auto* tree = vtkDataObjectTree::SafeDownCast(output))
          {
            work.RunTree(vtkDataObjectTree::SafeDownCast(input), tree);
          }
          else
          {
            work.Run(vtkPointSet::SafeDownCast(input), "", vtkPointSet::SafeDownCast(output));
          }
        });
    });
}

//------------------------------------------------------------------------------
vtkAvianLidarPrintSelfMacro(vtkAvianLidarGeodeticTransform, ErrorsAsData, SourceFrame, TargetFrame,
  MovePoints, UseFieldDataOrigin, Origin, UTMZone);
