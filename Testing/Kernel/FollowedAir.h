// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file FollowedAir.h
 * @brief The air along one beam after the other, with its light.
 */
#ifndef FollowedAir_h
#define FollowedAir_h

#include "AirFinder.h"
#include "AirLight.h"

#include <utility>
#include <vector>

namespace avianlidar
{
struct FollowedAir
{
  FollowedAir(const Sensor& sensor, Air air)
    : scan(sensor, std::move(air))
  {
    this->light.begin(this->along, this->surfaces);
  }
  FollowedAir(const FollowedAir&) = delete;
  FollowedAir& operator=(const FollowedAir&) = delete;

  void begin(const BeamFrame& frame) { this->set(this->finder.along(frame, 0.0)); }
  void beginRay(const Vec3& direction)
  {
    this->set(this->finder.alongRay(Vec3(0.0), direction, 0.0));
  }
  void take(std::vector<MetSurface> met)
  {
    this->surfaces = this->along.arrange(std::move(met));
    this->light.begin(this->along, this->surfaces);
  }

  double transmission(double range) const { return this->along.transmission(range); }
  double followed(std::int64_t unit) { return this->light.followed(unit); }
  const std::vector<AirLight::Share>& sharesOf(std::int64_t unit)
  {
    return this->light.sharesOf(unit);
  }

  const ScanAir scan;
  AirFinder finder{ scan };
  BeamAir along{ scan };
  std::vector<MetSurface> surfaces;
  AirLight light{ scan };

private:
  void set(BeamAir air)
  {
    this->along = std::move(air);
    this->take({});
  }
};
}

#endif
