// SPDX-License-Identifier: BSD-3-Clause
#include "SecondaryTrace.h"

#include "Multiversion.h"
#include "SecondaryBeam.h"

#include <cmath>

namespace avianlidar
{
namespace
{
AVIANLIDAR_MULTIVERSION void measureAll(const SampleLanes& lanes, const std::uint32_t* one,
  const std::uint32_t* two, double* lengths, double* cosOut, double* differenceOne, double* cosIn,
  double* cosLobe, double* sin2Lobe, double* sin2Half, double* differenceTwo, std::size_t count)
{
  const SampleLanes h = lanes;
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    const std::uint32_t a = one[i];
    const std::uint32_t b = two[i];
    const double ax = h.dx[a];
    const double ay = h.dy[a];
    const double az = h.dz[a];
    const double bx = h.dx[b];
    const double by = h.dy[b];
    const double bz = h.dz[b];
    const double nx = h.nx[b];
    const double ny = h.ny[b];
    const double nz = h.nz[b];
    // The segment from P1 to P2 and its direction.
    const double sx = h.range[b] * bx - h.range[a] * ax;
    const double sy = h.range[b] * by - h.range[a] * ay;
    const double sz = h.range[b] * bz - h.range[a] * az;
    const double length = std::sqrt((sx * sx + sy * sy) + sz * sz);
    const double tx = sx / length;
    const double ty = sy / length;
    const double tz = sz / length;
    lengths[i] = length;
    cosOut[i] = (h.nx[a] * tx + h.ny[a] * ty) + h.nz[a] * tz;
    const double qx = tx - ax;
    const double qy = ty - ay;
    const double qz = tz - az;
    differenceOne[i] = 0.5 * std::sqrt((qx * qx + qy * qy) + qz * qz);
    // reflectionGeometry() of the segment, the way back to the apex, and the normal at P2.
    const double along = (nx * tx + ny * ty) + nz * tz;
    cosIn[i] = -along;
    const double mx = tx - 2.0 * along * nx;
    const double my = ty - 2.0 * along * ny;
    const double mz = tz - 2.0 * along * nz;
    cosLobe[i] = -((mx * bx + my * by) + mz * bz);
    const double ox = my * bz - mz * by;
    const double oy = mz * bx - mx * bz;
    const double oz = mx * by - my * bx;
    const double off = (ox * ox + oy * oy) + oz * oz;
    sin2Lobe[i] = off < 1.0 ? off : 1.0;
    const double hx = -bx - tx;
    const double hy = -by - ty;
    const double hz = -bz - tz;
    const double square = (hx * hx + hy * hy) + hz * hz;
    const double cx = hy * nz - hz * ny;
    const double cy = hz * nx - hx * nz;
    const double cz = hx * ny - hy * nx;
    const double tilt = ((cx * cx + cy * cy) + cz * cz) / (square > 0.0 ? square : 1.0);
    sin2Half[i] = tilt < 1.0 ? tilt : 1.0;
    differenceTwo[i] = 0.5 * std::sqrt(square);
  }
}
}

std::size_t SecondaryConnections::bytes() const
{
  return this->one.capacity() * (2 * sizeof(std::uint32_t) + sizeof(Visibility)) +
    this->length.capacity() * 9 * sizeof(double);
}

void SecondaryConnections::reserve(std::size_t connections)
{
  this->one.reserve(connections);
  this->two.reserve(connections);
  this->weight.reserve(connections);
}

void SecondaryConnections::add(std::uint32_t hit1, std::uint32_t hit2, double meanWeight)
{
  this->one.push_back(hit1);
  this->two.push_back(hit2);
  this->weight.push_back(meanWeight);
}

void SecondaryConnections::measure(const BeamSamples& hits, const SampleGeometry& geometry)
{
  const std::size_t count = this->size();
  if (count == 0)
  {
    return;
  }
  this->visibility.assign(count, Visibility::Unknown);
  for (std::vector<double>* v : { &this->length, &this->cosOut, &this->differenceOne, &this->cosIn,
         &this->cosLobe, &this->sin2Lobe, &this->sin2Half, &this->differenceTwo })
  {
    v->resize(count);
  }
  const SampleLanes lanes(hits, geometry);
  measureAll(lanes, this->one.data(), this->two.data(), this->length.data(), this->cosOut.data(),
    this->differenceOne.data(), this->cosIn.data(), this->cosLobe.data(), this->sin2Lobe.data(),
    this->sin2Half.data(), this->differenceTwo.data(), count);
}
}
