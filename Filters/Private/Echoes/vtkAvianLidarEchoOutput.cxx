// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarEchoOutput.h"

#include "AvailableMemory.h"
#include "Figures.h"
#include "Hash.h"
#include "PhotonReceiver.h"
#include "vtkAvianLidarArrays.h"
#include "vtkAvianLidarCells.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTypeUInt64Array.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

namespace
{
namespace names = vtkAvianLidarArrays;
using avianlidar::Echo;
using avianlidar::ScanSetup;
using avianlidar::Vec3;

/// Set point i to position(i), with one vertex per point.
template <class F>
void SetVertices(vtkPolyData* poly, vtkIdType count, F position)
{
  auto points = names::MakePoints(count);
  double* place = vtkDoubleArray::SafeDownCast(points->GetData())->GetPointer(0);
  for (vtkIdType i = 0; i < count; ++i, place += 3)
  {
    const Vec3 p = position(static_cast<std::size_t>(i));
    place[0] = p.x;
    place[1] = p.y;
    place[2] = p.z;
  }
  poly->SetPoints(points);
  poly->SetVerts(vtkAvianLidarMakeCells(count, 1));
}

/// Add a point array whose value i is function(i).
template <class ArrayT, class F>
void Add(vtkPolyData* poly, const names::Name& name, F function)
{
  const vtkIdType count = poly->GetNumberOfPoints();
  auto array = names::Make<ArrayT>(name, count);
  auto* values = array->GetPointer(0);
  for (vtkIdType i = 0; i < count; ++i)
  {
    values[i] = static_cast<typename ArrayT::ValueType>(function(static_cast<std::size_t>(i)));
  }
  poly->GetPointData()->AddArray(array);
}

/// Add two point arrays: times and positions of poses.
template <class F>
void AddPoses(vtkPolyData* poly, const names::Name& time, const names::Name& position, F poseOf)
{
  Add<vtkDoubleArray>(poly, time, [&](std::size_t i) { return 1e6 * poseOf(i).time; });
  const vtkIdType count = poly->GetNumberOfPoints();
  auto positions = names::Make<vtkDoubleArray>(position, count, 3);
  for (vtkIdType i = 0; i < count; ++i)
  {
    positions->SetTuple(i, &poseOf(static_cast<std::size_t>(i)).position.x);
  }
  poly->GetPointData()->AddArray(positions);
}

/// Add a point array of the echoes from values of their beams, unless there are none.
template <std::size_t Size>
void AddOfBeams(vtkPolyData* poly, const names::Name& name,
  const std::vector<std::array<double, Size>>& values, const std::vector<std::size_t>& beamOf)
{
  if (values.empty())
  {
    return;
  }
  auto array = names::Make<vtkDoubleArray>(
    name, static_cast<vtkIdType>(beamOf.size()), static_cast<int>(Size));
  for (std::size_t i = 0; i < beamOf.size(); ++i)
  {
    array->SetTypedTuple(static_cast<vtkIdType>(i), values[beamOf[i]].data());
  }
  poly->GetPointData()->AddArray(array);
}

/// Position that the sensor reports for an echo at `range`, m.
Vec3 PointOnBeam(const vtkAvianLidarBeams& beams, std::size_t beam, double range)
{
  return beams.beams.origins[beam] + range * beams.ReportedDirection(beam);
}

double IntensityOf(double energy, const avianlidar::Sensor& sensor)
{
  const double width = sensor.upperEnergyLimit - sensor.lowerEnergyLimit;
  return width > 0.0
    ? 255.0 * std::min(1.0, std::max(0.0, (energy - sensor.lowerEnergyLimit) / width))
    : 255.0;
}

/// Add the point arrays of ids and angles of beams, for beams or echoes. beamOf(i) is the index of
/// the beam of point i.
template <class F>
void AddBeamArrays(const vtkAvianLidarBeams& beams, vtkPolyData* poly, F beamOf)
{
  Add<vtkIdTypeArray>(
    poly, names::BeamId, [&](std::size_t i) { return beams.beams.ids[beamOf(i)]; });
  Add<vtkIntArray>(poly, names::LaserId, [&](std::size_t i) { return beams.laserIds[beamOf(i)]; });
  Add<vtkDoubleArray>(
    poly, names::Azimuth, [&](std::size_t i) { return beams.azimuths[beamOf(i)]; });
  Add<vtkDoubleArray>(
    poly, names::VerticalAngle, [&](std::size_t i) { return beams.verticalAngles[beamOf(i)]; });
}

// Notes say what a scan left out and why. Notes follow only from the setup. The beam report says
// what was left out in each beam, which also depends on results of earlier scans.

/// The value with three digits, in the same way in all locales.
std::string Number(double value)
{
  return avianlidar::figures(value, 3);
}

std::string Joules(double value)
{
  return Number(value) + " J";
}

/// The energy with which each path is compared, in words.
std::string LimitOfPath(const ScanSetup& setup)
{
  return setup.settings.lightEnergyThreshold == avianlidar::LightEnergyThreshold::LimitPerRay
    ? "lower energy limit divided by the number of rays"
    : "lower energy limit";
}

/// A bound, and its share of the lower energy limit.
std::string OfLimit(const ScanSetup& setup, double bound)
{
  return Joules(bound) + " (" + Number(100.0 * bound / setup.sensor.lowerEnergyLimit) +
    " % of the lower energy limit)";
}

std::string Noise(const ScanSetup& setup)
{
  const avianlidar::NoisePlan& noise = setup.noise;
  if (!setup.settings.noise)
  {
    return "not modelled because Noise is off";
  }
  if (noise.active)
  {
    return "modelled; " + Number(noise.falseAlarmsPerBeam) + " false alarms expected per beam";
  }
  if (!(noise.bound > 0.0))
  {
    return "none: the sensor receives no noise photons";
  }
  return "left out: it changes a range unit by at most " + OfLimit(setup, noise.bound);
}

std::string TwoReflections(const ScanSetup& setup)
{
  if (setup.settings.numberOfReflections < 2)
  {
    return "not modelled because NumberOfReflections is 1";
  }
  if (!setup.needs.secondaryReflections)
  {
    return "left out: they return at most " + OfLimit(setup, setup.needs.secondaryBound) +
      " of a beam";
  }
  if (!avianlidar::dropsFaintPaths(setup.settings))
  {
    return "modelled";
  }
  return setup.settings.lightEnergyThreshold == avianlidar::LightEnergyThreshold::ShareOfLimit
    ? "modelled, without faint paths"
    : "modelled, without paths below the " + LimitOfPath(setup);
}

std::string FurtherReflections(const ScanSetup& setup)
{
  const std::string paths = "not modelled: paths over " +
    std::string(setup.settings.numberOfReflections > 1 ? "three" : "two") +
    " and more reflections" +
    (setup.settings.numberOfReflections > 2 && setup.sensor.receiverAperture > 0.0
        ? ", but for three over one mirror"
        : "");
  // The bound holds all light that surfaces send back. An aperture gathers a small, unknown share
  // of the light, so the bound is useless with an aperture. A bound above the limit is useless,
  // too.
  return setup.sensor.receiverAperture > 0.0 ||
      setup.needs.furtherBound > setup.sensor.lowerEnergyLimit
    ? paths
    : paths + ", which return at most " + OfLimit(setup, setup.needs.furtherBound) + " of a beam";
}

std::string FaintPaths(const ScanSetup& setup)
{
  if (avianlidar::dropsFaintPaths(setup.settings))
  {
    const std::string most = OfLimit(setup, setup.needs.lightEnergyBound);
    return setup.settings.lightEnergyThreshold == avianlidar::LightEnergyThreshold::ShareOfLimit
      ? "left out: at most " + most + " in a range unit"
      : "left out below the " + LimitOfPath(setup) +
        (setup.needs.lightEnergyBound > setup.sensor.lowerEnergyLimit
            ? std::string()
            : ": together at most " + most + " of a beam");
  }
  return std::string("followed to the end because ") +
    (setup.settings.fullModel ? "FullModel is on" : "LightEnergyConstraint is off");
}

bool HasCells(const ScanSetup& setup)
{
  return setup.settings.beamSamples == avianlidar::BeamSampleSource::Cells;
}

std::string SmallObjects(const ScanSetup& setup)
{
  return HasCells(setup) ? "more rays where an object_id would have few"
                         : "no extra rays because BeamSamples is Rays";
}

std::string Detail(const ScanSetup& setup)
{
  const double most = setup.needs.missedDetailEnergy;
  // An aperture gathers a small, unknown share of the light, so the note gives a share of the
  // pulse.
  return "missed with more than 5 % probability if " +
    (setup.sensor.receiverAperture > 0.0 ? "less than " +
          Number(100.0 * most / setup.sensor.pulseEnergy) + " % of the pulse meets it"
                                         : "it returns less than " + Joules(most)) +
    (HasCells(setup) ? " and it has no object_id of its own" : "");
}

std::string Planes(const ScanSetup& setup)
{
  return HasCells(setup)
    ? "integrated without rays where few triangles enter a beam, divided into cells where many do"
    : "sampled by rays, like everything else";
}

std::string PerceivableRange(const ScanSetup& setup)
{
  const double range = setup.needs.perceivableRange;
  if (std::isinf(range))
  {
    return "without end";
  }
  const bool far = range >= 1000.0;
  const bool photons = setup.sensor.receiverModel == avianlidar::ReceiverModel::Photons;
  return "nothing beyond " + (far ? Number(range / 1000.0) + " km" : Number(range) + " m") +
    (photons ? ", by its mean energy" : "");
}

std::string All(const ScanSetup& setup)
{
  if (!(setup.needs.skippedEnergyBound > 0.0))
  {
    return "nothing that the properties ask for";
  }
  if (setup.needs.skippedEnergyBound > setup.sensor.lowerEnergyLimit)
  {
    // A bound above the limit is useless.
    return "paths with two reflections below the lower energy limit";
  }
  return "at most " + OfLimit(setup, setup.needs.skippedEnergyBound) +
    " in a range unit of a beam with an echo";
}
/// Write what was modelled, and bounds of what was left out.
void SetNeeds(const avianlidar::ScanSetup& setup, vtkFieldData* fields)
{
  const avianlidar::ModelNeeds& needs = setup.needs;
  names::SetFieldInteger(fields, { "noise_modelled", "1" }, setup.noise.active);
  names::SetFieldValue(fields, { "noise_bound", "J" }, setup.noise.bound);
  names::SetFieldValue(fields, { "light_energy_constraint_bound", "J" }, needs.lightEnergyBound);
  names::SetFieldInteger(
    fields, { "secondary_reflections_modelled", "1" }, needs.secondaryReflections);
  names::SetFieldValue(fields, { "further_reflections_bound", "J" }, needs.furtherBound);
  names::SetFieldValue(fields, { "perceivable_range", "m" }, needs.perceivableRange);
  names::SetFieldValue(fields, { "skipped_energy_bound", "J" }, needs.skippedEnergyBound);
  names::SetFieldValue(fields, { "missed_detail_energy", "J" }, needs.missedDetailEnergy);
}

void SetSettings(const avianlidar::EchoSettings& s, vtkFieldData* fields)
{
  for (const avianlidar::EchoSetting& setting : avianlidar::echoSettings())
  {
    const names::Name name{ setting.name, setting.unit };
    setting.whole ? names::SetFieldInteger(fields, name, static_cast<int>(setting.get(s)))
                  : names::SetFieldValue(fields, name, setting.get(s));
  }
}
}

