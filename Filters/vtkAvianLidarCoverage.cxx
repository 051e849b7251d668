// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarCoverage.h"

#include "AvailableMemory.h"
#include "Coverage.h"
#include "Hash.h"
#include "PhotonReceiver.h"
#include "ValueError.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarBirdTargets.h"
#include "vtkAvianLidarBirds.h"
#include "vtkAvianLidarCoverageTable.h"
#include "vtkAvianLidarEchoOutput.h"
#include "vtkAvianLidarGuard.h"
#include "vtkAvianLidarImageArrays.h"
#include "vtkAvianLidarMovers.h"
#include "vtkAvianLidarPlaces.h"
#include "vtkAvianLidarRevolutions.h"
#include "vtkAvianLidarScanFilterInternals.h"

#include "vtkDataObjectTypes.h"
#include "vtkDataSet.h"
#include "vtkExecutive.h"
#include "vtkExtentTranslator.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTable.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

vtkStandardNewMacro(vtkAvianLidarCoverage);

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using Outcome = vtkAvianLidarRanks::Outcome;
using Pipeline = vtkStreamingDemandDrivenPipeline;
using avianlidar::CoverageShares;
using avianlidar::CoverageSight;
using avianlidar::CoverageStatus;
using avianlidar::Vec3;

constexpr std::size_t PlacesOfBlock = 1 << 12;
/// Targets that are kept.
constexpr std::size_t MostMade = 16;
/// Of the progress: static scan, lines of sight, and the rest.
constexpr double ScanShare = 0.4;
constexpr double ViewShare = 0.9;
/// View and arrays of a place.
constexpr double BytesPerPlace = sizeof(CoverageSight) + 4 * sizeof(float) + sizeof(int) + 1;

/// The part of the whole extent that belongs to the piece asked for, without ghosts; all of what is
/// asked for if there is one piece.
void MyPart(vtkInformation* info, int extent[6])
{
  info->Get(Pipeline::WHOLE_EXTENT(), extent);
  const int pieces = info->Get(Pipeline::UPDATE_NUMBER_OF_PIECES());
  if (pieces > 1)
  {
    int whole[6];
    std::copy(extent, extent + 6, whole);
    vtkNew<vtkExtentTranslator> translator;
    translator->PieceToExtentThreadSafe(info->Get(Pipeline::UPDATE_PIECE_NUMBER()), pieces, 0,
      whole, extent, vtkExtentTranslator::BLOCK_MODE, 0);
  }
}

std::uint64_t HashOf(const std::vector<Vec3>& values, std::uint64_t seed)
{
  return avianlidar::hashOf(values.data(), values.size() * sizeof(Vec3), seed);
}

/// The arrays of the places.
class PlaceArrays
{
public:
  explicit PlaceArrays(vtkIdType places)
    : Probability(Arrays::Make<vtkFloatArray>(Arrays::DetectionProbability, places))
    , Tracked(Arrays::Make<vtkFloatArray>(Arrays::TrackProbability, places))
    , Electrons(Arrays::Make<vtkFloatArray>(Arrays::Photoelectrons, places))
    , LeastArea(Arrays::Make<vtkFloatArray>(Arrays::MinimumEffectiveArea, places))
    , Held(Arrays::Make<vtkIntArray>(Arrays::BeamsPerScan, places))
    , Status(Arrays::Make<vtkUnsignedCharArray>(Arrays::Status, places))
  {
  }

  void Set(vtkIdType place, const avianlidar::CoverageValue& value, double track, int beams)
  {
    this->Probability->SetValue(place, static_cast<float>(value.probability));
    this->Tracked->SetValue(place, static_cast<float>(track));
    this->Electrons->SetValue(place, static_cast<float>(value.photoelectrons));
    this->LeastArea->SetValue(place, static_cast<float>(value.leastArea));
    this->Held->SetValue(place, beams);
    this->Status->SetValue(place, static_cast<unsigned char>(value.status));
  }

  void AddTo(vtkPointData* points) const
  {
    points->SetScalars(this->Probability);
    points->AddArray(this->Tracked);
    points->AddArray(this->Electrons);
    points->AddArray(this->Held);
    points->AddArray(this->LeastArea);
    points->AddArray(this->Status);
  }

private:
  vtkSmartPointer<vtkFloatArray> Probability, Tracked, Electrons, LeastArea;
  vtkSmartPointer<vtkIntArray> Held;
  vtkSmartPointer<vtkUnsignedCharArray> Status;
};

