// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Silhouette.h
 * @brief What a target shows of itself in one pose, by place: its effective area (silhouette
 * weighted by the cosine of incidence) and its depth in the pixels of a small image, and how much
 * of it a beam lights.
 *
 * The image is drawn from afar, with a depth buffer, by 3 x 3 samples for each pixel: mutual shadow
 * is in it. Coarser images are sums of its pixels; a beam takes the coarsest of which its radius
 * spans RadiusInPixels, so that any beam costs some fifty pixels.
 *
 * Source: none.
 * Valid: beams of more than 0.02 of the longer side; narrower ones count as so wide, with their
 * energy alike. Areas are off by 1 % of the target's at most, and of what a beam lights by 10 %
 * of what fills it, or of the target.
 * Test: TestSilhouette.cxx.
 */
#ifndef avianlidar_Silhouette_h
#define avianlidar_Silhouette_h

#include "Sensor.h"
#include "TriangleMesh.h"
#include "Vector.h"

#include <vector>

namespace avianlidar
{
/// A beam at a target, in the plane across the line of sight through the target's middle.
struct BeamAtTarget
{
  double radius; ///< m
  double x, y;   ///< of the beam's axis from the middle, m to the right and up
  BeamProfile profile = BeamProfile::Uniform;

  /// Irradiance at a squared distance, m^2, from the axis, over the beam's mean; also beyond its
  /// border.
  double irradiance(double distance2) const
  {
    return this->profile == BeamProfile::Gaussian
      ? 2.0 * std::exp(-2.0 * distance2 / (this->radius * this->radius)) / -std::expm1(-2.0)
      : 1.0;
  }
};

/// Part of a target, or all of it.
struct LitPart
{
  double area = 0.0;   ///< effective, in the unit of the silhouette, weighted by the irradiance
  double depth = 0.0;  ///< m, its mean behind the target's middle
  double spread = 0.0; ///< m, standard deviation of its depth
};

class Silhouette
{
public:
  /// A point that shows the area 1.
  Silhouette();

  /// A point. @param area that it shows
  explicit Silhouette(double area);

  /// @param view unit vector from the observer, far away, to the target, not vertical; its middle
  /// is the origin @param unit of areas, m^2
  Silhouette(const TriangleMesh& mesh, const Vec3& view, double unit);

  const LitPart& all() const { return this->All; } ///< by a wide uniform beam

  /// m: nothing lies farther from the middle, across the line of sight.
  double reach() const { return this->Reach; }

  /// What a beam lights of it.
  LitPart litBy(const BeamAtTarget& beam) const;

private:
  /// Sums over pixels' effective areas, of those times depth, and times its square.
  struct Sums
  {
    float area = 0.0F, depth = 0.0F, square = 0.0F;
  };
  struct Image
  {
    double pixel = 0.0;             ///< m
    double left = 0.0, below = 0.0; ///< m, centre of the first pixel
    int columns = 0, rows = 0;
    std::vector<Sums> pixels; ///< row by row
  };
  static Image halved(const Image& fine);

  LitPart All;
  double Reach = 0.0;        ///< m
  std::vector<Image> Images; ///< the finest first; none: a point
};
}

#endif
