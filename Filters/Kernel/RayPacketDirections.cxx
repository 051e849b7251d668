// SPDX-License-Identifier: BSD-3-Clause
// Unit directions of the rays of a packet: of one beam, or of several.
#include "RayPacket.h"

#include "Multiversion.h"
#include "RangeLanes.h"
#include "TriangleTest.h"

#include <cmath>

namespace avianlidar
{
namespace
{
/// Frames of the rays of a packet, lane by lane.
struct alignas(64) FrameLanes
{
  double e1[3][RayPacket::Width], e2[3][RayPacket::Width], axis[3][RayPacket::Width],
    tangent[RayPacket::Width];

  void set(int lane, const BeamFrame& f)
  {
    for (int k = 0; k < 3; ++k)
    {
      this->e1[k][lane] = f.e1[k];
      this->e2[k][lane] = f.e2[k];
      this->axis[k][lane] = f.axis[k];
    }
    this->tangent[lane] = f.tanHalf;
  }
};

/// unitDirection(frame.direction(x, y)), to the bit.
AVIANLIDAR_MULTIVERSION void directionLanes(
  const FrameLanes& f, const double* x, const double* y, double* dx, double* dy, double* dz, int n)
{
#pragma omp simd
  for (int i = 0; i < n; ++i)
  {
    const double t = f.tangent[i];
    const double vx = f.axis[0][i] + t * (x[i] * f.e1[0][i] + y[i] * f.e2[0][i]);
    const double vy = f.axis[1][i] + t * (x[i] * f.e1[1][i] + y[i] * f.e2[1][i]);
    const double vz = f.axis[2][i] + t * (x[i] * f.e1[2][i] + y[i] * f.e2[2][i]);
    unitDirectionOf(vx, vy, vz, dx[i], dy[i], dz[i]);
  }
}
}

void setDirections(RayPacket& packet)
{
  const auto count = static_cast<std::size_t>(packet.count);
  if (packet.beam)
  {
    unitDirections(*packet.beam, packet.x, packet.y, packet.dx, packet.dy, packet.dz, count);
    return;
  }
  FrameLanes frames;
  for (int i = 0; i < packet.count; ++i)
  {
    frames.set(i, *packet.frame[i]);
  }
  directionLanes(frames, packet.x, packet.y, packet.dx, packet.dy, packet.dz, packet.count);
}
}