/// The echoes of a scan without noise, and in which share of scans with noise each is perceived.
void FillClutter(
  const avianlidar::ScanResult& still, const vtkAvianLidarBeams& beams, vtkPolyData* clutter)
{
  vtkAvianLidarEchoOutput::FillEchoes(still, beams, clutter);
  const avianlidar::Sensor& sensor = beams.sensor;
  const avianlidar::PhotonReceiver receiver(sensor);
  auto often = Arrays::Make<vtkDoubleArray>(
    Arrays::DetectionProbability, static_cast<vtkIdType>(still.echoes.size()));
  for (std::size_t e = 0; e < still.echoes.size(); ++e)
  {
    often->SetValue(static_cast<vtkIdType>(e),
      sensor.receiverModel == avianlidar::ReceiverModel::Photons
        ? receiver.detectionProbability(receiver.electronsPerJoule * still.echoes[e].energyReceived,
            receiver.electronsPerJoule * sensor.lowerEnergyLimit)
        : 1.0);
  }
  clutter->GetPointData()->AddArray(often);
}
}

//------------------------------------------------------------------------------
struct vtkAvianLidarCoverage::vtkTargets
{
  vtkAvianLidarBirdTargets Birds;
  std::vector<vtkAvianLidarBirdTargets::Target> Wanted; ///< the first is shown
  vtkAvianLidarPlaces Places;
  std::vector<CoverageSight> Sights;
  std::uint64_t SightsOf = 0;                    ///< hash of what lines of sight depend on
  std::unique_ptr<avianlidar::Coverage> Covered; ///< null without beams
  std::uint64_t DirectionsOf = 0;                ///< hash of what its BeamDirections depend on
  /// Targets, each after what it depends on.
  std::vector<std::pair<std::vector<double>, std::shared_ptr<const avianlidar::CoverageTarget>>>
    Made;
  double TracedPlaces = 0.0;

  /// All that decides a bit of the results, but for what the superclass has compared.
  static vtkAvianLidarRanks::Settings SettingsOf(const vtkAvianLidarCoverage& self, bool hasPlaces);

  /// A target; the last ones are kept, as they are the same from site to site.
  std::shared_ptr<const avianlidar::CoverageTarget> Make(const avianlidar::Sensor& sensor,
    double air, double reflectance, const vtkAvianLidarBirdTargets::Target& bird)
  {
    const int mostBeams = this->Covered ? this->Covered->mostBeams() : 1;
    const avianlidar::PhotonReceiver receiver(sensor);
    std::vector<double> of = { air, reflectance, static_cast<double>(mostBeams),
      static_cast<double>(sensor.receiverModel), sensor.lowerEnergyLimit, sensor.pulseWidth,
      sensor.samplingInterval, receiver.electronsPerJoule, receiver.background,
      receiver.darkVariance, receiver.excess, bird.Area };
    for (const avianlidar::TargetPose& pose : bird.Poses)
    {
      of.insert(of.end(), { pose.area, pose.horizontal, pose.vertical, pose.depth });
    }
    const auto found = std::find_if(
      this->Made.begin(), this->Made.end(), [&](const auto& made) { return made.first == of; });
    if (found != this->Made.end())
    {
      return found->second;
    }
    auto target = std::make_shared<const avianlidar::CoverageTarget>(
      sensor, air, bird.Area, reflectance, bird.Poses, mostBeams);
    if (this->Made.size() >= MostMade)
    {
      this->Made.erase(this->Made.begin());
    }
    this->Made.emplace_back(std::move(of), target);
    return target;
  }
};

//------------------------------------------------------------------------------
vtkAvianLidarCoverage::vtkAvianLidarCoverage()
  : Targets(new vtkTargets)
{
  this->Visibility = 23000.0; // a clear day
  this->SetNumberOfInputPorts(3);
  this->SetNumberOfOutputPorts(3);
}

//------------------------------------------------------------------------------
vtkAvianLidarCoverage::~vtkAvianLidarCoverage() = default;