//------------------------------------------------------------------------------
void vtkAvianLidarEchoOutput::FillEchoes(const avianlidar::ScanResult& result,
  const vtkAvianLidarBeams& beams, const avianlidar::NoisePlan& noise, vtkPolyData* echoes)
{
  const std::vector<Echo>& all = result.echoes;
  SetVertices(echoes, static_cast<vtkIdType>(all.size()),
    [&](std::size_t i) { return PointOnBeam(beams, result.beamOfEcho[i], all[i].range); });
  Add<vtkDoubleArray>(echoes, names::Energy, [&](std::size_t i) { return all[i].energy; });
  Add<vtkDoubleArray>(
    echoes, names::EnergyReceived, [&](std::size_t i) { return all[i].energyReceived; });
  Add<vtkDoubleArray>(
    echoes, names::ReturnEnergy, [&](std::size_t i) { return all[i].returnEnergy; });
  Add<vtkDoubleArray>(
    echoes, names::EnergyStdError, [&](std::size_t i) { return all[i].energyStdError; });
  if (beams.sensor.receiverModel == avianlidar::ReceiverModel::Photons)
  {
    const auto receiverOf = [&](std::size_t i)
    { return avianlidar::PhotonReceiver(lookingAt(beams.sensor, all[i].background)); };
    const double perJoule = avianlidar::PhotonReceiver(beams.sensor).electronsPerJoule;
    const auto electronsOf = [&](std::size_t i) { return perJoule * all[i].energyReceived; };
    Add<vtkDoubleArray>(echoes, names::Photoelectrons, electronsOf);
    Add<vtkDoubleArray>(echoes, names::SignalToNoise,
      [&](std::size_t i) { return receiverOf(i).signalToNoise(electronsOf(i)); });
  }
  if (beams.sensor.seesDaylight())
  {
    Add<vtkDoubleArray>(
      echoes, names::SeenRadiance, [&](std::size_t i) { return all[i].background; });
  }
  Add<vtkDoubleArray>(echoes, names::Intensity,
    [&](std::size_t i) { return IntensityOf(all[i].energy, beams.sensor); });
  Add<vtkDoubleArray>(echoes, names::Distance, [&](std::size_t i) { return all[i].range; });
  const auto errorsOf = [&](double radiance)
  { return avianlidar::RangeErrors(lookingAt(beams.sensor, radiance), noise.ofRanges); };
  if (errorsOf(beams.sensor.backgroundRadiance).hasNoise())
  {
    Add<vtkDoubleArray>(echoes, names::DistanceStdError,
      [&](std::size_t i) { return errorsOf(all[i].background).deviation(all[i].energyReceived); });
  }
  const auto beamOf = [&](std::size_t i) { return result.beamOfEcho[i]; };
  AddBeamArrays(beams, echoes, beamOf);
  Add<vtkDoubleArray>(
    echoes, names::Timestamp, [&](std::size_t i) { return beams.timestamps[beamOf(i)]; });
  AddOfBeams(echoes, names::SensorPosition, beams.sensorPositions, result.beamOfEcho);
  AddOfBeams(echoes, names::SensorOrientation, beams.sensorOrientations, result.beamOfEcho);
  Add<vtkIntArray>(echoes, names::ReturnNumber, [&](std::size_t i) { return all[i].returnNumber; });
  Add<vtkIntArray>(
    echoes, names::NumberOfReturns, [&](std::size_t i) { return all[i].numberOfReturns; });
  Add<vtkIntArray>(echoes, names::ObjectId, [&](std::size_t i) { return all[i].objectId; });
  Add<vtkIntArray>(echoes, names::MaterialId, [&](std::size_t i) { return all[i].materialId; });
  Add<vtkDoubleArray>(echoes, names::LabelShare, [&](std::size_t i) { return all[i].labelShare; });
  Add<vtkDoubleArray>(echoes, names::IncidenceAngle,
    [&](std::size_t i) { return all[i].incidenceAngle * avianlidar::DegreesPerRadian; });
  Add<vtkDoubleArray>(
    echoes, names::SecondaryShare, [&](std::size_t i) { return all[i].secondaryShare; });
  echoes->GetPointData()->SetActiveScalars(names::Energy.name);
}

