// SPDX-License-Identifier: BSD-3-Clause
#include "AirFinder.h"

#include "BeamShape.h"
#include "Drops.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
/// Axis and eight points of the unit circle. The last four points are the corners of a rectangular
/// beam.
constexpr double H = BeamShape::HalfSide;
constexpr double Rim[][2] = { { 0.0, 0.0 }, { 1.0, 0.0 }, { -1.0, 0.0 }, { 0.0, 1.0 },
  { 0.0, -1.0 }, { H, H }, { H, -H }, { -H, H }, { -H, -H } };
}

BeamAir AirFinder::along(const BeamFrame& frame, double seconds)
{
  BeamAir air(this->Scan);
  air.Origin = frame.origin;
  air.Seconds = seconds;
  const std::vector<PlacedMedium>& media = this->Scan.media();
  for (std::uint32_t k = 0; k < media.size(); ++k)
  {
    if (!media[k].fillsScene() &&
      mayMeet(media[k].volume, frame, this->Scan.sensor().rangeGate, seconds))
    {
      air.Volumes.push_back(k);
    }
  }
  if (!air.Volumes.empty())
  {
    this->divide(frame, air);
    this->findAlone(air);
  }
  return air;
}

BeamAir AirFinder::alongRay(const Vec3& origin, const Vec3& direction, double seconds)
{
  BeamAir air(this->Scan);
  air.Origin = origin;
  air.Seconds = seconds;
  const std::vector<PlacedMedium>& media = this->Scan.media();
  for (std::uint32_t k = 0; k < media.size(); ++k)
  {
    if (!media[k].fillsScene())
    {
      air.Volumes.push_back(k);
    }
  }
  air.Columns = this->Scan.whole();
  this->findParts(air.Columns[0], origin, direction, air);
  this->findAlone(air);
  return air;
}

/// Divide a beam into the columns that its volumes require, and find the parts of each column.
void AirFinder::divide(const BeamFrame& frame, BeamAir& air)
{
  const Vec3* up = nullptr;
  bool isWide = true;
  bool isLayered = true;
  for (const std::uint32_t k : air.Volumes)
  {
    const MediumVolume& volume = this->Scan.media()[k].volume;
    isWide = isWide && isWiderThan(volume, frame, this->Scan.sensor().rangeGate, air.Seconds);
    isLayered = isLayered && !volume.isBounded() && (!up || *up == volume.up);
    up = &volume.up;
  }
  if (isWide)
  {
    air.Columns.clear();
    for (const auto& [x, y] : Rim)
    {
      air.Columns.push_back({ x, y, 1.0, ~std::uint64_t{ 0 } });
    }
    this->findParts(frame, air);
    if (this->rimAgrees(air))
    {
      air.Columns.resize(1);
      air.Parts.resize(air.Columns[0].lastPart);
      return;
    }
  }
  air.Columns = this->Scan.grid();
  if (isLayered)
  {
    mergeRows(frame, *up, air.Columns);
  }
  this->findParts(frame, air);
}

/// True if rim and axis cross all volumes at the same ranges, to a quarter of a range unit plus a
/// hundredth of the way through. Their optical depths, there and back, must agree within 0.02.
bool AirFinder::rimAgrees(const BeamAir& air) const
{
  const AirColumn& axis = air.Columns[0];
  const double d = this->Scan.sensor().rangeGate;
  const auto isClose = [&](const BeamAir::Part& one, const BeamAir::Part& two)
  {
    const double off = std::max(std::fabs(one.crossing.begin - two.crossing.begin),
      std::fabs(one.crossing.end - two.crossing.end));
    const double length = one.crossing.end - one.crossing.begin;
    return one.seen == two.seen && off < 0.25 * this->Scan.unitLength() + 0.01 * length;
  };
  return std::all_of(air.Columns.begin() + 1, air.Columns.end(),
    [&](const AirColumn& column)
    {
      const BeamAir::PartRange inside = air.partsOf(axis);
      const BeamAir::PartRange parts = air.partsOf(column);
      bool agrees = std::equal(inside.begin(), inside.end(), parts.begin(), parts.end(), isClose);
      // Densities may still differ across the beam.
      for (const double range : { 0.125 * d, 0.25 * d, 0.5 * d, d })
      {
        agrees = agrees && std::fabs(air.depth(column, range) - air.depth(axis, range)) < 0.02;
      }
      return agrees;
    });
}

