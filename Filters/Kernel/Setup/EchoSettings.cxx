// SPDX-License-Identifier: BSD-3-Clause
#include "EchoSettings.h"

#include "Complaint.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace avianlidar
{
namespace
{

template <class E>
bool outside(E value, int last)
{
  return static_cast<int>(value) < 0 || static_cast<int>(value) > last;
}
}

double mostPathsOfABeam(const EchoSettings& s)
{
  const double rays = s.targetRelativeError > 0.0
    ? std::min(1e6, static_cast<double>(MaximumRayFactor) * s.raysPerBeam)
    : s.raysPerBeam;
  const double connections =
    s.numberOfReflections > 1 ? std::min<double>(s.numberOfConnections, rays - 1.0) : 0.0;
  // Rays of targets have a direct echo and a mirror path, and are not connected.
  const double ofTarget = s.targetRelativeError > 0.0 ? MostRaysOfTarget : RaysOfTarget;
  const double ofTargets = s.smallTargets ? 2.0 * MaximumTargets * ofTarget : 0.0;
  return rays * (2.0 + connections) + ofTargets;
}

std::string checkUnits(const Sensor& sensor, const EchoSettings& settings)
{
  const double inGate = 2.0 * sensor.rangeGate / (SpeedOfLight * sensor.samplingInterval);
  const double reached =
    mostPathsOfABeam(settings) * (2.0 + sensor.pulseWidth / sensor.samplingInterval);
  if (std::min(inGate, reached) > MaximumUnitsPerBeam)
  {
    const std::string expected = "so few sampling intervals, or RaysPerBeam (it is " +
      std::to_string(settings.raysPerBeam) +
      ") so small, that the paths of a beam meet at most 1e8 range units of the gate";
    return complaint("pulse_width", sensor.pulseWidth, expected.c_str());
  }
  return {};
}

bool integratesPlanes(const EchoSettings& settings)
{
  return settings.planeIntegration &&
    (settings.targetRelativeError > 0.0 || settings.raysPerBeam >= FewestRaysIntegrated);
}

std::string checkSettings(const EchoSettings& s)
{
  if (s.raysPerBeam < 1 || s.raysPerBeam > 1000000)
  {
    return complaint("RaysPerBeam", s.raysPerBeam, "1 to 1000000");
  }
  if (outside(s.sampling, 1))
  {
    return complaint("Sampling", static_cast<int>(s.sampling), "0 (Monte Carlo) or 1 (stratified)");
  }
  if (!std::isfinite(s.targetRelativeError) || s.targetRelativeError < 0.0 ||
    s.targetRelativeError >= 1.0)
  {
    return complaint("TargetRelativeError", s.targetRelativeError, "0 (off) to less than 1");
  }
  if (!(s.attenuationCoefficient >= 0.0) || s.attenuationCoefficient > MaximumAttenuation)
  {
    return complaint("AttenuationCoefficient", s.attenuationCoefficient, "0 to 1e30 1/m");
  }
  if (outside(s.reflectanceModel, 2))
  {
    return complaint("ReflectanceModel", static_cast<int>(s.reflectanceModel), "0 to 2");
  }
  if (s.numberOfReflections < 1 || s.numberOfReflections > 2)
  {
    return complaint("NumberOfReflections", s.numberOfReflections, "1 or 2");
  }
  if (outside(s.returnMode, 4))
  {
    return complaint("ReturnMode", static_cast<int>(s.returnMode), "0 to 4");
  }
  if (s.numberOfConnections < 0)
  {
    return complaint("NumberOfConnections", s.numberOfConnections, "at least 0");
  }
  if (mostPathsOfABeam(s) > MaximumPathsPerBeam)
  {
    std::ostringstream expected;
    expected << "so few that a beam has at most 1e8 paths; RaysPerBeam is " << s.raysPerBeam
             << " and TargetRelativeError " << s.targetRelativeError;
    return complaint("NumberOfConnections", s.numberOfConnections, expected.str().c_str());
  }
  if (outside(s.precision, 1))
  {
    return complaint("Precision", static_cast<int>(s.precision), "0 (single) or 1 (double)");
  }
  return {};
}
}