//------------------------------------------------------------------------------
void vtkAvianLidarEchoOutput::RequireMemoryForWholeBeams(const vtkAvianLidarBeams& beams)
{
  const double samples =
    avianlidar::rangeUnitsOf(beams.sensor, static_cast<double>(beams.beams.size())) *
    beams.sensor.samplesOfUnit();
  avianlidar::requireMemory(samples, "samples of waveforms (WaveformFloor is 0)",
    samples * avianlidar::Waveforms::BytesOfSample);
}

//------------------------------------------------------------------------------
void vtkAvianLidarEchoOutput::FillWaveforms(avianlidar::ScanResult& result,
  const vtkAvianLidarBeams& beams, vtkPolyData* echoes, vtkPolyData* waveforms)
{
  avianlidar::Waveforms& all = result.waveforms;
  const auto& shapes = all.shapes;
  Add<vtkDoubleArray>(echoes, names::EchoWidth, [&](std::size_t i) { return shapes[i].width; });
  Add<vtkDoubleArray>(
    echoes, names::EchoRiseTime, [&](std::size_t i) { return shapes[i].riseTime; });
  Add<vtkDoubleArray>(
    echoes, names::EchoAmplitude, [&](std::size_t i) { return shapes[i].amplitude; });
  Add<vtkDoubleArray>(
    echoes, names::EchoIntegral, [&](std::size_t i) { return shapes[i].integral; });
  Add<vtkIntArray>(echoes, names::EchoSamples, [&](std::size_t i) { return shapes[i].samples; });

  const double interval = beams.sensor.samplingInterval / beams.sensor.samplesOfUnit();
  const std::size_t samples = all.signal.size();
  const std::size_t stretches = all.stretches.size();
  std::vector<std::size_t> stretchOf(samples);
  auto times = names::Make<vtkDoubleArray>(names::SampleTime, static_cast<vtkIdType>(samples));
  auto ranges = names::Make<vtkDoubleArray>(names::Distance, static_cast<vtkIdType>(samples));
  auto points = names::MakePoints(static_cast<vtkIdType>(samples));
  auto offsets = vtkSmartPointer<vtkIdTypeArray>::New();
  auto ids = vtkSmartPointer<vtkIdTypeArray>::New();
  names::SetTuples(offsets.Get(), static_cast<vtkIdType>(stretches) + 1);
  names::SetTuples(ids.Get(), static_cast<vtkIdType>(samples));
  for (std::size_t s = 0; s < stretches; ++s)
  {
    const avianlidar::Waveforms::Stretch& stretch = all.stretches[s];
    offsets->SetValue(static_cast<vtkIdType>(s), static_cast<vtkIdType>(stretch.begin));
    for (std::size_t i = stretch.begin; i < all.endOf(s); ++i)
    {
      const auto number =
        static_cast<double>(stretch.first) + static_cast<double>(i - stretch.begin);
      const double time = (number + 0.5) * interval;
      const double range = 0.5 * avianlidar::SpeedOfLight * time;
      const Vec3 place = PointOnBeam(beams, stretch.beam, range);
      const auto id = static_cast<vtkIdType>(i);
      times->SetValue(id, time);
      ranges->SetValue(id, range);
      points->SetPoint(id, place.x, place.y, place.z);
      ids->SetValue(id, id);
      stretchOf[i] = s;
    }
  }
  offsets->SetValue(static_cast<vtkIdType>(stretches), static_cast<vtkIdType>(samples));
  waveforms->SetPoints(points);
  auto lines = vtkSmartPointer<vtkCellArray>::New();
  lines->SetData(offsets, ids);
  waveforms->SetLines(lines);
  waveforms->GetPointData()->AddArray(times);
  waveforms->GetPointData()->AddArray(ranges);
  const auto add = [&](const names::Name& name, std::vector<double>& values)
  {
    waveforms->GetPointData()->AddArray(names::MakeOf<vtkDoubleArray>(name, values));
    values = {};
  };
  if (beams.sensor.receiverModel == avianlidar::ReceiverModel::Photons)
  {
    const double perJoule = avianlidar::PhotonReceiver(beams.sensor).electronsPerJoule;
    Add<vtkDoubleArray>(
      waveforms, names::SignalElectrons, [&](std::size_t i) { return perJoule * all.signal[i]; });
  }
  add(names::Signal, all.signal);
  Add<vtkDoubleArray>(waveforms, names::Background,
    [&](std::size_t i) { return all.stretches[stretchOf[i]].background; });
  add(names::Sample, all.drawn);
  add(names::EnergyReceived, all.received);
  add(names::Threshold, all.threshold);
  waveforms->GetPointData()->SetActiveScalars(names::Signal.name);

  const auto beamOf = [&](std::size_t s) { return all.stretches[s].beam; };
  auto beamIds = names::Make<vtkIdTypeArray>(names::BeamId, static_cast<vtkIdType>(stretches));
  auto fired = names::Make<vtkDoubleArray>(names::Timestamp, static_cast<vtkIdType>(stretches));
  auto origins = names::Make<vtkDoubleArray>(names::Origin, static_cast<vtkIdType>(stretches), 3);
  for (std::size_t s = 0; s < stretches; ++s)
  {
    const auto id = static_cast<vtkIdType>(s);
    beamIds->SetValue(id, static_cast<vtkIdType>(beams.beams.ids[beamOf(s)]));
    fired->SetValue(id, beams.timestamps[beamOf(s)]);
    origins->SetTuple(id, &beams.beams.origins[beamOf(s)].x);
  }
  for (vtkDataArray* array : { static_cast<vtkDataArray*>(beamIds),
         static_cast<vtkDataArray*>(fired), static_cast<vtkDataArray*>(origins) })
  {
    waveforms->GetCellData()->AddArray(array);
  }
}

