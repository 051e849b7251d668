// SPDX-License-Identifier: BSD-3-Clause
#include "PrincipalAxes.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
namespace
{
/// One Jacobi rotation that clears a[p][q]; v collects the rotations.
void rotate(double a[3][3], double v[3][3], int p, int q)
{
  if (a[p][q] == 0.0)
  {
    return;
  }
  const double theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
  const double t = std::copysign(1.0, theta) / (std::fabs(theta) + std::hypot(theta, 1.0));
  const double c = 1.0 / std::hypot(t, 1.0);
  const double s = t * c;
  const auto turn = [c, s](double& x, double& y)
  {
    const double before = x;
    x = c * before - s * y;
    y = s * before + c * y;
  };
  for (int i = 0; i < 3; ++i)
  {
    turn(a[i][p], a[i][q]);
    turn(v[i][p], v[i][q]);
  }
  for (int i = 0; i < 3; ++i)
  {
    turn(a[p][i], a[q][i]);
  }
  a[p][q] = a[q][p] = 0.0;
}
}

std::array<Vec3, 3> principalAxes(const std::array<double, 6>& m)
{
  const std::array<Vec3, 3> coordinateAxes{ Vec3(1.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0),
    Vec3(0.0, 0.0, 1.0) };
  double scale = 0.0;
  for (const double value : m)
  {
    scale = std::isfinite(value) ? std::fmax(scale, std::fabs(value))
                                 : std::numeric_limits<double>::infinity();
  }
  if (!(scale > 0.0) || !std::isfinite(scale))
  {
    return coordinateAxes;
  }
  double a[3][3] = { { m[0] / scale, m[1] / scale, m[2] / scale },
    { m[1] / scale, m[3] / scale, m[4] / scale }, { m[2] / scale, m[4] / scale, m[5] / scale } };
  double v[3][3] = { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 0.0, 0.0, 1.0 } };
  for (int sweep = 0; sweep < 12; ++sweep)
  {
    rotate(a, v, 0, 1);
    rotate(a, v, 0, 2);
    rotate(a, v, 1, 2);
  }
  std::array<int, 3> by{ 0, 1, 2 };
  std::stable_sort(by.begin(), by.end(), [&](int i, int j) { return a[i][i] > a[j][j]; });
  std::array<Vec3, 3> axes;
  axes[0] = glm::normalize(Vec3(v[0][by[0]], v[1][by[0]], v[2][by[0]]));
  const Vec3 second(v[0][by[1]], v[1][by[1]], v[2][by[1]]);
  axes[1] = glm::normalize(second - glm::dot(second, axes[0]) * axes[0]);
  axes[2] = glm::cross(axes[0], axes[1]);
  return axes;
}
}
