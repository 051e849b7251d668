// SPDX-License-Identifier: BSD-3-Clause
#include "Prisms.h"

#include "ScanPattern.h"
#include "ValueError.h"

#include <array>
#include <cmath>
#include <stdexcept>

namespace avianlidar
{
namespace
{
constexpr std::size_t MostPrisms = 3;
constexpr int CheckedPhases = 12;

using PrismAngles = std::array<double, MostPrisms>; // angles of the prisms, deg

/// Angle of a rotation at a time, deg, without whole turns.
double degreesAt(double rate, double start, double time)
{
  return 360.0 * (std::fmod(rate * start, 1.0) + std::fmod(rate * time, 1.0));
}

/// Refract a unit vector. @param normal of the face, along the light @param ratio index before over
/// index behind @return false where no light passes
bool refract(Vec3& direction, const Vec3& normal, double ratio)
{
  const bool meets = glm::dot(direction, normal) > 0.0;
  direction = glm::refract(direction, -normal, ratio);
  const double length = glm::length(direction); // 1 but for rounding, or 0
  direction /= length;
  return meets && length > 0.0;
}

/// Refract a direction at all prisms. @return false where no light passes
bool passPrisms(const PrismTrain& train, const PrismAngles& angles, Vec3& direction)
{
  for (std::size_t prism = 0; prism < train.wedgeAngles.size(); ++prism)
  {
    const double index = train.refractiveIndices[prism];
    const auto [sine, cosine] = sinCosDegrees(train.wedgeAngles[prism]);
    const auto [right, up] = sinCosDegrees(angles[prism]);
    const Vec3 plane(0.0, 1.0, 0.0);
    // The thick end of a prism lies at its angle, so that light is deflected to this angle.
    const Vec3 inclined(-sine * right, cosine, -sine * up);
    const bool leavesInclined = sine >= 0.0;
    if (!refract(direction, leavesInclined ? plane : inclined, 1.0 / index) ||
      !refract(direction, leavesInclined ? inclined : plane, index))
    {
      return false;
    }
  }
  return true;
}
}

std::string checkPrisms(const PrismTrain& train, const std::vector<Vec3>& enters)
{
  const std::size_t prisms = train.wedgeAngles.size();
  if (prisms > MostPrisms)
  {
    return "PrismWedgeAngles has " + std::to_string(prisms) + " values, expected at most 3 prisms";
  }
  const std::vector<double>& phases = train.phases;
  const char* const of = "prisms of PrismWedgeAngles";
  const std::string error = firstError({
    sizeError("PrismRefractiveIndices", train.refractiveIndices.size(), prisms, of),
    sizeError("PrismRotationRates", train.rotationRates.size(), prisms, of),
    sizeError("PrismPhases", phases.empty() ? prisms : phases.size(), prisms, of),
    rangeErrorOf("PrismWedgeAngles", train.wedgeAngles, -60, 60, "angles within [-60, 60] degrees"),
    rangeErrorOf(
      "PrismRefractiveIndices", train.refractiveIndices, 1, 4, "refractive indices of 1 to 4"),
    rangeErrorOf(
      "PrismRotationRates", train.rotationRates, -1e6, 1e6, "rates within [-1e6, 1e6] Hz"),
    rangeErrorOf("PrismPhases", phases, -360, 360, "angles within [-360, 360] degrees"),
    rangeError(
      "PrismAxisElevation", train.axisElevation, -90, 90, "an elevation within [-90, 90] degrees"),
    rangeError(
      "PrismAxisRotationRate", train.axisRotationRate, -1e6, 1e6, "a rate within [-1e6, 1e6] Hz"),
    rangeError(
      "PrismLaserRotationRate", train.laserRotationRate, -1e6, 1e6, "a rate within [-1e6, 1e6] Hz"),
  });
  const double combinations = error.empty() ? std::pow(CheckedPhases, prisms) : 0.0;
  for (std::size_t laser = 0; laser < enters.size(); ++laser)
  {
    for (int at = 0; at < combinations; ++at)
    {
      PrismAngles angles{};
      for (int rest = at, prism = 0; rest > 0; ++prism, rest /= CheckedPhases)
      {
        angles[prism] = rest % CheckedPhases * (360.0 / CheckedPhases);
      }
      Vec3 direction = enters[laser];
      if (!passPrisms(train, angles, direction))
      {
        return "the light of channel " + std::to_string(laser) +
          " is totally reflected within the prisms, expected smaller PrismWedgeAngles or "
          "PrismRefractiveIndices";
      }
    }
  }
  return error;
}

Vec3 steer(const PrismTrain& train, double start, double time, const Vec3& enters)
{
  PrismAngles angles{};
  for (std::size_t prism = 0; prism < train.wedgeAngles.size(); ++prism)
  {
    angles[prism] = degreesAt(train.rotationRates[prism], start, time) +
      (train.phases.empty() ? 0.0 : train.phases[prism]);
  }
  const auto [right, up] = sinCosDegrees(degreesAt(train.laserRotationRate, start, time));
  Vec3 d(up * enters.x + right * enters.z, enters.y, up * enters.z - right * enters.x);
  if (!passPrisms(train, angles, d))
  {
    throw std::runtime_error("light is totally reflected within the prisms at " +
      std::to_string(start + time) +
      " s, expected smaller PrismWedgeAngles or PrismRefractiveIndices");
  }
  const auto [rise, level] = sinCosDegrees(train.axisElevation);
  d = { d.x, level * d.y - rise * d.z, rise * d.y + level * d.z };
  const auto [sine, cosine] = sinCosDegrees(degreesAt(train.axisRotationRate, start, time));
  return { cosine * d.x + sine * d.y, cosine * d.y - sine * d.x, d.z };
}
}