//------------------------------------------------------------------------------
void vtkAvianLidarEchoOutput::FillReport(const avianlidar::ScanResult& result,
  const vtkAvianLidarBeams& beams, const avianlidar::NoisePlan& noise, vtkPolyData* report)
{
  const auto& all = result.reports;
  const double noiseBound = noise.active ? 0.0 : noise.bound;
  const unsigned noiseSkipped = noiseBound > 0.0 ? avianlidar::SkippedNoise : 0u;
  const auto positionOf = [&](std::size_t i)
  {
    const double range = std::isnan(all[i].range) ? beams.displayLength : all[i].range;
    return PointOnBeam(beams, i, range);
  };
  SetVertices(report, static_cast<vtkIdType>(all.size()), positionOf);
  AddBeamArrays(beams, report, [](std::size_t i) { return i; });
  Add<vtkIntArray>(report, names::Status, [&](std::size_t i) { return all[i].status; });
  constexpr int crowded = 5; // view of a crowded beam; other views are numbers of DirectEcho
  Add<vtkIntArray>(report, names::View,
    [&](std::size_t i) { return all[i].isCrowded ? crowded : static_cast<int>(all[i].direct); });
  Add<vtkIdTypeArray>(
    report, names::Candidates, [&](std::size_t i) { return all[i].counters.candidates; });
  Add<vtkIdTypeArray>(
    report, names::NodesVisited, [&](std::size_t i) { return all[i].counters.nodesVisited; });
  Add<vtkIdTypeArray>(
    report, names::RaysTraced, [&](std::size_t i) { return all[i].counters.raysTraced; });
  Add<vtkIntArray>(
    report, names::Skipped, [&](std::size_t i) { return all[i].skipped | noiseSkipped; });
  Add<vtkDoubleArray>(
    report, names::SkippedBound, [&](std::size_t i) { return all[i].lost + noiseBound; });
  report->GetPointData()->SetActiveScalars(names::Status.name);
}

