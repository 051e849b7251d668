// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarCoverage.h"

#include "Air.h"
#include "AvailableMemory.h"
#include "CoverageSurvey.h"
#include "Hash.h"
#include "ValueError.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarBirdTargets.h"
#include "vtkAvianLidarBirds.h"
#include "vtkAvianLidarCoverageOutput.h"
#include "vtkAvianLidarEchoOutput.h"
#include "vtkAvianLidarGuard.h"
#include "vtkAvianLidarImageArrays.h"
#include "vtkAvianLidarMovers.h"
#include "vtkAvianLidarPlaces.h"
#include "vtkAvianLidarRequire.h"
#include "vtkAvianLidarRevolutions.h"
#include "vtkAvianLidarScanFilterInternals.h"

#include "vtkDataObjectTypes.h"
#include "vtkDataSet.h"
#include "vtkExecutive.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTable.h"

#include <vector>

vtkStandardNewMacro(vtkAvianLidarCoverage);

namespace
{
namespace Arrays = vtkAvianLidarArrays;
using Pipeline = vtkStreamingDemandDrivenPipeline;

/// Progress at the end of the static scan and at the end of the lines of sight.
constexpr double ScanShare = 0.4;
constexpr double ViewShare = 0.9;
/// Memory of a place, bytes: line of sight and arrays.
constexpr double BytesPerPlace =
  sizeof(avianlidar::CoverageSight) + 4 * sizeof(float) + sizeof(int) + 1;

/// Laws of all coverages of this process.
std::shared_ptr<avianlidar::DetectionLaws> SharedLaws()
{
  static const auto laws = std::make_shared<avianlidar::DetectionLaws>();
  return laws;
}
}

//------------------------------------------------------------------------------
struct vtkAvianLidarCoverage::vtkTargets
{
  vtkAvianLidarBirdTargets Birds;
  std::vector<vtkAvianLidarBirdTargets::Target> Wanted; ///< the image shows the first target
  vtkAvianLidarPlaces Places;
  avianlidar::CoverageSurvey Survey{ SharedLaws() };
  avianlidar::SurveyRules Rules;
  avianlidar::ScanResult Still; ///< last scan of the surfaces
  vtkNew<vtkPolyData> Clutter;  ///< echoes of `Still`
  std::uint64_t StillOf = 0;    ///< hash of the inputs of `Still`; 0: no scan
  std::shared_ptr<const avianlidar::CollisionTree> StillTree; ///< tree of `Still`
  double TracedPlaces = 0.0;
  bool Warned = false; ///< whether scans differed in the last execution

  /// Whether the next scan has other beams. @param beams beams of one scan
  static bool ScansDiffer(vtkPolyData* beams)
  {
    return beams->GetFieldData()->HasArray(vtkAvianLidarArrays::PrismWedgeAngles.name);
  }

  /// Settings that decide the bits of the results, except the settings of the superclass.
  static vtkAvianLidarRanks::Settings SettingsOf(const vtkAvianLidarCoverage& self, bool hasPlaces);

  /// Hash of everything that decides the scan of the surfaces: birds and places do not.
  static std::uint64_t StillHash(const vtkAvianLidarCoverage& self)
  {
    const vtkInternals& in = *self.Internals;
    std::vector<double> numbers = { self.Clutter ? 1.0 : 0.0 };
    for (const vtkInternals::Property& property : vtkInternals::Properties())
    {
      numbers.push_back(property.ValueOf(self));
    }
    const std::uint64_t parts[] = { in.Beams.HashOfAll(), in.Scene,
      avianlidar::hashOf(numbers.data(), numbers.size() * sizeof(double), 0) };
    return avianlidar::hashOf(parts, sizeof(parts), 1);
  }

  avianlidar::SurveyPlaces SurveyPlaces() const
  {
    return { [this](std::size_t k) { return this->Places.At(k); }, this->Places.Size(),
      this->Places.Hash(),
      [this](std::size_t k)
      {
        return this->Places.IsMine(k) ? this->Places.RegionOf(k)
                                      : avianlidar::SurveyPlaces::NoRegion;
      } };
  }
};

