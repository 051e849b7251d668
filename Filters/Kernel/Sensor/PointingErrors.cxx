// SPDX-License-Identifier: BSD-3-Clause
#include "PointingErrors.h"

#include "Random.h"
#include "ValueError.h"
#include "Vector.h"

#include <cmath>

namespace avianlidar
{
namespace
{
using Vector = std::array<double, 3>;

/// A vector turned about an axis by the axis' length, rad (Rodrigues).
Vector turned(const Vector& v, const Vector& turn)
{
  const double angle = std::hypot(turn[0], turn[1], turn[2]);
  if (angle == 0.0)
  {
    return v;
  }
  const Vector k{ { turn[0] / angle, turn[1] / angle, turn[2] / angle } };
  const Vector cross{ { k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2],
    k[0] * v[1] - k[1] * v[0] } };
  const double along = k[0] * v[0] + k[1] * v[1] + k[2] * v[2];
  const double sine = std::sin(angle);
  const double cosine = std::cos(angle);
  const double half = std::sin(0.5 * angle);
  Vector result;
  for (int i = 0; i < 3; ++i)
  {
    result[i] = cosine * v[i] + sine * cross[i] + 2.0 * half * half * along * k[i];
  }
  return result;
}
}

std::string checkPointing(const PointingErrors& errors)
{
  const char* const angle = "an rms angle of 0 to 10 degrees";
  if (!(errors.swayAmplitude >= 0.0 && errors.swayAmplitude <= MaximumPointingError))
  {
    return valueError("SwayAmplitude", errors.swayAmplitude, angle);
  }
  if (!(errors.swayFrequency >= MinimumSwayFrequency &&
        errors.swayFrequency <= MaximumSwayFrequency))
  {
    return valueError("SwayFrequency", errors.swayFrequency, "1e-6 to 1e6 Hz");
  }
  if (!(errors.encoderJitter >= 0.0 && errors.encoderJitter <= MaximumPointingError))
  {
    return valueError("EncoderJitter", errors.encoderJitter, angle);
  }
  return {};
}

Pointing::Pointing(const PointingErrors& errors, const std::array<double, 3>& rotor)
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

std::array<double, 3> Pointing::direction(const std::array<double, 3>& reported,
  std::int64_t column, std::int32_t revolution, double time) const
{
  const double error = -this->azimuthError(column, revolution);
  const auto tilts = this->tilt(time);
  return turned(turned(reported,
                  { { error * this->Rotor[0], error * this->Rotor[1], error * this->Rotor[2] } }),
    { { tilts[0], tilts[1], 0.0 } });
}
}