/// Merge columns of similar height into at most eight rows, as layers depend on height alone.
void AirFinder::mergeRows(const BeamFrame& frame, const Vec3& up, std::vector<AirColumn>& columns)
{
  const auto heightOf = [&](const AirColumn& c)
  { return glm::dot(c.x * frame.e1 + c.y * frame.e2, up); };
  std::stable_sort(columns.begin(), columns.end(),
    [&](const AirColumn& a, const AirColumn& b) { return heightOf(a) < heightOf(b); });
  std::size_t rows = 0;
  double before = 0.0;
  for (std::size_t k = 0; k < columns.size(); ++k)
  {
    const AirColumn column = columns[k];
    const bool begins = std::floor(AirColumn::Across * before) > static_cast<double>(rows) - 1.0;
    before += column.weight;
    if (begins)
    {
      columns[rows++] = column;
      continue;
    }
    AirColumn& row = columns[rows - 1];
    const double weight = row.weight + column.weight;
    row.x = (row.weight * row.x + column.weight * column.x) / weight;
    row.y = (row.weight * row.y + column.weight * column.y) / weight;
    row.weight = weight;
    row.bits |= column.bits;
  }
  columns.resize(rows);
}

void AirFinder::findParts(const BeamFrame& frame, BeamAir& air)
{
  air.Parts.clear();
  for (AirColumn& column : air.Columns)
  {
    this->findParts(column, frame.origin, unitVector(frame.direction(column.x, column.y)), air);
  }
}

void AirFinder::findParts(
  AirColumn& column, const Vec3& origin, const Vec3& direction, BeamAir& air)
{
  column.firstPart = air.Parts.size();
  for (std::size_t k = 0; k < air.Volumes.size(); ++k)
  {
    const auto& [medium, volume] = this->Scan.media()[air.Volumes[k]];
    this->Found.clear();
    this->Crosser.find(
      volume, origin, direction, this->Scan.sensor().rangeGate, air.Seconds, this->Found);
    // The mean projection of a disc over all directions is half its area.
    const bool isLeaves = medium.sharesGaps && medium.extinction > 0.0;
    const double perLeaf =
      isLeaves ? std::sqrt(Pi * medium.drops / (8.0 * medium.extinction)) : 0.0;
    for (const MediumCrossing& part : this->Found)
    {
      air.Parts.push_back({ this->Scan.filling().size() + k, part,
        (medium.sharesGaps ? 1.0 : 2.0) * medium.extinction, perLeaf });
    }
  }
  column.lastPart = air.Parts.size();
}

/// Find the units in which volumes may be perceived by themselves.
void AirFinder::findAlone(BeamAir& air) const
{
  const Sensor& sensor = this->Scan.sensor();
  for (const BeamAir::Part& part : air.Parts)
  {
    const Medium& medium = air.mediumAt(air.mediumMet(part.seen));
    const bool isAlone = medium.drops > 0.0 || !medium.isFollowed || !sensor.followsAir();
    if (!isAlone || !(medium.backscatter() > 0.0) || !(sensor.receiverAperture > 0.0))
    {
      continue;
    }
    // Pulses of drops reach into neighbouring units.
    const std::int64_t reach = medium.isFollowed ? this->Scan.reach() : 0;
    const auto unitOf = [&](double range)
    { return static_cast<std::int64_t>(std::floor(range / this->Scan.unitLength())); };
    const std::int64_t first = std::max<std::int64_t>(0, unitOf(part.crossing.begin) - reach);
    const std::int64_t end =
      std::min(this->Scan.gateUnits(), unitOf(part.crossing.end) + 1 + reach);
    if (!air.Alone.empty() && first <= air.Alone.back().second && air.Alone.back().first <= end)
    {
      auto& last = air.Alone.back();
      last = { std::min(last.first, first), std::max(last.second, end) };
    }
    else if (first < end)
    {
      air.Alone.emplace_back(first, end);
    }
  }
}
}
