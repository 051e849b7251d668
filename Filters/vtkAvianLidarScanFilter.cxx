// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarScanFilter.h"

#include "Air.h"
#include "CollisionTreeBuilder.h"
#include "EchoSettings.h"
#include "ValueError.h"
#include "vtkAvianLidarAbort.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarMedia.h"
#include "vtkAvianLidarRequire.h"
#include "vtkAvianLidarRevolutions.h"
#include "vtkAvianLidarScanFilterInternals.h"
#include "vtkAvianLidarScene.h"
#include "vtkAvianLidarText.h"

#include "vtkDataObject.h"
#include "vtkDemandDrivenPipeline.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <utility>

namespace
{

constexpr char NoAperture[] = "air scatters (AirBackscatter, RainRate), expected beams of a "
                              "sensor with a receiver_aperture above 0, for example Search905";

/// Settings that decide the bits of the results. @param air attenuation coefficient, 1/m, not used
/// if `visibility` is above 0
vtkAvianLidarRanks::Settings SettingsOf(const avianlidar::EchoSettings& s, int preset,
  double visibility, double air, bool backscatter, double rain)
{
  vtkAvianLidarRanks::Settings all;
  all.Add("Preset", preset);
  all.Add("Visibility", visibility);
  all.Add("AirBackscatter", backscatter);
  all.Add("RainRate", rain);
  for (const avianlidar::EchoSetting& setting : avianlidar::echoSettings())
  {
    const bool isAir = setting.name == std::string("attenuation_coefficient");
    if (setting.effect != avianlidar::SettingEffect::None)
    {
      all.Add(setting.property, isAir ? (visibility > 0.0 ? 0.0 : air) : setting.get(s));
    }
  }
  return all;
}
}

vtkAvianLidarCxxRanksMacro(vtkAvianLidarScanFilter);

//------------------------------------------------------------------------------
const std::vector<vtkAvianLidarScanFilter::vtkInternals::Property>& vtkAvianLidarScanFilter::
  vtkInternals::Properties()
{
  using Self = vtkAvianLidarScanFilter;
  static const std::vector<Property> all = { { "Preset", &Self::Preset },
    { "RaysPerBeam", &Self::RaysPerBeam }, { "BeamSamples", &Self::BeamSamples },
    { "Sampling", &Self::Sampling }, { "Seed", &Self::Seed },
    { "AttenuationCoefficient", &Self::AttenuationCoefficient, " 1/m" },
    { "Visibility", &Self::Visibility, " m" }, { "AirBackscatter", &Self::AirBackscatter },
    { "RainRate", &Self::RainRate, " mm/h" }, { "ReflectanceModel", &Self::ReflectanceModel },
    { "NumberOfReflections", &Self::NumberOfReflections },
    { "BeamConstraint", &Self::BeamConstraint },
    { "LightEnergyConstraint", &Self::LightEnergyConstraint },
    { "LightEnergyFraction", &Self::LightEnergyFraction },
    { "LightEnergyThreshold", &Self::LightEnergyThreshold },
    { "BatchCollisionDetection", &Self::BatchCollisionDetection },
    { "FullModel", &Self::FullModel }, { "NumberOfConnections", &Self::NumberOfConnections },
    { "NumberOfThreads", &Self::NumberOfThreads },
    { "MaximumCacheSize", &Self::MaximumCacheSize, " MiB" } };
  return all;
}

//------------------------------------------------------------------------------
vtkAvianLidarScanFilter::vtkAvianLidarScanFilter()
  : Internals(new vtkInternals)
{
  this->SetController(vtkMultiProcessController::GetGlobalController());
  this->SetNumberOfInputPorts(2);
}

//------------------------------------------------------------------------------
vtkAvianLidarScanFilter::~vtkAvianLidarScanFilter() = default;

//------------------------------------------------------------------------------
void vtkAvianLidarScanFilter::SetController(vtkMultiProcessController* controller)
{
  if (controller != this->Controller)
  {
    // State and ranks belong to the old controller, whose address a new controller may have.
    this->Internals->State.clear();
    this->Internals->Beams.ForgetRanks();
  }
  vtkSetSmartPointerBodyMacro(Controller, vtkMultiProcessController, controller);
}

