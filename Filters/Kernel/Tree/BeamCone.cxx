// SPDX-License-Identifier: BSD-3-Clause
#include "BeamCone.h"

#include "TriangleTest.h"

namespace avianlidar
{
ConeWedge::ConeWedge(double sine, double axisX, double axisY)
{
  const double sinPsi = std::sqrt(axisX * axisX + axisY * axisY);
  if (sinPsi <= sine * (1.0 + 1e-9))
  {
    return;
  }
  this->wholePlane = false;
  const double sinPhi = sine / sinPsi;
  const double cosPhi = std::sqrt((1.0 - sinPhi) * (1.0 + sinPhi));
  const double x = axisX / sinPsi;
  const double y = axisY / sinPsi;
  this->leftX = x * cosPhi - y * sinPhi;
  this->leftY = y * cosPhi + x * sinPhi;
  this->rightX = x * cosPhi + y * sinPhi;
  this->rightY = y * cosPhi - x * sinPhi;
}

BeamCone::BeamCone(const BeamFrame& frame)
  : apex(frame.origin)
  , axis(frame.axis)
{
  // A relative margin m of tan(theta0.5) turns the cone's edge by at most m sin(2 theta0.5) / 2.
  // The cone is widened by at least twice as much.
  const double widened =
    frame.halfBeamwidth + 2.0 * HitMarginBeam * frame.sinHalf + 2.0 * HitMargin;
  this->sine = std::sin(widened);
  this->cosine = std::cos(widened);
  this->wedges[0] = ConeWedge(this->sine, this->axis.y, this->axis.z);
  this->wedges[1] = ConeWedge(this->sine, this->axis.z, this->axis.x);
  this->wedges[2] = ConeWedge(this->sine, this->axis.x, this->axis.y);
}
}
