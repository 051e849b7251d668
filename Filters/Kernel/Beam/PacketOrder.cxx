// SPDX-License-Identifier: BSD-3-Clause
#include "PacketOrder.h"

#include "BeamRays.h"

#include <algorithm>
#include <numeric>

namespace avianlidar
{
namespace
{
void halve(const BeamRays& rays, std::uint32_t* begin, std::uint32_t* end)
{
  const auto count = static_cast<std::size_t>(end - begin);
  if (count <= PacketGroup)
  {
    return;
  }
  const auto extent = [&](const std::vector<double>& v)
  {
    const auto range = std::minmax_element(
      begin, end, [&v](std::uint32_t a, std::uint32_t b) { return v[a] < v[b]; });
    return v[*range.second] - v[*range.first];
  };
  const std::vector<double>& v = extent(rays.x) >= extent(rays.y) ? rays.x : rays.y;
  const std::size_t groups = (count + PacketGroup - 1) / PacketGroup;
  std::uint32_t* const middle = begin + groups / 2 * PacketGroup;
  std::nth_element(begin, middle, end,
    [&v](std::uint32_t a, std::uint32_t b) { return v[a] < v[b] || (v[a] == v[b] && a < b); });
  halve(rays, begin, middle);
  halve(rays, middle, end);
}
}

const std::vector<std::uint32_t>& PacketOrder::of(std::size_t rays)
{
  if (this->Known.size() != rays)
  {
    this->Known.resize(rays);
    std::iota(this->Known.begin(), this->Known.end(), 0u);
    const StrataPartition strata(rays);
    BeamRays drawn;
    sampleBeam(0, 0, rays, { 1e-3 }, Sampling::Stratified, &strata, drawn);
    halve(drawn, this->Known.data(), this->Known.data() + rays);
  }
  return this->Known;
}

const std::vector<std::uint32_t>& PacketOrder::asTheyCome(std::size_t rays)
{
  while (this->Natural.size() < rays)
  {
    this->Natural.push_back(static_cast<std::uint32_t>(this->Natural.size()));
  }
  return this->Natural;
}
}
