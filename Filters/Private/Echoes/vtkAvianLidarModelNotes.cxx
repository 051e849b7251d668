// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarModelNotes.h"

#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>

namespace
{
using avianlidar::ScanSetup;

/// Three digits, whatever the locale of the process.
std::string Number(double value)
{
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::setprecision(3) << value;
  return text.str();
}

std::string Joules(double value)
{
  return Number(value) + " J";
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
  return setup.settings.lightEnergyThreshold == avianlidar::LightEnergyThreshold::Limit
    ? "modelled, without paths below the lower energy limit"
    : "modelled, without faint paths";
}

std::string FurtherReflections(const ScanSetup& setup)
{
  const std::string paths = "not modelled: paths over " +
    std::string(setup.settings.numberOfReflections > 1 ? "three" : "two") + " and more reflections";
  // The bound holds all light that surfaces send back. An aperture gathers a small, unknown share
  // of it. A bound above the limit says nothing, either.
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
    return setup.settings.lightEnergyThreshold == avianlidar::LightEnergyThreshold::Limit
      ? "left out below the lower energy limit" +
        (setup.needs.lightEnergyBound > setup.sensor.lowerEnergyLimit
            ? std::string()
            : ": together at most " + most + " of a beam")
      : "left out: at most " + most + " in a range unit";
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
  // Here, too, an aperture gathers a small part of what comes back.
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
    return "paths over two reflections below the lower energy limit"; // the bound says nothing
  }
  return "at most " + OfLimit(setup, setup.needs.skippedEnergyBound) +
    " in a range unit of a beam with an echo";
}
}

//------------------------------------------------------------------------------
std::vector<vtkAvianLidarModelNote> vtkAvianLidarModelNotes(const avianlidar::ScanSetup& setup)
{
  return { { "note_all_left_out", All(setup) }, { "note_noise", Noise(setup) },
    { "note_two_reflections", TwoReflections(setup) },
    { "note_further_reflections", FurtherReflections(setup) },
    { "note_faint_paths", FaintPaths(setup) }, { "note_small_objects", SmallObjects(setup) },
    { "note_detail_between_rays", Detail(setup) }, { "note_planes", Planes(setup) },
    { "note_perceivable_range", PerceivableRange(setup) } };
}