//------------------------------------------------------------------------------
vtkAvianLidarCoverage::vtkAvianLidarCoverage()
  : Targets(new vtkTargets)
{
  this->Visibility = avianlidar::ClearVisibility;
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
void vtkAvianLidarCoverage::CheckTarget() const
{
  vtkAvianLidarBirds::CheckReflectance(this->Reflectance);
  if (!(this->Reflectance > 0.0))
  {
    vtkAvianLidarRequire(avianlidar::valueError("Reflectance", this->Reflectance, "above 0 to 1"));
  }
  if (!(this->EffectiveArea >= 0.0) || !(this->EffectiveArea <= 1e6) ||
    (this->Species.empty() && this->EffectiveArea == 0.0))
  {
    vtkAvianLidarRequire(avianlidar::valueError("EffectiveArea", this->EffectiveArea,
      this->Species.empty() ? "above 0 to 1e6 m2 without a species" : "0 to 1e6 m2"));
  }
  vtkAvianLidarRequire(avianlidar::checkRules(this->Targets->Rules));
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
  // Without a whole extent, VTK must not request sub-extents.
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
  // RequestData reports errors of the region.
  int extent[6] = { 0, 0, 0, 0, 0, 0 };
  const double origin[3] = { this->Bounds[0], this->Bounds[2], this->Bounds[4] };
  const std::string problem = vtkAvianLidarGuard::ProblemOf([this]()
    { vtkAvianLidarRequire(vtkAvianLidarPlaces::CheckRegion(this->Bounds, this->Spacing)); });
  if (problem.empty())
  {
    vtkAvianLidarPlaces::ExtentOf(this->Bounds, this->Spacing, extent);
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
  // The piece requested from any output is the piece of the places.
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
      info->Set(Pipeline::UPDATE_EXTENT(), info->Get(Pipeline::WHOLE_EXTENT()), 6);
    }
  }
  // Each place may need any beam.
  vtkAvianLidarRanks::RequestAll(inputVector[0]);
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
    [&](const vtkAvianLidarRanks& ranks)
    {
      vtkPolyData* beams = vtkPolyData::GetData(inputVector[0]);
      vtkDataObject* surfaces = vtkDataObject::GetData(inputVector[1]);
      vtkDataSet* output = vtkDataSet::GetData(outputVector, 0);
      vtkTable* table = vtkTable::GetData(outputVector, 1);
      vtkPolyData* clutter = vtkPolyData::GetData(outputVector, 2);
      vtkAvianLidarRevolutions::NoteTime(request, outputVector);
      vtkInformation* info = outputVector->GetInformationObject(0);
      this->PrepareBeams(ranks, beams);
      this->PrepareTargets();
      this->PreparePlaces(ranks, vtkDataSet::GetData(inputVector[2]), info);
      this->PrepareSurfaces(ranks, surfaces);
      this->PrepareTree(ranks, surfaces);
      this->View(ranks, clutter);
      this->Evaluate(ranks, output, table);
      for (vtkDataObject* made : std::initializer_list<vtkDataObject*>{ output, table, clutter })
      {
        this->MakeFields(beams->GetFieldData(), made->GetFieldData());
      }
      const bool differ = vtkTargets::ScansDiffer(beams) && this->NumberOfScans > 1;
      if (differ && !this->Targets->Warned && ranks.Piece() == 0)
      {
        vtkWarningMacro("Input port 0 (beams): rotating prisms give each scan other beams. "
                        "track_probability assumes that all NumberOfScans have the beams of this "
                        "scan. detection_probability is right.");
      }
      this->Targets->Warned = differ;
    });
  return done && vtkAvianLidarImageArrays::FillIfFailed(this, outputVector);
}

