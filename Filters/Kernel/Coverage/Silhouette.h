// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Silhouette.h
 * @brief Effective area (silhouette weighted by the cosine of incidence) and depth of a target in
 * one pose, as a small image, and the part of the target that a beam lights.
 *
 * The image is drawn as seen from afar, with 3 x 3 samples for each pixel. A depth buffer leaves
 * out parts that other parts hide. Coarser images sum the pixels of the drawn image. A beam uses
 * the coarsest image in which its shorter half side spans RadiusInPixels: about fifty pixels if the
 * beam is round. effectiveArea() draws a finer image and does not keep it.
 *
 * Source: none.
 * Valid: beams wider than 0.02 of the target's longer side. A narrower beam is replaced by a beam
 * of this width and the same energy. Areas are wrong by at most 1 % of the target's area. The area
 * that a beam lights is wrong by at most 10 % of the area that fills the beam, or of the target's
 * area.
 * Test: TestSilhouette.cxx, TestEffectiveArea.cxx.
 */
#ifndef avianlidar_Silhouette_h
#define avianlidar_Silhouette_h

#include "Sensor.h"
#include "TriangleMesh.h"
#include "Vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace avianlidar
{
/// A beam at a target, in the plane across the line of sight through the target's middle.
struct BeamAtTarget
{
  double radius = 0.0; ///< half the longer side of an ellipse or rectangle, m
  double x, y;         ///< offset of the beam's axis from the target's middle, right and up, m
  BeamProfile profile = BeamProfile::Uniform;
  // For beams that are not round or whose Gaussian does not fall to 1/e^2 at the border:
  double across = radius; ///< half the shorter side, m
  double cosine = 1.0;    ///< cosine of the longer side's angle, counted from right towards up
  double sine = 0.0;
  bool isRectangle = false;
  double fall = 2.0; ///< rate of the Gaussian exp(-fall s), s = squared distance in half sides
  double most = 2.0 / -std::expm1(-2.0); ///< irradiance on the axis relative to the beam's mean

  bool isRound() const { return !this->isRectangle && this->across == this->radius; }

  /// Coordinates of the target's middle along the beam's sides, in units of half the side.
  std::array<double, 2> middle() const
  {
    return { (this->cosine * this->x + this->sine * this->y) / this->radius,
      (this->cosine * this->y - this->sine * this->x) / this->across };
  }

  /// Distance of the target's middle outside the beam's border, m; negative inside the border. For
  /// a beam that is not round, the magnitude is a lower bound.
  double beyond() const
  {
    if (this->isRound())
    {
      return std::hypot(this->x, this->y) - this->radius;
    }
    const auto [along, beside] = this->middle();
    return this->across *
      ((this->isRectangle ? std::max(std::fabs(along), std::fabs(beside))
                          : std::hypot(along, beside)) -
        1.0);
  }

  /// Irradiance at the target's middle, inside or beyond the border, relative to the beam's mean.
  double irradiance() const
  {
    const auto [along, beside] = this->middle();
    return this->profile == BeamProfile::Gaussian
      ? this->most * std::exp(-this->fall * (along * along + beside * beside))
      : 1.0;
  }
};

/// Part of a target, or all of it.
struct LitPart
{
  double area = 0.0;   ///< effective area times irradiance, in the unit of the silhouette
  double depth = 0.0;  ///< mean depth behind the target's middle, m
  double spread = 0.0; ///< standard deviation of the depth, m
};

class Silhouette
{
public:
  struct Image
  {
    double pixel = 0.0;             ///< side of a pixel, m
    double left = 0.0, below = 0.0; ///< centre of the first pixel, m
    int columns = 0, rows = 0;
    std::size_t stride = 0, plane = 0; ///< numbers from one row, or one plane, to the next
    /// Sums of effective areas, areas times depth, and areas times squared depth: three planes of
    /// pixels row by row.
    std::vector<float> pixels;

    void allocate();
    float& at(int sum, int row, int column)
    {
      return this->pixels[sum * plane + row * stride + column];
    }
    float at(int sum, int row, int column) const
    {
      return this->pixels[sum * plane + row * stride + column];
    }
  };

  /// A point of the given area.
  explicit Silhouette(double area = 1.0);

  /// @param mesh target with its middle at the origin
  /// @param view unit vector from the distant observer to the target, not vertical
  /// @param unit unit of areas, m^2
  Silhouette(const TriangleMesh& mesh, const Vec3& view, double unit);

  const LitPart& all() const { return this->All; } ///< part that a wide uniform beam lights

  /// Largest distance of any point from the middle, across the line of sight, m.
  double reach() const { return this->Reach; }

  /// Memory of the images, bytes.
  std::size_t bytes() const;

  /// Returns the part that a beam lights.
  LitPart litBy(const BeamAtTarget& beam) const;

private:
  LitPart All;
  double Reach = 0.0;        ///< value of reach(), m
  std::vector<Image> Images; ///< images, finest first; empty for a point
};

/// Effective area of an object seen from far away, m^2: the silhouette weighted by the cosine of
/// incidence. The energy that a lidar receives from a matt object inside one beam is proportional
/// to this area. The samples are 1/512 of the longer side apart, so areas of birds are wrong by at
/// most 0.2 %. Perspective, which reduces the area of an object of the half angle a (rad) by a
/// share of about a/2, is ignored.
/// @param view unit vector from the observer to the object
double effectiveArea(const TriangleMesh& mesh, const Vec3& view);
}

#endif
