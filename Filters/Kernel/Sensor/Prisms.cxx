// SPDX-License-Identifier: BSD-3-Clause
#include "Prisms.h"

#include "ScanPattern.h"
#include "ValueError.h"

#include <cmath>
#include <stdexcept>

namespace avianlidar
{
namespace
{
constexpr int CheckedPhases = 12;

std::string wrongCount(const char* name, std::size_t size, std::size_t prisms)
{
  return std::string(name) + " has " + std::to_string(size) +
    " values, expected one for each of the " + std::to_string(prisms) +
    " prisms of PrismWedgeAngles";
}

std::string checkNumbers(const PrismTrain& train)
{
  for (const double wedge : train.wedgeAngles)
  {
    if (!(std::abs(wedge) <= MaximumWedge))
    {
      return valueError("PrismWedgeAngles", wedge, "angles within [-60, 60] degrees");
    }
  }
  for (const double index : train.refractiveIndices)
  {
    if (!(index >= 1.0 && index <= MaximumRefractiveIndex))
    {
      return valueError("PrismRefractiveIndices", index, "refractive indices of 1 to 4");
    }
  }
  for (const double rate : train.rotationRates)
  {
    if (!(std::abs(rate) <= MaximumPrismRotationRate))
    {
      return valueError("PrismRotationRates", rate, "rates within [-1e6, 1e6] Hz");
    }
  }
  for (const double phase : train.phases)
  {
    if (!(std::abs(phase) <= 360.0))
    {
      return valueError("PrismPhases", phase, "angles within [-360, 360] degrees");
    }
  }
  if (!(std::abs(train.axisElevation) <= 90.0))
  {
    return valueError(
      "PrismAxisElevation", train.axisElevation, "an elevation within [-90, 90] degrees");
  }
  if (!(std::abs(train.axisRotationRate) <= MaximumPrismRotationRate))
  {
    return valueError(
      "PrismAxisRotationRate", train.axisRotationRate, "a rate within [-1e6, 1e6] Hz");
  }
  return std::string();
}

/// Turns of a rate since time 0 within a turn, deg.
double degreesAt(double rate, double start, double time)
{
  return 360.0 * (std::fmod(rate * start, 1.0) + std::fmod(rate * time, 1.0));
}
}

std::string checkPrisms(const PrismTrain& train, const std::vector<std::array<double, 3>>& enters)
{
  const std::size_t prisms = train.wedgeAngles.size();
  if (prisms > MostPrisms)
  {
    return "PrismWedgeAngles has " + std::to_string(prisms) + " values, expected at most 3 prisms";
  }
  if (train.refractiveIndices.size() != prisms)
  {
    return wrongCount("PrismRefractiveIndices", train.refractiveIndices.size(), prisms);
  }
  if (train.rotationRates.size() != prisms)
  {
    return wrongCount("PrismRotationRates", train.rotationRates.size(), prisms);
  }
  if (!train.phases.empty() && train.phases.size() != prisms)
  {
    return wrongCount("PrismPhases", train.phases.size(), prisms);
  }
  const std::string bad = checkNumbers(train);
  if (!bad.empty())
  {
    return bad;
  }
  int combinations = 1;
  for (std::size_t prism = 0; prism < prisms; ++prism)
  {
    combinations *= CheckedPhases;
  }
  for (std::size_t laser = 0; laser < enters.size(); ++laser)
  {
    for (int at = 0; at < combinations; ++at)
    {
      std::array<double, MostPrisms> angles{};
      for (int rest = at, prism = 0; prism < static_cast<int>(prisms);
           ++prism, rest /= CheckedPhases)
      {
        angles[prism] = rest % CheckedPhases * (360.0 / CheckedPhases);
      }
      std::array<double, 3> direction = enters[laser];
      if (!passPrisms(train, angles, direction))
      {
        return "the light of channel " + std::to_string(laser) +
          " is totally reflected within the prisms, expected smaller PrismWedgeAngles or "
          "PrismRefractiveIndices";
      }
    }
  }
  return std::string();
}

bool refract(std::array<double, 3>& direction, const std::array<double, 3>& normal, double ratio)
{
  const double along =
    direction[0] * normal[0] + direction[1] * normal[1] + direction[2] * normal[2];
  const double square = 1.0 - ratio * ratio * (1.0 - along * along);
  if (!(along > 0.0 && square > 0.0))
  {
    return false;
  }
  const double added = std::sqrt(square) - ratio * along;
  double length = 0.0;
  for (int i = 0; i < 3; ++i)
  {
    direction[i] = ratio * direction[i] + added * normal[i];
    length += direction[i] * direction[i];
  }
  length = std::sqrt(length); // 1 but for rounding
  for (double& component : direction)
  {
    component /= length;
  }
  return true;
}

bool passPrisms(const PrismTrain& train, const std::array<double, MostPrisms>& angles,
  std::array<double, 3>& direction)
{
  const std::array<double, 3> plane{ { 0.0, 1.0, 0.0 } };
  for (std::size_t prism = 0; prism < train.wedgeAngles.size(); ++prism)
  {
    const double wedge = train.wedgeAngles[prism];
    const double index = train.refractiveIndices[prism];
    double sine, cosine, right, up;
    sinCosDegrees(wedge, sine, cosine);
    sinCosDegrees(angles[prism], right, up);
    // Its thick end lies at the angle, so that light is deflected to there.
    const std::array<double, 3> inclined{ { -sine * right, cosine, -sine * up } };
    const bool leavesInclined = wedge >= 0.0;
    if (!refract(direction, leavesInclined ? plane : inclined, 1.0 / index) ||
      !refract(direction, leavesInclined ? inclined : plane, index))
    {
      return false;
    }
  }
  return true;
}

std::array<double, 3> steer(
  const PrismTrain& train, double start, double time, const std::array<double, 3>& enters)
{
  std::array<double, MostPrisms> angles{};
  for (std::size_t prism = 0; prism < train.wedgeAngles.size(); ++prism)
  {
    angles[prism] = degreesAt(train.rotationRates[prism], start, time) +
      (train.phases.empty() ? 0.0 : train.phases[prism]);
  }
  std::array<double, 3> d = enters;
  if (!passPrisms(train, angles, d))
  {
    throw std::runtime_error("light is totally reflected within the prisms at " +
      std::to_string(start + time) +
      " s, expected smaller PrismWedgeAngles or PrismRefractiveIndices");
  }
  double sine, cosine;
  if (train.axisElevation != 0.0)
  {
    sinCosDegrees(train.axisElevation, sine, cosine);
    d = { { d[0], cosine * d[1] - sine * d[2], sine * d[1] + cosine * d[2] } };
  }
  if (train.axisRotationRate != 0.0)
  {
    sinCosDegrees(degreesAt(train.axisRotationRate, start, time), sine, cosine);
    d = { { cosine * d[0] + sine * d[1], -sine * d[0] + cosine * d[1], d[2] } };
  }
  return d;
}
}