//------------------------------------------------------------------------------
void vtkAvianLidarCoverage::PrepareTargets()
{
  vtkInternals& in = *this->Internals;
  vtkAvianLidarRequire(in.Beams.beams.size() > 0 ? avianlidar::checkOrigins(in.Beams.beams) : "",
    "Input port 0 (beams), ");
  this->Targets->Rules = { this->RequiredDetections, this->NumberOfScans, this->StrikeHeightWeights,
    this->HeightLimits };
  this->CheckTarget();
  in.Beams.total = in.Beams.beams.size(); // every rank has all beams
  this->Targets->Wanted = this->Targets->Birds.Choose(
    this->Species, this->SpeciesFileName, this->Gliding, this->EffectiveArea, this->AllSpecies);
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
  all.Add("PoseProbabilities", self.PoseProbabilities);
  return all;
}

//------------------------------------------------------------------------------
void vtkAvianLidarCoverage::PreparePlaces(
  const vtkAvianLidarRanks& ranks, vtkDataSet* places, vtkInformation* info)
{
  ranks.AgreeOn(vtkTargets::SettingsOf(*this, places != nullptr));
  vtkAvianLidarPlaces& where = this->Targets->Places;
  where = {};
  // Checked before the places are read. As many places as before already have memory.
  const auto require = [this](double count)
  {
    if (count != static_cast<double>(this->Targets->Survey.size()))
    {
      const double poses = this->PoseProbabilities
        ? static_cast<double>(this->Targets->Wanted.front().Views->poses)
        : 0.0;
      avianlidar::requireMemory(count, "places", (BytesPerPlace + sizeof(float) * poses) * count);
    }
  };
  if (places)
  {
    vtkAvianLidarWithin("Input port 2 (places), ",
      [&]()
      {
        require(vtkAvianLidarPlaces::CountOf(places));
        where = vtkAvianLidarPlaces(places);
      });
  }
  else
  {
    vtkAvianLidarRequire(vtkAvianLidarPlaces::CheckRegion(this->Bounds, this->Spacing));
    const double origin[3] = { this->Bounds[0], this->Bounds[2], this->Bounds[4] };
    where = vtkAvianLidarPlaces(info->Get(Pipeline::UPDATE_EXTENT()), origin, this->Spacing);
    require(static_cast<double>(where.Size()));
  }
  where.SetMine(info);
  if (!ranks.Alone())
  {
    this->Targets->Places.ShareRegions(ranks);
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarCoverage::View(const vtkAvianLidarRanks& ranks, vtkPolyData* clutter)
{
  vtkInternals& in = *this->Internals;
  vtkTargets& targets = *this->Targets;
  in.Setup.largestReflectance = in.Summary.largestReflectance;
  in.Setup.largestGain = in.Summary.largestGain;
  avianlidar::planModel(in.Setup);
  const auto limit = static_cast<std::size_t>(this->MaximumCacheSize) << 20;
  const std::uint64_t wanted = vtkTargets::StillHash(*this);
  if (targets.StillOf != wanted || targets.StillTree != in.Setup.tree)
  {
    targets.StillOf = 0;
    targets.StillTree = in.Setup.tree;
    targets.Still = {};
    vtkAvianLidarAbort::Require(!this->Clutter ||
      avianlidar::simulateScan(in.Setup, in.Beams.beams, in.Threads, in.Cache, limit,
        vtkAvianLidarAbort::KeepGoing(this, vtkInternals::BuildShare, ScanShare), targets.Still));
    in.TracedRays = static_cast<double>(targets.Still.raysTraced);
    in.TracedBeams = static_cast<double>(targets.Still.beamsTraced);
    targets.Clutter->Initialize();
    vtkAvianLidarFillClutter(targets.Still, in.Beams, targets.Clutter);
    targets.StillOf = wanted;
  }
  vtkAvianLidarAbort::Require(
    targets.Survey.look(in.Setup, in.Beams.beams, targets.Still, targets.SurveyPlaces(),
      in.Geometry, in.Threads, vtkAvianLidarAbort::KeepGoing(this, ScanShare, ViewShare)));
  targets.TracedPlaces = static_cast<double>(targets.Survey.traced());
  if (ranks.Piece() == 0)
  {
    clutter->CopyStructure(targets.Clutter);
    clutter->GetPointData()->PassData(targets.Clutter->GetPointData());
  }
  if (targets.Still.reports.size() * sizeof(avianlidar::BeamReport) +
      targets.Still.echoes.size() * sizeof(avianlidar::Echo) >
    limit)
  {
    targets.StillOf = 0;
    targets.Still = {};
  }
  ranks.Meet(); // before the long work
}

//------------------------------------------------------------------------------
void vtkAvianLidarCoverage::Evaluate(
  const vtkAvianLidarRanks& ranks, vtkDataSet* output, vtkTable* table)
{
  vtkInternals& in = *this->Internals;
  vtkTargets& targets = *this->Targets;
  vtkAvianLidarCoverageTable sums;
  sums.regions = targets.Places.RegionNames();
  sums.heightLimits = this->HeightLimits;
  for (const auto& bird : targets.Wanted)
  {
    sums.species.push_back(bird.Name);
  }
  sums.sums.resize(sums.species.size() * sums.Cells());
  vtkAvianLidarPlaceArrays arrays(static_cast<vtkIdType>(targets.Places.Size()),
    this->PoseProbabilities ? static_cast<int>(targets.Wanted.front().Views->poses) : 0);
  const std::size_t count = targets.Wanted.size();
  const double share = (1.0 - ViewShare) / static_cast<double>(count);
  for (std::size_t t = 0; t < count; ++t)
  {
    const vtkAvianLidarBirdTargets::Target& bird = targets.Wanted[t];
    avianlidar::CoverageSurvey::EachPlace setArrays;
    avianlidar::CoverageSurvey::PosesOf posesOf;
    if (t == 0)
    {
      setArrays = [&](std::size_t k, const avianlidar::CoverageValue& value, double track)
      { arrays.Set(static_cast<vtkIdType>(k), value, track); };
      if (this->PoseProbabilities)
      {
        posesOf = [&](std::size_t k) { return arrays.PosesOf(k); };
      }
    }
    vtkAvianLidarAbort::Require(targets.Survey.evaluate(
      { bird.Area, this->Reflectance, bird.Views }, targets.Rules, in.Threads,
      vtkAvianLidarAbort::KeepGoing(this, ViewShare + t * share, ViewShare + (t + 1) * share),
      setArrays, sums.sums.data() + t * sums.Cells(), posesOf));
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
  if (!ranks.Alone())
  {
    sums.SumOverRanks(ranks);
  }
  if (ranks.Rank() == 0)
  {
    sums.Fill(table);
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarCoverage::MakeFields(vtkFieldData* beamFields, vtkFieldData* fields) const
{
  const vtkInternals& in = *this->Internals;
  vtkAvianLidarMovers still;
  still.objectNames = in.Surfaces->objectNames;
  still.materialNames = in.Surfaces->materialNames;
  still.objectClasses = in.Surfaces->objectClasses;
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
  this->AddAirTo(fields);
  Arrays::SetFieldInteger(fields, { "clutter", "1" }, this->Clutter);
  Arrays::SetFieldInteger(fields, { "required_detections", "1" }, this->RequiredDetections);
  Arrays::SetFieldInteger(fields, { "number_of_scans", "1" }, this->NumberOfScans);
  Arrays::SetFieldInteger(fields, { "strike_height_weights", "1" }, this->StrikeHeightWeights);
  Arrays::SetFieldInteger(fields, { "pose_probabilities", "1" }, this->PoseProbabilities);
}

double vtkAvianLidarCoverage::StrikeHeightDensity(double height)
{
  return avianlidar::strikeHeightDensity(height);
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarCoverage::GetKnownSpecies()
{
  return vtkAvianLidarBirds::NamesOfSpecies(this->SpeciesFileName);
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
  os << indent << "PoseProbabilities: " << this->PoseProbabilities << "\n";
}
