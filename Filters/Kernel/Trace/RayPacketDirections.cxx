// SPDX-License-Identifier: BSD-3-Clause
// Directions of the rays of a packet: of one beam, or of several.
#include "RayPacket.h"

#include "Multiversion.h"

namespace avianlidar
{
namespace
{
/// BeamFrame::direction() of rays of one beam.
AVIANLIDAR_MULTIVERSION void roundedLanes(
  const BeamFrame& frame, const double* x, const double* y, int first, int end, PacketView& view)
{
  const Vec3 e1 = frame.e1;
  const Vec3 e2 = frame.e2;
  const Vec3 axis = frame.axis;
  const double t = frame.tanHalf;
#pragma omp simd
  for (int i = first; i < end; ++i)
  {
    view.direction[0][i] = static_cast<float>(axis.x + t * (x[i] * e1.x + y[i] * e2.x));
    view.direction[1][i] = static_cast<float>(axis.y + t * (x[i] * e1.y + y[i] * e2.y));
    view.direction[2][i] = static_cast<float>(axis.z + t * (x[i] * e1.z + y[i] * e2.z));
  }
}

/// Rays of one beam that are worth a loop of their own.
constexpr int ShortestRun = 8;

/// One beyond the last ray of the beam of ray `first`, `end` at most.
int endOfRun(const RayPacket& packet, int first, int end)
{
  int next = first + 1;
  while (next < end && packet.frame[next] == packet.frame[first])
  {
    ++next;
  }
  return next;
}
}

void setDirections(RayPacket& packet, PacketView& view)
{
  const int end = padded(packet.count);
  for (int i = packet.count; i < end; ++i)
  {
    packet.x[i] = packet.x[0];
    packet.y[i] = packet.y[0];
    packet.frame[i] = packet.beam ? nullptr : packet.frame[0];
  }
  if (packet.beam)
  {
    roundedLanes(*packet.beam, packet.x, packet.y, 0, end, view);
    return;
  }
  for (int first = 0; first < end;)
  {
    const int next = endOfRun(packet, first, end);
    if (next - first >= ShortestRun)
    {
      roundedLanes(*packet.frame[first], packet.x, packet.y, first, next, view);
    }
    else
    {
      for (int i = first; i < next; ++i)
      {
        const Vec3 d = packet.frame[i]->direction(packet.x[i], packet.y[i]);
        view.direction[0][i] = static_cast<float>(d.x);
        view.direction[1][i] = static_cast<float>(d.y);
        view.direction[2][i] = static_cast<float>(d.z);
      }
    }
    first = next;
  }
}
}