//------------------------------------------------------------------------------
void vtkAvianLidarCoverage::AddHeightLimit(double height)
{
  this->HeightLimits.push_back(height);
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkAvianLidarCoverage::RemoveAllHeightLimits()
{
  if (!this->HeightLimits.empty())
  {
    this->HeightLimits.clear();
    this->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkAvianLidarCoverage::GetNumberOfHeightLimits() const
{
  return static_cast<int>(this->HeightLimits.size());
}

//------------------------------------------------------------------------------
double vtkAvianLidarCoverage::GetHeightLimit(int index)
{
  if (index < 0 || index >= this->GetNumberOfHeightLimits())
  {
    vtkErrorMacro("HeightLimit: there is no entry " << index << ", expected 0 to "
                                                    << this->GetNumberOfHeightLimits() - 1 << ".");
    return 0.0;
  }
  return this->HeightLimits[index];
}

//------------------------------------------------------------------------------
double vtkAvianLidarCoverage::GetNumberOfTracedPlaces() const
{
  return this->Targets->TracedPlaces;
}

//------------------------------------------------------------------------------
int vtkAvianLidarCoverage::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port == 2)
  {
    info->Set(INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
    info->Set(INPUT_IS_OPTIONAL(), 1);
    return 1;
  }
  return this->Superclass::FillInputPortInformation(port, info);
}

//------------------------------------------------------------------------------
int vtkAvianLidarCoverage::FillOutputPortInformation(int port, vtkInformation* info)
{
  const char* types[] = { "vtkDataSet", "vtkTable", "vtkPolyData" };
  info->Set(vtkDataObject::DATA_TYPE_NAME(), types[port]);
  return 1;
}

//------------------------------------------------------------------------------
vtkTypeBool vtkAvianLidarCoverage::ProcessRequest(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return request->Has(vtkDemandDrivenPipeline::REQUEST_DATA_OBJECT())
    ? this->RequestDataObject(inputVector, outputVector)
    : this->Superclass::ProcessRequest(request, inputVector, outputVector);
}

//------------------------------------------------------------------------------
int vtkAvianLidarCoverage::RequestDataObject(
  vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkDataSet* places = vtkDataSet::GetData(inputVector[2]);
  const char* const types[] = { places ? places->GetClassName() : "vtkImageData", "vtkTable",
    "vtkPolyData" };
  for (int port = 0; port < 3; ++port)
  {
    vtkInformation* info = outputVector->GetInformationObject(port);
    vtkDataObject* output = vtkDataObject::GetData(info);
    if (!output || std::string(output->GetClassName()) != types[port])
    {
      const auto made = vtkSmartPointer<vtkDataObject>::Take(port == 0 && places
          ? places->NewInstance()
          : vtkDataObjectTypes::NewDataObject(types[port]));
      info->Set(vtkDataObject::DATA_OBJECT(), made);
      this->GetOutputPortInformation(port)->Set(
        vtkDataObject::DATA_EXTENT_TYPE(), made->GetExtentType());
    }
  }
  return 1;
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarCoverage::CheckRegion() const
{
  for (int axis = 0; axis < 3; ++axis)
  {
    const double least = this->Bounds[2 * axis];
    const double most = this->Bounds[2 * axis + 1];
    if (!avianlidar::checkPosition(Vec3(least, most, 0.0)).empty() || !(least <= most))
    {
      return avianlidar::valueError("Bounds", least <= most ? most : least,
        "finite, up to 1e30 m, and the lower bound no more than the upper");
    }
    if (!(this->Spacing[axis] > 0.0) || !std::isfinite(this->Spacing[axis]))
    {
      return avianlidar::valueError("Spacing", this->Spacing[axis], "above 0 m");
    }
    const double along = this->CountAlong(axis);
    if (!(along < std::numeric_limits<int>::max()))
    {
      return avianlidar::valueError(
        "Spacing", this->Spacing[axis], "such that fewer than 2147483647 points lie along an axis");
    }
  }
  return {};
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarCoverage::CheckTarget() const
{
  vtkAvianLidarBirds::CheckReflectance(this->Reflectance);
  if (!(this->Reflectance > 0.0))
  {
    return avianlidar::valueError("Reflectance", this->Reflectance, "above 0 to 1");
  }
  if (!(this->EffectiveArea >= 0.0) || !(this->EffectiveArea <= 1e6) ||
    (this->Species.empty() && this->EffectiveArea == 0.0))
  {
    return avianlidar::valueError("EffectiveArea", this->EffectiveArea,
      this->Species.empty() ? "above 0 to 1e6 m2 without a species" : "0 to 1e6 m2");
  }
  if (this->NumberOfScans < 1 || this->NumberOfScans > avianlidar::MostScans)
  {
    return avianlidar::valueError("NumberOfScans", this->NumberOfScans, "1 to 100");
  }
  if (this->RequiredDetections < 1 || this->RequiredDetections > this->NumberOfScans)
  {
    return avianlidar::valueError(
      "RequiredDetections", this->RequiredDetections, "1 to NumberOfScans");
  }
  for (std::size_t i = 0; i < this->HeightLimits.size(); ++i)
  {
    if (!std::isfinite(this->HeightLimits[i]) ||
      (i > 0 && !(this->HeightLimits[i] > this->HeightLimits[i - 1])))
    {
      return avianlidar::valueError("HeightLimits", this->HeightLimits[i], "finite and rising m");
    }
  }
  return {};
}

//------------------------------------------------------------------------------
double vtkAvianLidarCoverage::CountAlong(int axis) const
{
  const double length = this->Bounds[2 * axis + 1] - this->Bounds[2 * axis];
  return std::floor(length / this->Spacing[axis] * (1.0 + 1e-12)) + 1.0;
}

//------------------------------------------------------------------------------
int vtkAvianLidarCoverage::RequestInformation(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (!this->Superclass::RequestInformation(request, inputVector, outputVector))
  {
    return 0;
  }
  vtkInformation* info = outputVector->GetInformationObject(0);
  vtkInformation* places = inputVector[2]->GetInformationObject(0);
  // Where there are no extents VTK would make some of nothing.
  info->Remove(CAN_PRODUCE_SUB_EXTENT());
  if (!places || places->Has(Pipeline::WHOLE_EXTENT()))
  {
    info->Set(CAN_PRODUCE_SUB_EXTENT(), 1);
  }
  if (places)
  {
    info->CopyEntry(places, Pipeline::WHOLE_EXTENT());
    info->CopyEntry(places, vtkDataObject::ORIGIN());
    info->CopyEntry(places, vtkDataObject::SPACING());
    info->CopyEntry(places, vtkDataObject::DIRECTION());
    vtkDataObject::SetPointDataActiveScalarInfo(info, VTK_FLOAT, 1);
    return 1;
  }
  // What is wrong with the region is said in RequestData.
  int extent[6] = { 0, 0, 0, 0, 0, 0 };
  const double origin[3] = { this->Bounds[0], this->Bounds[2], this->Bounds[4] };
  const std::string problem =
    vtkAvianLidarGuard::ProblemOf([this]() { return this->CheckRegion(); });
  for (int axis = 0; axis < 3 && problem.empty(); ++axis)
  {
    extent[2 * axis + 1] = static_cast<int>(this->CountAlong(axis)) - 1;
  }
  info->Set(Pipeline::WHOLE_EXTENT(), extent, 6);
  info->Set(vtkDataObject::ORIGIN(), origin, 3);
  info->Set(vtkDataObject::SPACING(), this->Spacing, 3);
  vtkDataObject::SetPointDataActiveScalarInfo(info, VTK_FLOAT, 1);
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarCoverage::RequestUpdateExtent(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (!this->Superclass::RequestUpdateExtent(request, inputVector, outputVector))
  {
    return 0;
  }
  // Whichever output is asked for, the places are those of its piece.
  vtkInformation* info = outputVector->GetInformationObject(0);
  const int port = request->Get(vtkExecutive::FROM_OUTPUT_PORT());
  if (port > 0)
  {
    vtkInformation* asked = outputVector->GetInformationObject(port);
    info->CopyEntry(asked, Pipeline::UPDATE_PIECE_NUMBER());
    info->CopyEntry(asked, Pipeline::UPDATE_NUMBER_OF_PIECES());
    info->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
    if (info->Has(Pipeline::WHOLE_EXTENT()))
    {
      info->Set(Pipeline::UPDATE_EXTENT(), info->Get(Pipeline::WHOLE_EXTENT()), 6); // to be cut
    }
  }
  // All beams for each place.
  vtkInformation* beams = inputVector[0]->GetInformationObject(0);
  beams->Set(Pipeline::UPDATE_PIECE_NUMBER(), 0);
  beams->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1);
  vtkInformation* places = inputVector[2]->GetInformationObject(0);
  if (!places)
  {
    return 1;
  }
  for (auto* key : { Pipeline::UPDATE_PIECE_NUMBER(), Pipeline::UPDATE_NUMBER_OF_PIECES(),
         Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS() })
  {
    places->CopyEntry(info, key);
  }
  if (places->Has(Pipeline::WHOLE_EXTENT()) && info->Has(Pipeline::UPDATE_EXTENT()))
  {
    places->CopyEntry(info, Pipeline::UPDATE_EXTENT());
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarCoverage::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkInternals& in = *this->Internals;
  in.TracedRays = in.TracedBeams = this->Targets->TracedPlaces = 0.0;
  in.Setup.settings.noise = false;
  in.Setup.settings.returnMode = avianlidar::ReturnMode::RangeUnits;
  const int done = vtkAvianLidarRanks::Execute(this, request, outputVector,
    [&](const vtkAvianLidarRanks& ranks) -> int
    {
      vtkPolyData* beams = vtkPolyData::GetData(inputVector[0]);
      vtkDataObject* surfaces = vtkDataObject::GetData(inputVector[1]);
      vtkDataSet* output = vtkDataSet::GetData(outputVector, 0);
      vtkTable* table = vtkTable::GetData(outputVector, 1);
      vtkPolyData* clutter = vtkPolyData::GetData(outputVector, 2);
      vtkAvianLidarRevolutions::NoteTime(request, outputVector);
      vtkInformation* info = outputVector->GetInformationObject(0);
      const int piece = info->Get(Pipeline::UPDATE_PIECE_NUMBER());
      const bool done = this->PrepareBeams(ranks, beams) && this->PrepareTargets(ranks) &&
        this->PreparePlaces(ranks, vtkDataSet::GetData(inputVector[2]), info) &&
        this->PrepareSurfaces(ranks, surfaces) && this->PrepareTree(ranks, surfaces) &&
        this->View(ranks, piece == 0, clutter) && this->Evaluate(ranks, output, table);
      if (done)
      {
        const Outcome filled = ranks.Together(this,
          [&]() -> std::string
          {
            for (vtkDataObject* made : { static_cast<vtkDataObject*>(output),
                   static_cast<vtkDataObject*>(table), static_cast<vtkDataObject*>(clutter) })
            {
              this->MakeFields(beams->GetFieldData(), made->GetFieldData());
            }
            return {};
          });
        if (in.GoOn(filled))
        {
          return 1;
        }
      }
      for (vtkDataObject* made : { static_cast<vtkDataObject*>(output),
             static_cast<vtkDataObject*>(table), static_cast<vtkDataObject*>(clutter) })
      {
        made->Initialize();
      }
      return in.Last == Outcome::Failed ? 0 : 1; // stopped: empty and valid
    });
  return done && vtkAvianLidarImageArrays::FillIfFailed(this, outputVector);
}

//------------------------------------------------------------------------------
bool vtkAvianLidarCoverage::PrepareTargets(const vtkAvianLidarRanks& ranks)
{
  vtkInternals& in = *this->Internals;
  return in.GoOn(ranks.Together(this,
    [&]() -> std::string
    {
      const std::string problem = vtkInternals::WrongWithBeams(
        in.Beams.beams.size() > 0 ? avianlidar::checkOrigins(in.Beams.beams) : "");
      if (!problem.empty())
      {
        return problem;
      }
      const std::string target = this->CheckTarget();
      if (!target.empty())
      {
        return target;
      }
      in.Beams.total = in.Beams.beams.size(); // all of them, on every rank
      this->Targets->Wanted = this->Targets->Birds.Choose(
        this->Species, this->SpeciesFileName, this->Gliding, this->EffectiveArea, this->AllSpecies);
      return {};
    }));
}

//------------------------------------------------------------------------------
vtkAvianLidarRanks::Settings vtkAvianLidarCoverage::vtkTargets::SettingsOf(
  const vtkAvianLidarCoverage& self, bool hasPlaces)
{
  vtkAvianLidarRanks::Settings all;
  all.Add("Input port 2 (places)", hasPlaces ? "connected" : "not connected");
  all.Add("The checksum of input port 0 (beams)", self.Internals->Beams.Hash());
  for (int i = 0; i < 6 && !hasPlaces; ++i)
  {
    all.Add("Bounds", self.Bounds[i]);
  }
  for (int i = 0; i < 3 && !hasPlaces; ++i)
  {
    all.Add("Spacing", self.Spacing[i]);
  }
  all.Add("AllSpecies", self.AllSpecies);
  all.Add("The number of species", self.Targets->Wanted.size());
  for (const vtkAvianLidarBirdTargets::Target& target : self.Targets->Wanted)
  {
    all.Add("Species", target.Name);
    all.Add("EffectiveArea", target.Area);
  }
  all.Add("Gliding", self.Gliding);
  all.Add("Reflectance", self.Reflectance);
  all.Add("Clutter", self.Clutter);
  all.Add("RequiredDetections", self.RequiredDetections);
  all.Add("NumberOfScans", self.NumberOfScans);
  all.Add("The number of HeightLimits", self.HeightLimits.size());
  for (const double limit : self.HeightLimits)
  {
    all.Add("HeightLimits", limit);
  }
  all.Add("StrikeHeightWeights", self.StrikeHeightWeights);
  return all;
}

//------------------------------------------------------------------------------
bool vtkAvianLidarCoverage::PreparePlaces(
  const vtkAvianLidarRanks& ranks, vtkDataSet* places, vtkInformation* info)
{
  if (!this->Internals->GoOn(ranks.AgreeOn(this, vtkTargets::SettingsOf(*this, places != nullptr))))
  {
    return false;
  }
  const Outcome read = ranks.Together(this,
    [&]() -> std::string
    {
      vtkAvianLidarPlaces& where = this->Targets->Places;
      where = {};
      // Before they are walked. As many as before have their memory.
      const auto require = [this](double count)
      {
        if (count != static_cast<double>(this->Targets->Sights.size()))
        {
          avianlidar::requireMemory(count, "places", BytesPerPlace * count);
        }
      };
      if (places)
      {
        const std::string problem = vtkAvianLidarGuard::ProblemOf(
          [&]() -> std::string
          {
            require(vtkAvianLidarPlaces::CountOf(places));
            where = vtkAvianLidarPlaces(places);
            if (info->Has(Pipeline::WHOLE_EXTENT()))
            {
              int mine[6];
              MyPart(info, mine);
              where.SetMine(mine, info->Get(Pipeline::WHOLE_EXTENT()));
            }
            return {};
          });
        return problem.empty() ? problem : "Input port 2 (places), " + problem;
      }
      const std::string problem = this->CheckRegion();
      if (problem.empty())
      {
        const double origin[3] = { this->Bounds[0], this->Bounds[2], this->Bounds[4] };
        int mine[6];
        MyPart(info, mine);
        where = vtkAvianLidarPlaces(info->Get(Pipeline::UPDATE_EXTENT()), origin, this->Spacing);
        require(static_cast<double>(where.Size()));
        where.SetMine(mine, info->Get(Pipeline::WHOLE_EXTENT()));
      }
      return problem;
    });
  if (!this->Internals->GoOn(read))
  {
    return false;
  }
  if (!ranks.Alone())
  {
    this->Targets->Places.ShareRegions(ranks);
  }
  return true;
}

//------------------------------------------------------------------------------
bool vtkAvianLidarCoverage::View(
  const vtkAvianLidarRanks& ranks, bool isFirst, vtkPolyData* clutter)
{
  vtkInternals& in = *this->Internals;
  vtkTargets& targets = *this->Targets;
  const auto keepGoing = [this](double from, double to)
  {
    return [this, from, to](double fraction)
    {
      this->UpdateProgress(from + (to - from) * fraction);
      return !vtkAvianLidarAbort::Wanted(this);
    };
  };
  const auto require = [](bool done)
  {
    if (!done)
    {
      throw avianlidar::WorkStopped{};
    }
  };
  return in.GoOn(ranks.Together(this,
    [&]() -> std::string
    {
      in.Setup.largestReflectance = in.Summary.largestReflectance();
      in.Setup.largestGain = in.Summary.largestGain();
      avianlidar::planModel(in.Setup);
      avianlidar::ScanResult still;
      const auto limit = static_cast<std::size_t>(this->MaximumCacheSize) << 20;
      require(!this->Clutter ||
        avianlidar::simulateScan(in.Setup, in.Beams.beams, in.Threads, in.Cache, limit,
          keepGoing(vtkInternals::BuildShare, ScanShare), still));
      in.TracedRays = static_cast<double>(still.raysTraced);
      in.TracedBeams = static_cast<double>(still.beamsTraced);
      const avianlidar::Sensor& sensor = in.Setup.sensor;
      const std::uint64_t directions = HashOf(
        in.Beams.beams.directions, avianlidar::hashOf(&sensor.halfBeamwidth, sizeof(double), 0));
      // In order: of an exclusive or, parts that are equal would leave nothing.
      const std::uint64_t parts[] = { directions, targets.Places.Hash(), in.Geometry };
      const std::uint64_t sights = HashOf(in.Beams.beams.origins,
        avianlidar::hashOf(
          &sensor.rangeGate, sizeof(double), avianlidar::hashOf(parts, sizeof(parts), 0)));
      const std::size_t count = targets.Places.Size();
      const auto known = targets.Covered && targets.DirectionsOf == directions
        ? targets.Covered->directions()
        : nullptr;
      targets.Covered.reset();
      if (in.Beams.beams.size() > 0)
      {
        targets.Covered = std::make_unique<avianlidar::Coverage>(
          in.Setup, in.Beams.beams, Vec3(0.0, 0.0, 1.0), still, known);
        targets.DirectionsOf = directions;
      }
      if (targets.SightsOf != sights || targets.Sights.size() != count)
      {
        targets.SightsOf = 0;
        targets.Sights.assign(count, CoverageSight());
        require(!targets.Covered ||
          targets.Covered->look([&](std::size_t k) { return targets.Places.At(k); }, count,
            in.Threads, keepGoing(ScanShare, ViewShare), targets.Sights.data()));
        targets.TracedPlaces = static_cast<double>(count);
        targets.SightsOf = sights;
      }
      if (isFirst)
      {
        FillClutter(still, in.Beams, clutter);
      }
      return {};
    }));
}

//------------------------------------------------------------------------------
bool vtkAvianLidarCoverage::Evaluate(
  const vtkAvianLidarRanks& ranks, vtkDataSet* output, vtkTable* table)
{
  vtkInternals& in = *this->Internals;
  vtkTargets& targets = *this->Targets;
  const std::size_t count = targets.Places.Size();
  vtkAvianLidarCoverageTable sums;
  sums.regions = targets.Places.RegionNames();
  sums.heightLimits = this->HeightLimits;
  for (const auto& bird : targets.Wanted)
  {
    sums.species.push_back(bird.Name);
  }
  const Outcome done = ranks.Together(this,
    [&]() -> std::string
    {
      sums.sums.resize(sums.species.size() * sums.Cells());
      PlaceArrays arrays(static_cast<vtkIdType>(count));
      for (std::size_t t = 0; t < targets.Wanted.size(); ++t)
      {
        const auto target = targets.Make(in.Setup.sensor, in.Setup.settings.attenuationCoefficient,
          this->Reflectance, targets.Wanted[t]);
        std::vector<std::map<std::size_t, CoverageShares>> ofBlock(
          (count + PlacesOfBlock - 1) / PlacesOfBlock);
        const auto body = [&](std::size_t begin, std::size_t end, int)
        {
          auto& own = ofBlock[begin / PlacesOfBlock];
          for (std::size_t k = begin; k < end; ++k)
          {
            const avianlidar::CoverageValue value = targets.Covered
              ? targets.Covered->valueAt(targets.Places.At(k), targets.Sights[k], *target)
              : avianlidar::CoverageValue{ CoverageStatus::BetweenBeams };
            const double track = value.probability > 0.0
              ? avianlidar::trackProbability(
                  value.probability, this->RequiredDetections, this->NumberOfScans)
              : 0.0;
            if (t == 0)
            {
              arrays.Set(static_cast<vtkIdType>(k), value, track, targets.Sights[k].beams);
            }
            if (targets.Places.IsMine(k))
            {
              const double height = targets.Places.At(k).z;
              const auto band =
                std::upper_bound(this->HeightLimits.begin(), this->HeightLimits.end(), height);
              const double weight =
                this->StrikeHeightWeights ? avianlidar::strikeHeightDensity(height) : 1.0;
              const std::size_t cell = targets.Places.RegionOf(k) * sums.Bands() +
                static_cast<std::size_t>(band - this->HeightLimits.begin());
              own[cell].add(weight, value, track);
            }
          }
        };
        const auto keepGoing = [&](double fraction)
        {
          this->UpdateProgress(
            ViewShare + (1.0 - ViewShare) * (t + fraction) / targets.Wanted.size());
          return !vtkAvianLidarAbort::Wanted(this);
        };
        if (!avianlidar::parallelFor(count, PlacesOfBlock, in.Threads, body, keepGoing))
        {
          throw avianlidar::WorkStopped{};
        }
        for (const auto& block : ofBlock)
        {
          for (const auto& [cell, sum] : block)
          {
            sums.sums[t * sums.Cells() + cell].add(sum);
          }
        }
      }
      if (vtkDataSet* points = targets.Places.GetPoints())
      {
        output->ShallowCopy(points);
      }
      else
      {
        auto* image = vtkImageData::SafeDownCast(output);
        image->SetExtent(const_cast<int*>(targets.Places.GetExtent()));
        image->SetOrigin(targets.Places.GetOrigin());
        image->SetSpacing(targets.Places.GetSpacing());
      }
      arrays.AddTo(output->GetPointData());
      return {};
    });
  if (!in.GoOn(done))
  {
    return false;
  }
  if (!ranks.Alone())
  {
    sums.SumOverRanks(ranks);
  }
  return in.GoOn(ranks.Together(this,
    [&]() -> std::string
    {
      if (ranks.Rank() == 0)
      {
        sums.Fill(table);
      }
      return {};
    }));
}

//------------------------------------------------------------------------------
void vtkAvianLidarCoverage::MakeFields(vtkFieldData* beamFields, vtkFieldData* fields) const
{
  const vtkInternals& in = *this->Internals;
  vtkAvianLidarMovers still;
  still.objectNames = in.Surfaces.objectNames;
  still.materialNames = in.Surfaces.materialNames;
  still.objectClasses = in.Surfaces.objectClasses;
  vtkAvianLidarEchoOutput::FillFields(
    in.Setup, this->Preset, beamFields, still, in.Exchange.Fields, in.Scene, fields);
  const vtkAvianLidarBirdTargets::Target& shown = this->Targets->Wanted.front();
  Arrays::SetFieldStrings(fields, Arrays::StatusNames,
    std::vector<std::string>(
      std::begin(vtkAvianLidarCoverageStatusNames), std::end(vtkAvianLidarCoverageStatusNames)));
  Arrays::SetFieldStrings(fields, Arrays::Species, { shown.Name });
  Arrays::SetFieldValue(fields, Arrays::EffectiveArea, shown.Area);
  Arrays::SetFieldInteger(fields, { "gliding", "1" }, this->Gliding);
  Arrays::SetFieldValue(fields, { "reflectance", "1" }, this->Reflectance);
  Arrays::SetFieldValue(fields, { "visibility", "m" }, this->Visibility);
  Arrays::SetFieldInteger(fields, { "clutter", "1" }, this->Clutter);
  Arrays::SetFieldInteger(fields, { "required_detections", "1" }, this->RequiredDetections);
  Arrays::SetFieldInteger(fields, { "number_of_scans", "1" }, this->NumberOfScans);
  Arrays::SetFieldInteger(fields, { "strike_height_weights", "1" }, this->StrikeHeightWeights);
}

double vtkAvianLidarCoverage::StrikeHeightDensity(double height)
{
  return avianlidar::strikeHeightDensity(height);
}

//------------------------------------------------------------------------------
void vtkAvianLidarCoverage::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Bounds: " << this->Bounds[0] << " " << this->Bounds[1] << " " << this->Bounds[2]
     << " " << this->Bounds[3] << " " << this->Bounds[4] << " " << this->Bounds[5] << " m\n";
  os << indent << "Spacing: " << this->Spacing[0] << " " << this->Spacing[1] << " "
     << this->Spacing[2] << " m\n";
  os << indent << "Species: " << this->Species << "\n";
  os << indent << "SpeciesFileName: " << this->SpeciesFileName << "\n";
  os << indent << "Gliding: " << this->Gliding << "\n";
  os << indent << "EffectiveArea: " << this->EffectiveArea << " m2\n";
  os << indent << "Reflectance: " << this->Reflectance << "\n";
  os << indent << "Clutter: " << this->Clutter << "\n";
  os << indent << "RequiredDetections: " << this->RequiredDetections << "\n";
  os << indent << "NumberOfScans: " << this->NumberOfScans << "\n";
  os << indent << "HeightLimits:";
  for (const double limit : this->HeightLimits)
  {
    os << " " << limit;
  }
  os << " m\n";
  os << indent << "StrikeHeightWeights: " << this->StrikeHeightWeights << "\n";
  os << indent << "AllSpecies: " << this->AllSpecies << "\n";
}