//------------------------------------------------------------------------------
int vtkAvianLidarScanFilter::FillInputPortInformation(int port, vtkInformation* info)
{
  // The inputs are optional, because VTK's own error would not say what to connect.
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  if (port == 0)
  {
    info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
    return 1;
  }
  // Both types are declared. Otherwise the pipeline would run the filter once per block, and blocks
  // would not hide each other.
  info->Remove(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE());
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
  return 1;
}

//------------------------------------------------------------------------------
std::string vtkAvianLidarScanFilter::MissingInput()
{
  const char* const inputs[] = { "beams) is not connected, expected the output Beams of a beam "
                                 "source (in ParaView: Edit > Change Input > Beams)",
    "surfaces) is not connected, expected polygonal data in metres, as of a scene reader or a "
    "collision tree (in ParaView: Edit > Change Input > Surfaces)" };
  for (int port = 0; port < 2; ++port)
  {
    if (this->GetNumberOfInputConnections(port) == 0)
    {
      return "Input port " + std::to_string(port) + " (" + inputs[port];
    }
  }
  return {};
}

//------------------------------------------------------------------------------
vtkTypeBool vtkAvianLidarScanFilter::ProcessRequest(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  // RequestData reports a missing input. Other requests are then skipped.
  const bool ready =
    request->Has(vtkDemandDrivenPipeline::REQUEST_DATA()) || this->MissingInput().empty();
  return ready ? this->Superclass::ProcessRequest(request, inputVector, outputVector) : 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarScanFilter::RequestInformation(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (!this->Superclass::RequestInformation(request, inputVector, outputVector))
  {
    return 0;
  }
  vtkAvianLidarRevolutions::ChooseSteps(inputVector, outputVector);
  return 1;
}

//------------------------------------------------------------------------------
int vtkAvianLidarScanFilter::RequestUpdateExtent(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (!this->Superclass::RequestUpdateExtent(request, inputVector, outputVector))
  {
    return 0;
  }
  vtkAvianLidarRevolutions::AskForStart(inputVector);
  if (!vtkAvianLidarRanks(this->Controller, request, outputVector).Alone())
  {
    return 1; // each rank requests its piece of all inputs and exchanges surfaces
  }
  // Whole inputs, except for the beams, because any surface may hide another surface.
  for (int port = 1; port < this->GetNumberOfInputPorts(); ++port)
  {
    vtkAvianLidarRanks::RequestAll(inputVector[port]);
  }
  return 1;
}

//------------------------------------------------------------------------------
void vtkAvianLidarScanFilter::PrepareSettings()
{
  avianlidar::EchoSettings& s = this->Internals->Setup.settings;
  const avianlidar::Sensor& sensor = this->Internals->Setup.sensor;
  for (const vtkInternals::Property& property : vtkInternals::Properties())
  {
    for (const avianlidar::EchoSetting& setting : avianlidar::echoSettings())
    {
      if (setting.property == std::string(property.name))
      {
        setting.set(s, property.ValueOf(*this));
      }
    }
  }
  if (this->Visibility > 0.0)
  {
    s.attenuationCoefficient = avianlidar::attenuationOfVisibility(
      this->Visibility, avianlidar::SpeedOfLight / sensor.frequency);
  }
  const bool isDense = this->Visibility > 0.0 && !(s.attenuationCoefficient <= 1e30);
  if (!(this->Visibility >= 0.0 && this->Visibility <= 1e9) || isDense)
  {
    vtkAvianLidarRequire(avianlidar::valueError(
      "Visibility", this->Visibility, "0, or up to 1e9 m and enough for air of at most 1e30 1/m"));
  }
  if (!(this->RainRate >= 0.0 && this->RainRate <= avianlidar::MaximumRainRate))
  {
    vtkAvianLidarRequire(avianlidar::valueError("RainRate", this->RainRate, "0 to 500 mm/h"));
  }
  std::vector<avianlidar::PlacedMedium>& media = this->Internals->Setup.media;
  media.clear();
  if (this->AirBackscatter && this->Visibility > 0.0)
  {
    media.push_back({ vtkAvianLidarMedia::HazeOf(this->Visibility, s.attenuationCoefficient), {} });
    s.attenuationCoefficient = 0.0;
  }
  if (this->RainRate > 0.0)
  {
    media.push_back({ vtkAvianLidarMedia::RainOf(this->RainRate, avianlidar::viewOf(sensor)), {} });
  }
  const bool hasAperture = media.empty() || sensor.receiverAperture > 0.0;
  vtkAvianLidarRequire(hasAperture ? "" : NoAperture);
  vtkAvianLidarRequire(
    avianlidar::applyPreset(static_cast<avianlidar::EchoPreset>(this->Preset), s));
  vtkAvianLidarRequire(avianlidar::checkSettings(s));
  vtkAvianLidarRequire(this->NumberOfThreads >= 0
      ? ""
      : "NumberOfThreads is negative, expected at least 0 (0: all cores)");
  vtkAvianLidarRequire(
    this->MaximumCacheSize >= 0 ? "" : "MaximumCacheSize is negative, expected at least 0 MiB");
  const std::string units = avianlidar::checkUnits(sensor, s);
  const std::string preset = this->Preset == PRESET_CUSTOM
    ? std::string()
    : " (Preset " + std::to_string(this->Preset) + " sets RaysPerBeam)";
  vtkAvianLidarRequire(
    units.empty() ? units : units + preset, "Input port 0 (beams), field data: ");
}

//------------------------------------------------------------------------------
void vtkAvianLidarScanFilter::PlaceMedia()
{
  vtkInternals& in = *this->Internals;
  const avianlidar::LidarView view = avianlidar::viewOf(in.Setup.sensor);
  if (in.MediaOf != in.Surfaces->media || !(in.MediaFor == view))
  {
    std::vector<avianlidar::PlacedMedium> read;
    for (const std::string& text : in.Surfaces->media)
    {
      for (const avianlidar::PlacedMedium& one : vtkAvianLidarMedia::Read(text, view))
      {
        read.push_back(one);
      }
    }
    in.Media.swap(read);
    in.MediaOf = in.Surfaces->media;
    in.MediaFor = view;
  }
  std::vector<avianlidar::PlacedMedium>& media = in.Setup.media;
  for (const avianlidar::PlacedMedium& placed : in.Media)
  {
    if (placed.volume.velocity != avianlidar::Vec3(0.0))
    {
      in.Beams.RequireTimes("the media that move (input port 1)");
    }
    media.push_back(placed);
  }
  std::stable_partition(media.begin(), media.end(),
    [](const avianlidar::PlacedMedium& one) { return one.fillsScene(); });
}

//------------------------------------------------------------------------------
void vtkAvianLidarScanFilter::AddAirTo(vtkFieldData* fields) const
{
  vtkAvianLidarArrays::SetFieldInteger(
    fields, vtkAvianLidarArrays::AirBackscatter, this->AirBackscatter);
  vtkAvianLidarArrays::SetFieldValue(fields, vtkAvianLidarArrays::RainRate, this->RainRate);
  std::vector<std::string> media;
  for (const std::string& text : this->Internals->Surfaces->media)
  {
    media.push_back(vtkAvianLidarMedia::InWords(text));
  }
  if (!media.empty())
  {
    vtkAvianLidarArrays::SetFieldStrings(fields, vtkAvianLidarArrays::Media, media);
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarScanFilter::PrepareBeams(const vtkAvianLidarRanks& ranks, vtkPolyData* input)
{
  vtkInternals& in = *this->Internals;
  vtkAvianLidarRequire(this->MissingInput());
  in.Beams.Read(input);
  in.Setup.sensor = in.Beams.sensor;
  in.Setup.revolution = in.Beams.revolution;
  this->PrepareSettings();
  ranks.AgreeOn(SettingsOf(in.Setup.settings, this->Preset, this->Visibility,
    this->AttenuationCoefficient, this->AirBackscatter, this->RainRate));
}

//------------------------------------------------------------------------------
void vtkAvianLidarScanFilter::PrepareSurfaces(const vtkAvianLidarRanks& ranks, vtkDataObject* input)
{
  vtkInternals& in = *this->Internals;
  auto state = vtkAvianLidarContent::StateOf(input);
  if (ranks.All(state == in.State && in.MergedBy == ranks.Group()))
  {
    return; // nothing was modified since the last execution
  }
  in.State.clear();
  const auto merged = vtkAvianLidarScene::FindSurfaces(input);
  const bool given = ranks.All(merged != nullptr) && ranks.Same(merged->Hash());
  if (given)
  {
    in.Exchange.Forget();
    in.Exchange.Fields = input->GetFieldData();
    in.Surfaces = merged;
  }
  else
  {
    in.Surfaces =
      in.Exchange.Merge(ranks, input, "Input port 1, ", this->NumberOfThreads, in.Surfaces);
  }
  this->SummariseSurfaces(input, ranks.Rank() == 0 && !given); // if given, the tree has warned
  in.State = std::move(state);
  in.MergedBy = ranks.Group();
}

//------------------------------------------------------------------------------
void vtkAvianLidarScanFilter::SummariseSurfaces(vtkDataObject* input, bool warn)
{
  vtkInternals& in = *this->Internals;
  in.Geometry = in.Surfaces->checksum;
  in.Setup.materials = in.Surfaces->materials;
  in.Setup.objectIds = in.Surfaces->objectIds;
  in.Setup.materialIds = in.Surfaces->materialIds;
  in.Summary = avianlidar::summarise(in.Setup);
  in.Scene = in.Surfaces->Hash();
  if (in.Warnings.IsNew(input, in.Geometry, in.Surfaces->warning) && warn)
  {
    vtkWarningMacro("Input port 1, " << vtkAvianLidarText(in.Surfaces->warning));
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarScanFilter::PrepareTree(const vtkAvianLidarRanks& ranks, vtkDataObject* input)
{
  vtkInternals& in = *this->Internals;
  this->PlaceMedia();
  in.Threads = ranks.Threads(this->NumberOfThreads);
  this->FindTree(input);
  if (!in.Setup.tree)
  {
    in.Setup.tree = in.OwnTree =
      avianlidar::buildCollisionTree(in.Surfaces->mesh, avianlidar::TreeOptions{},
        vtkAvianLidarAbort::KeepGoing(this, 0.0, vtkInternals::BuildShare), in.Threads);
    in.TreeBuilds += in.OwnTree != nullptr;
  }
  vtkAvianLidarAbort::Require(in.Setup.tree != nullptr);
  ranks.Meet(); // so that an error of one rank ends the execution before the scan
}

//------------------------------------------------------------------------------
void vtkAvianLidarScanFilter::FindTree(vtkDataObject* input)
{
  vtkInternals& in = *this->Internals;
  const std::uint64_t checksum = in.Geometry;
  const vtkAvianLidarScene::FoundTree found = vtkAvianLidarScene::FindTree(input, checksum);
  in.Setup.tree = found.tree;
  if (found.stale && in.StaleFor != checksum)
  {
    vtkWarningMacro("Input port 1: the collision tree that came with the surfaces belongs to "
                    "another geometry, so a new tree is built. Put the Collision Tree filter after "
                    "the filters that change the geometry.");
    in.StaleFor = checksum;
  }
  if (!in.Setup.tree && in.OwnTree && in.OwnTree->checksum == checksum)
  {
    in.Setup.tree = in.OwnTree;
  }
}

//------------------------------------------------------------------------------
double vtkAvianLidarScanFilter::GetNumberOfTracedRays() const
{
  return this->Internals->TracedRays;
}

//------------------------------------------------------------------------------
double vtkAvianLidarScanFilter::GetNumberOfTracedBeams() const
{
  return this->Internals->TracedBeams;
}

//------------------------------------------------------------------------------
int vtkAvianLidarScanFilter::GetNumberOfTreeBuilds() const
{
  return this->Internals->TreeBuilds;
}

//------------------------------------------------------------------------------
double vtkAvianLidarScanFilter::GetNumberOfBytesSent() const
{
  return this->Internals->Exchange.BytesSent;
}

//------------------------------------------------------------------------------
void vtkAvianLidarScanFilter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Controller: " << this->Controller << "\n";
  os << indent << "ErrorsAsData: " << this->ErrorsAsData << "\n";
  for (const vtkInternals::Property& property : vtkInternals::Properties())
  {
    os << indent << property.name << ": ";
    std::visit([&](auto of) { os << this->*of; }, property.member);
    os << property.unit << "\n";
  }
}
