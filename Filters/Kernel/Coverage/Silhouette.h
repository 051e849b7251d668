// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Silhouette.h
 * @brief What a target shows of itself in one pose, by place: its effective area (silhouette
 * weighted by the cosine of incidence) and its depth in the pixels of a small image, and how much
 * of it a beam lights.
 *
 * The image is drawn from afar, with a depth buffer, by 3 x 3 samples for each pixel: mutual shadow
 * is in it. Coarser images are sums of its pixels; a beam takes the coarsest of which its radius
 * spans RadiusInPixels, so that a round beam costs some fifty pixels, and others as many times that
 * as they are longer than wide. effectiveArea() draws a finer image that nobody keeps.
 *
 * Source: none.
 * Valid: beams of more than 0.02 of the longer side; narrower ones count as so wide, with their
 * energy alike. Areas are off by 1 % of the target's at most, and of what a beam lights by 10 %
 * of what fills it, or of the target.
 * Test: TestSilhouette.cxx, TestEffectiveArea.cxx.
 */
#ifndef avianlidar_Silhouette_h
#define avianlidar_Silhouette_h

#include "Sensor.h"
#include "TriangleMesh.h"
#include "Vector.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace avianlidar
{
struct Squares
{
  double along, beside;
  double sum() const { return this->along + this->beside; }
  double most() const { return std::max(this->along, this->beside); }
};

/// A beam at a target, in the plane across the line of sight through the target's middle.
struct BeamAtTarget
{
  double radius = 0.0; ///< m, half the longer side of an ellipse or rectangle
  double x, y;         ///< beam axis relative to the middle, m right and up
  BeamProfile profile = BeamProfile::Uniform;
  // Of beams that are not round, or have another Gaussian:
  double across = radius; ///< m, half the shorter side
  double cosine = 1.0;    ///< of the turn of the longer one, from the right upwards
  double sine = 0.0;
  bool isRectangle = false;
  double fall = 2.0;                     ///< the Gaussian is exp(-fall s), s see squareOf()
  double most = 2.0 / -std::expm1(-2.0); ///< its irradiance on the axis, over the beam's mean

  bool isRound() const { return !this->isRectangle && this->across == this->radius; }

  /// Round, and uniform or 1/e^2 at the border.
  bool isUsual() const { return this->isRound() && this->fall == 2.0; }

  /// Squares of the coordinates of a place along the sides, each over that of half the side.
  /// @param right, above m from the axis
  Squares squaresOf(double right, double above) const
  {
    const double along = (this->cosine * right + this->sine * above) / this->radius;
    const double beside = (this->cosine * above - this->sine * right) / this->across;
    return { along * along, beside * beside };
  }

  /// How far the middle lies beyond the border, m, or less; negative: how far within, or less far.
  double beyond() const
  {
    if (this->isRound())
    {
      return std::hypot(this->x, this->y) - this->radius;
    }
    const Squares at = this->squaresOf(this->x, this->y);
    return this->across * (std::sqrt(this->isRectangle ? at.most() : at.sum()) - 1.0);
  }

  /// Irradiance at the middle, over the beam's mean; also beyond its border.
  double irradiance() const { return this->irradiance(this->squaresOf(this->x, this->y).sum()); }

  /// The same at a place. @param square sum of its squares
  double irradiance(double square) const
  {
    return this->profile == BeamProfile::Gaussian ? this->most * std::exp(-this->fall * square)
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
  const Image& imageFor(const BeamAtTarget& beam) const;
  static void rangeOf(
    double place, double reach, double first, double pixel, int count, int& begin, int& end);
  LitPart litByOther(const BeamAtTarget& beam) const;

  LitPart All;
  double Reach = 0.0;        ///< m
  std::vector<Image> Images; ///< the finest first; none: a point
};

/// What an object shows of itself to an observer far away, m^2: the silhouette weighted by the
/// cosine of incidence. A lidar receives of a matt object that one beam holds in proportion to it.
/// The samples are 1/512 of the longer side apart: birds are off by 0.2 % at most. The distance
/// does not count: an object of half the angle `a` shows about `a/2` less of itself. @param view
/// unit vector from the observer to the object
double effectiveArea(const TriangleMesh& mesh, const Vec3& view);
}

#endif
