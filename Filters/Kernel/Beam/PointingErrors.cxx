// SPDX-License-Identifier: BSD-3-Clause
#include "PointingErrors.h"

#include "Random.h"
#include "ValueError.h"

#include <cmath>

namespace avianlidar
{
namespace
{
/// A vector turned about an axis by the axis' length, rad (Rodrigues).
Vec3 turned(const Vec3& v, const Vec3& turn)
{
  const double angle = safeLength(turn);
  if (angle == 0.0)
  {
    return v;
  }
  const Vec3 k = turn / angle;
  const double half = std::sin(0.5 * angle);
  return std::cos(angle) * v + std::sin(angle) * glm::cross(k, v) +
    (2.0 * half * half * glm::dot(k, v)) * k;
}
}

std::string checkPointing(const PointingErrors& errors)
{
  const char* const angle = "an rms angle of 0 to 10 degrees";
  return firstError({
    rangeError("SwayAmplitude", errors.swayAmplitude, 0.0, 10.0, angle),
    rangeError("SwayFrequency", errors.swayFrequency, 1e-6, 1e6, "1e-6 to 1e6 Hz"),
    rangeError("EncoderJitter", errors.encoderJitter, 0.0, 10.0, angle),
  });
}

Pointing::Pointing(const PointingErrors& errors, const Vec3& rotor)
  : Errors(errors)
  , Rotor(rotor)
{
  const double lowest = (1.0 - SwayBandwidth) * errors.swayFrequency;
  const double part = 2.0 * SwayBandwidth * errors.swayFrequency / SwayTones;
  for (int axis = 0; axis < 2; ++axis)
  {
    for (int k = 0; k < SwayTones; ++k)
    {
      const auto u = uniformPair(errors.seed, axis, k, RandomPurpose::MastSway);
      this->Tones[axis][k] = { lowest + part * (k + u[0]), u[1] };
    }
  }
}

std::array<double, 2> Pointing::tilt(double time) const
{
  const double amplitude = std::sqrt(2.0 / SwayTones) * this->Errors.swayAmplitude;
  std::array<double, 2> tilts{ { 0.0, 0.0 } };
  for (int axis = 0; axis < 2 && amplitude != 0.0; ++axis)
  {
    for (const Tone& tone : this->Tones[axis])
    {
      const double turns = tone.frequency * time;
      tilts[axis] += std::cos(2.0 * Pi * (turns - std::floor(turns) + tone.phase));
    }
    tilts[axis] *= amplitude * RadiansPerDegree;
  }
  return tilts;
}

double Pointing::azimuthError(std::int64_t column, std::int32_t revolution) const
{
  if (this->Errors.encoderJitter == 0.0)
  {
    return 0.0;
  }
  const auto u = uniformPair(this->Errors.seed, static_cast<std::uint64_t>(column), 0,
    RandomPurpose::EncoderJitter, revolution);
  const double deviate = std::sqrt(-2.0 * std::log(u[0])) * std::cos(2.0 * Pi * u[1]);
  return deviate * this->Errors.encoderJitter * RadiansPerDegree;
}

Vec3 Pointing::direction(
  const Vec3& reported, std::int64_t column, std::int32_t revolution, double time) const
{
  const auto [east, north] = this->tilt(time);
  return turned(
    turned(reported, -this->azimuthError(column, revolution) * this->Rotor), { east, north, 0.0 });
}
}