//------------------------------------------------------------------------------
void vtkAvianLidarEchoOutput::FillMovers(const avianlidar::ScanSetup& setup,
  const avianlidar::ScanBeams& beams, const std::vector<avianlidar::MoverReport>& reports,
  const avianlidar::ScanResult& result, vtkPolyData* report)
{
  std::map<int, int> echoes;
  for (const Echo& echo : result.echoes)
  {
    ++echoes[echo.objectId];
  }
  std::vector<std::pair<int, const avianlidar::MoverReport*>> all; // object id and report
  for (std::size_t m = 0; m < reports.size(); ++m)
  {
    if (reports[m].present)
    {
      all.emplace_back((*setup.movers)[m].objectIds.front(), &reports[m]);
    }
  }
  std::stable_sort(
    all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  SetVertices(report, static_cast<vtkIdType>(all.size()),
    [&](std::size_t i) { return all[i].second->pose.position; });
  const auto directionOf = [&](std::size_t i)
  { return all[i].second->pose.position - all[i].second->origin; };
  Add<vtkIntArray>(report, names::ObjectId, [&](std::size_t i) { return all[i].first; });
  Add<vtkIdTypeArray>(report, names::BeamId,
    [&](std::size_t i)
    {
      const avianlidar::MoverReport& one = *all[i].second;
      return one.touched ? static_cast<vtkIdType>(beams.ids[one.beam]) : -1;
    });
  Add<vtkDoubleArray>(
    report, names::Timestamp, [&](std::size_t i) { return 1e6 * all[i].second->pose.time; });
  Add<vtkDoubleArray>(report, names::Distance, [&](std::size_t i) { return all[i].second->range; });
  Add<vtkDoubleArray>(report, names::Azimuth,
    [&](std::size_t i) { return vtkAvianLidarBeams::AzimuthOf(directionOf(i)); });
  Add<vtkDoubleArray>(report, names::VerticalAngle,
    [&](std::size_t i) { return vtkAvianLidarBeams::ElevationOf(directionOf(i)); });
  Add<vtkDoubleArray>(
    report, names::EffectiveArea, [&](std::size_t i) { return all[i].second->effectiveArea; });
  Add<vtkIntArray>(
    report, names::NumberOfBeams, [&](std::size_t i) { return all[i].second->beams; });
  AddPoses(report, names::FirstTimestamp, names::FirstPosition,
    [&](std::size_t i) -> const avianlidar::Pose& { return all[i].second->first; });
  AddPoses(report, names::LastTimestamp, names::LastPosition,
    [&](std::size_t i) -> const avianlidar::Pose& { return all[i].second->last; });
  Add<vtkDoubleArray>(
    report, names::EnergyReceived, [&](std::size_t i) { return all[i].second->energy; });
  if (setup.sensor.receiverModel == avianlidar::ReceiverModel::Photons)
  {
    const avianlidar::PhotonReceiver receiver(setup.sensor);
    Add<vtkDoubleArray>(report, names::Photoelectrons,
      [&](std::size_t i) { return receiver.electronsPerJoule * all[i].second->energy; });
  }
  Add<vtkDoubleArray>(
    report, names::DetectionProbability, [&](std::size_t i) { return all[i].second->probability; });
  Add<vtkIntArray>(
    report, names::NumberOfEchoes, [&](std::size_t i) { return echoes[all[i].first]; });
  report->GetPointData()->SetActiveScalars(names::DetectionProbability.name);
}

//------------------------------------------------------------------------------
void vtkAvianLidarEchoOutput::FillFields(const avianlidar::ScanSetup& setup, int preset,
  vtkFieldData* beamFields, const vtkAvianLidarMovers& movers, vtkFieldData* surfaceFields,
  std::uint64_t sceneChecksum, vtkFieldData* fields)
{
  fields->PassData(beamFields);
  names::SetFieldInteger(fields, names::Preset, preset);
  avianlidar::EchoSettings settings = setup.settings;
  settings.attenuationCoefficient = setup.attenuation(); // of all media that fill the scene
  SetSettings(settings, fields);
  names::SetFieldStrings(fields, names::Version, { AVIANLIDAR_VERSION });
  auto checksum = names::Make<vtkTypeUInt64Array>(names::SceneChecksum, 1);
  const std::uint64_t parts[] = { sceneChecksum, movers.checksum };
  checksum->SetValue(
    0, movers.movers ? avianlidar::hashOf(parts, sizeof(parts), 0) : sceneChecksum);
  fields->AddArray(checksum);
  SetNeeds(setup, fields);
  // Each note has its own array, because ParaView's Information panel shows the strings of an array
  // in one line.
  const std::pair<const char*, std::string> notes[] = { { "note_all_left_out", All(setup) },
    { "note_noise", Noise(setup) }, { "note_two_reflections", TwoReflections(setup) },
    { "note_further_reflections", FurtherReflections(setup) },
    { "note_faint_paths", FaintPaths(setup) }, { "note_small_objects", SmallObjects(setup) },
    { "note_detail_between_rays", Detail(setup) }, { "note_planes", Planes(setup) },
    { "note_perceivable_range", PerceivableRange(setup) } };
  for (const auto& [name, text] : notes)
  {
    names::SetFieldStrings(fields, { name, "" }, { text });
  }
  names::SetFieldStrings(fields, names::ObjectNames, movers.objectNames);
  names::SetFieldStrings(fields, names::MaterialNames, movers.materialNames);
  if (vtkAbstractArray* origin =
        surfaceFields ? surfaceFields->GetAbstractArray(names::GeodeticOrigin.name) : nullptr)
  {
    fields->AddArray(origin);
  }
  if (!movers.objectClasses.empty())
  {
    names::SetFieldStrings(fields, names::ObjectClasses, movers.objectClasses);
  }
}
