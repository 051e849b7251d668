// SPDX-License-Identifier: BSD-3-Clause
#include "BeamCells.h"

#include "DiscPolygon.h"
#include "KeySort.h"
#include "Random.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

namespace avianlidar
{
namespace
{
constexpr std::size_t Patterns = 256; ///< number of jitter patterns

/// Largest level of cells with small objects, and of cells about the middle of a lobe.
constexpr int MostLevels = 8;
constexpr int LevelsOfFoot = 5;

/// Largest m of a cell with small objects. A cell that needs more rays is divided.
constexpr int MostBlocksOfCell = 3;

/// Squares of a beam without lists hold at most this number of rays, squared, for each ray of the
/// grid. Triangles of objects that need more rays have lists, and so have triangles that extend
/// over more than MostSquares squares.
constexpr int MostOfSquare = 16;
constexpr int MostSquares = 256;

/// A beam with small objects traces at most this number of blocks of rays through the tree, or
/// PlannedPerUsual times the blocks without small objects. If the limit were ten times these blocks
/// alone, a goose before a wall of many triangles would err by up to 9 % instead of 6 %.
constexpr double MostPlannedBlocks = 20000.0;
constexpr double PlannedPerUsual = 4.0;

/// Areas of objects are counted in parts of a squared half-beamwidth. LargeArea exceeds the area of
/// the disc.
constexpr double PartsOfArea = 1099511627776.0; // 2^40
constexpr double LargeArea = 4.0;
constexpr std::uint64_t LargeParts = std::uint64_t(1) << 42;

/// Objects that return the lower limit divided by HeardMargin have all their rays, because Gaussian
/// beams are brighter in the middle, several objects may share an echo, and noise adds energy. In
/// beams without lists, objects that return more have up to RaysOfHeard times as many rays, as a
/// bird before other objects would else err by 1.7 instead of 1.4 % rms (cliff_crowded.py).
constexpr double HeardMargin = 4.0;
constexpr double RaysOfHeard = 2.0;

/// An object with this sum returns at least the lower limit (smallShareOf()).
constexpr std::uint64_t HeardParts = std::uint64_t(1) << 43;

/// If small objects cover this share of a beam without lists, large objects show small parts
/// between them. All cells then have at least m = BlocksOfCrowd. With m = 3, energies in
/// cliff_crowded.py err by up to 1.9 times as much as with 4.
constexpr double ShareOfCrowd = 0.0625;
constexpr int BlocksOfCrowd = 4;

/// A coordinate outside of all cells.
constexpr float Nowhere = 1e30f;

/// Area of a square's part in the disc. The square must not cross an axis.
double areaInDisc(double x, double y, double width)
{
  const double x0 = std::min(std::fabs(x), std::fabs(x + width));
  const double y0 = std::min(std::fabs(y), std::fabs(y + width));
  const double x1 = x0 + width;
  const double y1 = y0 + width;
  if (x1 * x1 + y1 * y1 <= 1.0)
  {
    return width * width;
  }
  if (x0 * x0 + y0 * y0 >= 1.0)
  {
    return 0.0;
  }
  PlaneRing ring;
  for (const PlanePoint& corner :
    { PlanePoint{ x0, y0 }, PlanePoint{ x1, y0 }, PlanePoint{ x1, y1 }, PlanePoint{ x0, y1 } })
  {
    ring.add(corner);
  }
  return areaInDisc(ring);
}

/// Share of the beam that a body fills. @param area sum over its front and its back
double shareOf(std::uint64_t area)
{
  return 0.5 * (static_cast<double>(area) / PartsOfArea) / Pi;
}

bool isInBeam(const BeamShape& shape, const CellRays& rays, int i)
{
  return shape.holds(static_cast<double>(rays.x[i]), static_cast<double>(rays.y[i]));
}

/// Area of a square's part in a rectangular beam. The square must not cross an axis.
double areaInRectangle(double x, double y, double width)
{
  const auto within = [&](double from)
  {
    const double inner = std::min(std::fabs(from), std::fabs(from + width));
    return std::clamp(BeamShape::HalfSide - inner, 0.0, width);
  };
  return within(x) * within(y);
}
}

BeamCells::BeamCells(const ScanSetup& setup, const SceneTriangles& scene)
  : Setup(setup)
  , Scene(scene)
  , Density(densityOfCells(setup.settings.raysPerBeam))
  , Shape(setup.sensor)
  , Strips(setup)
  , Seen(scene)
{
  for (std::uint32_t side = 4; side <= 16; side *= 4)
  {
    for (std::uint32_t k = 0; k < side * side; ++k)
    {
      const double width = 2.0 / side;
      this->Areas.push_back(
        this->areaOf(width * (k % side) - 1.0, width * (k / side) - 1.0, width));
    }
  }
}

/// Area of a square's part in the beam.
double BeamCells::areaOf(double x, double y, double width) const
{
  return this->Shape.width().isRectangle ? areaInRectangle(x, y, width) : areaInDisc(x, y, width);
}

/// Area of a cell's part in the beam. The first two levels, which hold most cells, have a table.
double BeamCells::areaOf(int level, std::uint32_t column, std::uint32_t row) const
{
  const std::uint32_t side = 1u << 2 * level;
  const double width = 2.0 / side;
  return level > 2 ? this->areaOf(width * column - 1.0, width * row - 1.0, width)
                   : this->Areas[(level == 1 ? 0 : 16) + row * side + column];
}

void BeamCells::begin(std::uint64_t beam, const BeamFrame& frame)
{
  this->Beam = beam;
  this->Frame = frame;
  this->Tangent2 = frame.tanHalf * frame.tanHalf;
  this->ShareOfArea = this->Shape.shareOfArea();
  this->TooMany = false;
  this->IsCrowded = false;
  this->MostHeard = 1.0;
  this->LeastBlocks = this->Density.blocks;
  this->Objects.clear();
  this->Large.clear();
  this->Levels.resize(MostLevels + 1);
  if (this->Jitter.empty())
  {
    this->Jitter.resize(Patterns * 2 * CellLanes);
    for (std::size_t i = 0; i < Patterns * CellLanes; ++i)
    {
      const auto u =
        uniformPair(this->Setup.settings.seed, i / CellLanes, i % CellLanes, RandomPurpose::Cells);
      const std::size_t lane = i % CellLanes;
      float* const block = &this->Jitter[i / CellLanes * 2 * CellLanes];
      block[lane] = static_cast<float>(lane % 4 + u[0]);
      block[CellLanes + lane] = static_cast<float>(lane / 4 + u[1]);
    }
  }
}

/// Add an area to an object, often the object added last. Integer sums do not depend on the order
/// in which areas are added. @param heard energy that the area would return, divided by the lower
/// limit
void BeamCells::addToObject(int id, double area, double heard)
{
  if (this->Objects.empty() || id != this->Objects.back().id)
  {
    this->Objects.push_back({ id, 0, 0 });
  }
  const auto partsOf = [](double sum)
  { return sum < LargeArea ? static_cast<std::uint64_t>(sum * PartsOfArea) : LargeParts; };
  ObjectSums& sums = this->Objects.back();
  sums.area += partsOf(area);
  sums.heard += partsOf(heard);
  // Twice the area up to which smallShareOf() is positive.
  if (static_cast<double>(sums.area) >
    4.0 * Pi * this->Density.raysOnObject() / this->Density.rays() * PartsOfArea)
  {
    this->Large.push_back(id);
  }
}

/// True once the object is known to be large.
bool BeamCells::isLarge(int id) const
{
  return std::find(this->Large.begin(), this->Large.end(), id) != this->Large.end();
}

void BeamCells::addToObject(const BeamSurface& s)
{
  const int id = this->Setup.objectId(s.triangle);
  const int idOfOther = s.other != NoTriangle ? this->Setup.objectId(s.other) : id;
  if (s.area != AreaUnknown && id == idOfOther)
  {
    this->addToObject(id, s.area, LargeArea);
  }
  else
  {
    this->addPart(s.triangle);
    this->addPart(s.other);
  }
}

/// Add a triangle's part in the disc to its object, unless the object is known to be large.
void BeamCells::addPart(std::uint32_t triangle)
{
  if (triangle == NoTriangle || this->isLarge(this->Setup.objectId(triangle)))
  {
    return;
  }
  const int id = this->Setup.objectId(triangle);
  const Corners t = this->Scene.cornersFrom(triangle, this->Frame.origin);
  if (!this->IsCrowded)
  {
    this->addToObject(id, this->areaInDiscOf(t), LargeArea);
    return;
  }
  Part part{ triangle, id, { 1.0f, 1.0f }, { -1.0f, -1.0f } };
  PlanePoint places[3];
  double nearest = Infinity;
  bool isInside = true;
  for (int i = 0; i < 3; ++i)
  {
    const Vec3& corner = i == 0 ? t.a : i == 1 ? t.b : t.c;
    const double z = glm::dot(corner, this->Frame.axis);
    const double inverse = 1.0 / z;
    const PlanePoint& p = places[i] = { glm::dot(corner, this->AcrossX) * inverse,
      glm::dot(corner, this->AcrossY) * inverse };
    nearest = std::min(nearest, z);
    isInside = isInside && p.x * p.x + p.y * p.y < 1.0;
    part.low[0] = std::min(part.low[0], static_cast<float>(p.x));
    part.low[1] = std::min(part.low[1], static_cast<float>(p.y));
    part.high[0] = std::max(part.high[0], static_cast<float>(p.x));
    part.high[1] = std::max(part.high[1], static_cast<float>(p.y));
  }
  const bool isAhead = nearest > 0.0;
  const double area = isAhead && isInside ? 0.5 *
      std::fabs((places[1].x - places[0].x) * (places[2].y - places[0].y) -
        (places[1].y - places[0].y) * (places[2].x - places[0].x))
                                          : this->areaInDiscOf(t);
  if (!isAhead) // the triangle may be anywhere
  {
    part.low[0] = part.low[1] = -1.0f;
    part.high[0] = part.high[1] = 1.0f;
  }
  this->Parts.push_back(part);
  const bool isHeard = !this->Objects.empty() && this->Objects.back().id == id &&
    this->Objects.back().heard >= HeardParts;
  this->addToObject(
    id, area, isHeard ? 0.0 : this->heardOf(triangle, t, area, std::max(0.0, nearest)));
}

/// Sort `Objects` by id, and add up the areas of each object.
void BeamCells::sumObjects()
{
  if (this->Objects.empty())
  {
    return;
  }
  std::sort(this->Objects.begin(), this->Objects.end(),
    [](const ObjectSums& a, const ObjectSums& b) { return a.id < b.id; });
  std::size_t last = 0;
  for (std::size_t k = 1; k < this->Objects.size(); ++k)
  {
    if (this->Objects[k].id == this->Objects[last].id)
    {
      this->Objects[last].area += this->Objects[k].area;
      this->Objects[last].heard += this->Objects[k].heard;
    }
    else
    {
      this->Objects[++last] = this->Objects[k];
    }
  }
  this->Objects.resize(last + 1);
}

/// Share of the beam that an object fills, if too few rays of the grid fall on the object. The
/// share is 0 otherwise. If the object cannot be heard, the share is as many times larger as the
/// energy is too small, so that objects that are heard together have enough rays together.
float BeamCells::smallShareOf(int id) const
{
  if (this->isLarge(id))
  {
    return 0.0f;
  }
  const auto object = std::lower_bound(this->Objects.begin(), this->Objects.end(), id,
    [](const ObjectSums& one, int wanted) { return one.id < wanted; });
  const double share = shareOf(object->area);
  const double heard = std::min(this->MostHeard, HeardMargin * shareOf(object->heard));
  const double large = this->Density.raysOnObject() / this->Density.rays();
  return share > this->LeastShare && share < large
    ? static_cast<float>(share < heard * large ? share / heard : large)
    : 0.0f;
}

/// Set the surfaces in single precision. 1/z is divided by its largest value, so that 1/z is
/// finite.
void BeamCells::setSurfaces()
{
  constexpr float outwards = 1.0f + 1e-6f;
  constexpr double rounding = 4e-7;
  this->HasFeet = false;
  this->HasObjects = false;
  this->Surfaces.resize(this->All->size());
  this->MetIn.resize(std::max(this->MetIn.size(), this->Surfaces.size()), 0);
  constexpr double least = 1e-30; // value of the farthest surface, if another one is at the apex
  const double scale = this->All->empty()
    ? 1.0
    : std::max(1.0 / this->All->front()->sortInverse, least / this->All->back()->sortInverse);
  const double perFoot = 1.0 / this->Tangent2;
  for (std::size_t k = 0; k < this->Surfaces.size(); ++k)
  {
    const BeamSurface& from = *(*this->All)[k];
    CellSurface& s = this->Surfaces[k];
    for (int i = 0; i < 4; ++i)
    {
      const PlaneLine line = i < from.count ? from.lines[i] : PlaneLine{ 0.0, 0.0, 1.0 };
      s.lines[i][0] = static_cast<float>(line.x);
      s.lines[i][1] = static_cast<float>(line.y);
      s.lines[i][2] = static_cast<float>(line.z);
      s.slopes[i] = std::fabs(s.lines[i][0]) + std::fabs(s.lines[i][1]);
    }
    const PlaneLine& w = from.inverse;
    s.inverse[0] = static_cast<float>(scale * w.x);
    s.inverse[1] = static_cast<float>(scale * w.y);
    s.inverse[2] = static_cast<float>(scale * w.z);
    s.inverseSlope = std::fabs(s.inverse[0]) + std::fabs(s.inverse[1]);
    s.most = outwards * static_cast<float>(scale * from.sortInverse);
    s.slack =
      static_cast<float>(rounding * scale * (std::fabs(w.x) + std::fabs(w.y) + std::fabs(w.z)));
    const int id = this->Setup.objectId(from.triangle);
    s.share = this->smallShareOf(id);
    if (from.other != NoTriangle && this->Setup.objectId(from.other) != id)
    {
      const float share = this->smallShareOf(this->Setup.objectId(from.other));
      s.share = share > 0.0f && (share < s.share || s.share == 0.0f) ? share : s.share;
    }
    this->HasObjects = this->HasObjects || s.share > 0.0f;
    const double x = perFoot * w.x / w.z;
    const double y = perFoot / this->Frame.flatness2 * w.y / w.z;
    const bool isIn = std::fabs(x) < 2.0 && std::fabs(y) < 2.0;
    s.foot[0] = isIn ? static_cast<float>(x) : Nowhere;
    s.foot[1] = isIn ? static_cast<float>(y) : Nowhere;
    this->HasFeet = this->HasFeet || isIn;
  }
}

/// Divide the whole disc.
void BeamCells::divideAll(bool plans)
{
  this->Plans = plans;
  this->Whole.resize(this->All->size());
  std::iota(this->Whole.begin(), this->Whole.end(), 0u);
  this->divide({ 0, 0, 0, 0.0f, -1.0, -1.0, 2.0, this->Shape.area() },
    { this->Whole.data(), static_cast<std::uint32_t>(this->Whole.size()) });
}

std::unique_ptr<CellSamples> BeamCells::find(
  std::uint64_t beam, const BeamFrame& frame, const std::vector<const BeamSurface*>& entering)
{
  this->begin(beam, frame);
  this->All = &entering;
  this->Strips.begin(frame, entering);
  for (const BeamSurface* s : entering)
  {
    this->addToObject(*s);
  }
  this->sumObjects();
  this->setSurfaces();
  this->divideAll(false);
  return this->TooMany ? nullptr : this->Strips.collect();
}

/// Area of a triangle's part in the disc, in half-beamwidths squared. @param t corners relative to
/// the apex, m
double BeamCells::areaInDiscOf(const Corners& t) const
{
  const Vec3 corners[3] = { this->Frame.toPlane(t.a), this->Frame.toPlane(t.b),
    this->Frame.toPlane(t.c) };
  // The part in front of the apex has at most four corners.
  const double nearest = 1e-9 *
    std::max(std::fabs(corners[0].z), std::max(std::fabs(corners[1].z), std::fabs(corners[2].z)));
  PlaneRing ring;
  for (int i = 0; i < 3; ++i)
  {
    const Vec3& p = corners[i];
    const Vec3& q = corners[(i + 1) % 3];
    if (p.z > nearest)
    {
      ring.add({ p.x / p.z, p.y / p.z });
    }
    if ((p.z > nearest) != (q.z > nearest))
    {
      const Vec3 cut = p + (nearest - p.z) / (q.z - p.z) * (q - p);
      ring.add({ cut.x / nearest, cut.y / nearest });
    }
  }
  return areaInDisc(ring);
}

namespace
{
/// Upper bound of the shares of light that a surface returns straight back, plus the light that the
/// lobe of the surface sends to a second, matt surface and back, on the path and on its reverse.
Reflectance mostReturned(const ScanSetup& setup, const Material& material, double mostCosine)
{
  Reflectance most = mostStraightBack(setup.settings.reflectanceModel, material, mostCosine);
  most.diffuse += 2.0 * material.ks * setup.largestReflectance;
  return most;
}
}

/// Energy that a triangle would return if nothing hid it, in units of the lower limit and of the
/// share of one unit of area. @param t corners relative to the apex, m
/// @param area area of the triangle's part in the disc, half-beamwidths squared
/// @param nearest lower bound of the range, m
double BeamCells::heardOf(std::uint32_t triangle, const Corners& t, double area, double nearest)
{
  const Sensor& sensor = this->Setup.sensor;
  const Material& material = this->Setup.material(triangle);
  if (material != this->OfReturn)
  {
    this->OfReturn = material;
    this->Return = mostReturned(this->Setup, material, 1.0);
  }
  Reflectance most = this->Return;
  if (material.ks > 0.0)
  {
    const BeamFrame& f = this->Frame;
    const Vec3 normal = glm::cross(t.b - t.a, t.c - t.a);
    const double cosine = std::fabs(glm::dot(normal, f.axis)) / std::sqrt(glm::dot(normal, normal));
    if (cosine < f.cosHalf) // no ray of the beam is perpendicular to the triangle
    {
      const double sine = std::sqrt(1.0 - cosine * cosine);
      most = mostReturned(this->Setup, material, cosine * f.cosHalf + sine * f.sinHalf);
    }
  }
  const double energy = area * sensor.pulseEnergy *
    throughAperture(most, material, sensor.receiverAperture, nearest).total();
  return this->Scene.isMoved(triangle) || !(energy < LargeArea * sensor.lowerEnergyLimit)
    ? LargeArea
    : energy / sensor.lowerEnergyLimit;
}

/// Mark the squares that a triangle of a small object may enter. @return false if the triangle
/// needs a list
bool BeamCells::mark(const Part& part, float share)
{
  const int side = 4 << 2 * this->Density.levels;
  const float perSquare = 0.5f * static_cast<float>(side);
  // Boxes are wider than rounding.
  const auto squareOf = [&](float place, float slack)
  { return static_cast<int>(std::clamp((place + slack + 1.0f) * perSquare, 0.0f, side - 1.0f)); };
  const int columns[] = { squareOf(part.low[0], -1e-6f), squareOf(part.high[0], 1e-6f) };
  const int rows[] = { squareOf(part.low[1], -1e-6f), squareOf(part.high[1], 1e-6f) };
  if ((rows[1] - rows[0] + 1) * (columns[1] - columns[0] + 1) > MostSquares)
  {
    return false;
  }
  for (int row = rows[0]; row <= rows[1]; ++row)
  {
    for (int column = columns[0]; column <= columns[1]; ++column)
    {
      float& marked = this->Marks[row * side + column];
      marked = std::min(marked, share);
    }
  }
  return true;
}

/// Mark the squares of small objects. @return triangles that need lists
const std::vector<std::uint32_t>& BeamCells::markAll()
{
  const double width = 2.0 / (1 << 2 * this->Density.levels);
  this->Marks.assign(std::size_t(16) << 4 * this->Density.levels, FloatInfinity);
  this->Whole.clear();
  int id = 0;
  float share = -1.0f; // share of object `id`; negative before the first object
  bool isListed = false;
  for (const Part& part : this->Parts)
  {
    if (share < 0.0f || id != part.id)
    {
      id = part.id;
      share = this->smallShareOf(id);
      const int blocks = share > 0.0f ? this->blocksFor(width, share) : 0;
      isListed = blocks > MostOfSquare * this->Density.blocks;
      share = blocks > this->LeastBlocks ? share : 0.0f;
    }
    if (isListed || (share > 0.0f && !this->mark(part, share)))
    {
      this->Whole.push_back(part.triangle);
    }
  }
  return this->Whole;
}

const BeamRays& BeamCells::place(
  std::uint64_t beam, const BeamFrame& frame, const std::vector<std::uint32_t>& numbers)
{
  this->begin(beam, frame);
  this->IsCrowded = true;
  this->Return = mostReturned(this->Setup, this->OfReturn, 1.0);
  this->AcrossX = frame.e1 / frame.tanHalf;
  this->AcrossY = frame.e2 / (frame.tanHalf * frame.flatness2);
  this->Parts.clear();
  for (const std::uint32_t number : numbers)
  {
    this->addPart(number);
  }
  this->sumObjects();
  double covered = 0.0; // share of the beam that small objects cover
  for (const ObjectSums& object : this->Objects)
  {
    const double share = shareOf(object.area);
    covered += share * this->Density.rays() < this->Density.raysOnObject() ? share : 0.0;
  }
  const int blocks = std::max(this->Density.blocks, covered < ShareOfCrowd ? 1 : BlocksOfCrowd);
  this->LeastBlocks = blocks;
  this->MostHeard = RaysOfHeard;
  const double usual = this->Density.rays() / CellLanes;
  const double most = std::max(MostPlannedBlocks, PlannedPerUsual * usual);
  while (true)
  {
    const std::vector<std::uint32_t>& listed = this->markAll();
    this->Seen.begin(frame);
    this->Seen.add(listed.data(), listed.size());
    this->All = &this->Seen.sort();
    this->setSurfaces();
    this->HasObjects = this->HasObjects ||
      std::any_of(
        this->Marks.begin(), this->Marks.end(), [](float share) { return share < FloatInfinity; });
    this->Rays.x.clear();
    this->Rays.y.clear();
    this->Blocks.clear();
    this->Shares.clear();
    this->TooMany = false;
    this->MostBlocks = static_cast<std::size_t>(most);
    this->divideAll(true);
    if (!this->TooMany || !this->HasObjects)
    {
      break;
    }
    // If small objects need too many rays, they and the grid have fewer. If they still need too
    // many, the smallest objects get no rays of their own.
    const bool isFirst = this->MostHeard > 1.0;
    this->LeastBlocks = isFirst ? this->Density.blocks : blocks;
    this->LeastShare *= isFirst ? 1.0 : 4.0;
    this->MostHeard = 1.0;
  }
  this->LeastShare = LeastShareOfObject;
  this->TooMany = false;
  return this->Rays;
}

std::unique_ptr<CellSamples> BeamCells::find(const std::uint32_t* triangles)
{
  this->Hits.clear();
  for (std::size_t i = 0; i < this->Rays.size(); ++i)
  {
    this->Hits.push_back(keyAbove(triangles[i], i));
  }
  sortKeys(this->Hits);
  this->Whole.clear(); // triangles that are hit
  for (const std::uint64_t hit : this->Hits)
  {
    if (keyOf(hit) != NoTriangle && (this->Whole.empty() || this->Whole.back() != keyOf(hit)))
    {
      this->Whole.push_back(keyOf(hit));
    }
  }
  this->Seen.begin(this->Frame);
  this->Seen.add(this->Whole.data(), this->Whole.size());
  this->All = &this->Seen.sort();
  this->Strips.begin(this->Frame, *this->All);
  this->Numbers.clear();
  for (std::size_t k = 0; k < this->All->size(); ++k)
  {
    const BeamSurface& s = *(*this->All)[k];
    this->Numbers.push_back(keyAbove(s.triangle, k));
    if (s.other != NoTriangle)
    {
      this->Numbers.push_back(keyAbove(s.other, k));
    }
  }
  this->Numbers.push_back(keyAbove(NoTriangle, 0xffffffffu)); // key that is read as surface -1
  sortKeys(this->Numbers);
  this->OfRays.resize(this->Hits.size());
  auto known = this->Numbers.begin();
  for (const std::uint64_t hit : this->Hits)
  {
    while (keyOf(*known) < keyOf(hit))
    {
      ++known;
    }
    this->OfRays[numberOf(hit)] =
      keyOf(*known) == keyOf(hit) ? static_cast<std::int32_t>(numberOf(*known)) : -1;
  }
  const std::int32_t* ray = this->OfRays.data();
  for (std::size_t b = 0; b < this->Blocks.size() && !this->TooMany; ++b)
  {
    CellRays& block = this->Blocks[b];
    for (int i = 0; i < CellLanes; ++i)
    {
      block.seen[i] = isInBeam(this->Shape, block, i) ? *ray++ : -1;
    }
    this->TooMany = !this->Strips.add(block, this->Shares[b]);
  }
  return this->TooMany ? nullptr : this->Strips.collect();
}

/// m of a square of a given width, so that an object that fills a share has enough rays. Without
/// lists, squares smaller than the usual cells are about as fine as these.
int BeamCells::blocksFor(double width, float share) const
{
  const double rays = this->Density.raysOnObject() * width * width * this->ShareOfArea / share;
  const double least = this->IsCrowded
    ? this->LeastBlocks * width * (1 << (2 * this->Density.levels - 1))
    : this->LeastBlocks;
  return static_cast<int>(std::ceil(std::max(least, std::sqrt(rays / CellLanes))));
}

/// Least share of the small objects in the list of a cell, or in the square that holds the cell.
float BeamCells::smallestIn(const Cell& cell, List list) const
{
  const int deeper = 2 * (cell.level - this->Density.levels - 1);
  float smallest = FloatInfinity;
  if (this->Plans && deeper >= 0)
  {
    const int perSide = 2 * (this->Density.levels + 1);
    smallest = this->Marks[(cell.row >> deeper << perSide) + (cell.column >> deeper)];
  }
  for (std::uint32_t k = 0; this->HasObjects && k < list.count; ++k)
  {
    const float share = this->Surfaces[list.surfaces[k]].share;
    smallest = share > 0.0f && share < smallest ? share : smallest;
  }
  return smallest;
}

/// True if the middle of a specular lobe lies in a cell or near the cell.
bool BeamCells::mayHoldFoot(const Cell& cell, List list) const
{
  const double x = cell.x + 0.5 * cell.width;
  const double y = cell.y + 0.5 * cell.width;
  return this->HasFeet &&
    std::any_of(list.surfaces, list.surfaces + list.count,
      [&](std::uint32_t number)
      {
        const CellSurface& s = this->Surfaces[number];
        return std::fabs(s.foot[0] - x) < cell.width && std::fabs(s.foot[1] - y) < cell.width;
      });
}

void BeamCells::divide(const Cell& cell, List list)
{
  Level& level = this->Levels[cell.level];
  CellChildren& children = level.children;
  const double width = 0.25 * cell.width;
  children.x = static_cast<float>(cell.x);
  children.y = static_cast<float>(cell.y);
  children.width = static_cast<float>(width);
  level.numbers.resize(std::max<std::size_t>(level.numbers.size(), CellLanes * list.count));
  double areas[CellLanes];
  for (std::uint32_t i = 0; i < CellLanes; ++i)
  {
    areas[i] = this->areaOf(cell.level + 1, 4 * cell.column + i % 4, 4 * cell.row + i / 4);
    children.occluders[i] = areas[i] > 0.0 ? cell.occluder : FloatInfinity;
    children.counts[i] = 0;
    children.lists[i] = level.numbers.data() + i * list.count;
  }
  distribute(this->Surfaces.data(), list.surfaces, list.count, children);
  for (std::uint32_t i = 0; i < CellLanes && !this->TooMany; ++i)
  {
    if (children.counts[i] > 0 || (this->Plans && areas[i] > 0.0))
    {
      this->solve(
        { cell.level + 1, 4 * cell.column + i % 4, 4 * cell.row + i / 4, children.occluders[i],
          cell.x + width * (i % 4), cell.y + width * (i / 4), width, areas[i] },
        { children.lists[i], children.counts[i] });
    }
  }
}

/// Take a cell as one sample, divide it, or trace its rays.
void BeamCells::solve(const Cell& cell, List list)
{
  const double half = 0.5 * cell.width;
  const bool rim = cell.area < cell.width * cell.width;
  if (!this->Plans && !rim && cell.occluder > 0.0f && list.count == 1 &&
    this->Strips.addWhole(list.surfaces[0], { cell.x + half, cell.y + half }, cell.width,
      cell.area * this->ShareOfArea))
  {
    return;
  }
  const int most = std::max(MostBlocksOfCell, this->LeastBlocks);
  const int blocks = this->blocksFor(cell.width, this->smallestIn(cell, list));
  const bool divides = cell.level < this->Density.levels ||
    (cell.level < MostLevels && blocks > most) ||
    (cell.level < LevelsOfFoot && this->mayHoldFoot(cell, list));
  if (divides)
  {
    this->divide(cell, list);
  }
  else if (this->Plans && cell.level == this->Density.levels)
  {
    this->planSquares(cell, list, std::min(blocks, most));
  }
  else
  {
    this->trace(cell, list, std::min(blocks, most));
  }
}

/// Place the rays of a cell, more of them in the squares that are marked. @param blocks m of
/// squares that are not marked
void BeamCells::planSquares(const Cell& cell, List list, int blocks)
{
  const std::uint32_t side = 4u << 2 * cell.level;
  int of[CellLanes]; // m of each square, as if it were the m of the cell
  int most = blocks;
  bool isEven = true;
  for (std::uint32_t k = 0; k < CellLanes; ++k)
  {
    const float share = this->Marks[(4 * cell.row + k / 4) * side + 4 * cell.column + k % 4];
    of[k] = std::max(blocks, this->blocksFor(cell.width, share));
    most = std::max(most, of[k]);
    isEven = isEven && of[k] == of[0];
  }
  if (isEven || cell.area < cell.width * cell.width)
  {
    // If cells at the rim were not divided, they would often exhaust the limit of blocks.
    return isEven ? this->trace(cell, list, most) : this->divide(cell, list);
  }
  CellRays block;
  for (int m = blocks; m <= most && !this->TooMany; ++m)
  {
    const double share = cell.area / (CellLanes * m * m) * this->ShareOfArea;
    for (int b = 0; std::find(of, of + CellLanes, m) != of + CellLanes && b < m * m; ++b)
    {
      const auto isIn = [&](int lane)
      {
        const int row = (b / m * 4 + lane / 4) / m;
        return of[4 * row + (b % m * 4 + lane % 4) / m] == m;
      };
      bool any = false;
      this->place(cell, b, m, 1.0f, block);
      for (int i = 0; i < CellLanes; ++i)
      {
        any = any || isIn(i);
        block.x[i] = isIn(i) ? block.x[i] : Nowhere;
      }
      if (any)
      {
        this->plan(block, share);
      }
    }
  }
}

/// Place the rays of a block of a cell, one ray in each of sixteen squares. @param pull factor by
/// which the rays are drawn towards the corner nearest to the axis; 1: not at all
void BeamCells::place(const Cell& cell, int block, int blocks, float pull, CellRays& rays) const
{
  std::uint64_t hash = this->Beam + 1;
  for (const std::uint64_t number :
    { static_cast<std::uint64_t>(cell.column), static_cast<std::uint64_t>(cell.row),
      static_cast<std::uint64_t>(cell.level), static_cast<std::uint64_t>(block) })
  {
    hash = (hash ^ (hash >> 31)) * 0x9e3779b97f4a7c15u + number;
  }
  hash ^= hash >> 31;
  hash *= 0x94d049bb133111ebu;
  const float* const jitter = &this->Jitter[(hash >> 56) * 2 * CellLanes];
  const auto spacing = static_cast<float>(cell.width / (4.0 * blocks));
  const auto x0 = static_cast<float>(cell.x + cell.width * (block % blocks) / blocks);
  const auto y0 = static_cast<float>(cell.y + cell.width * (block / blocks) / blocks);
  for (int i = 0; i < CellLanes; ++i)
  {
    rays.x[i] = x0 + spacing * jitter[i];
    rays.y[i] = y0 + spacing * jitter[CellLanes + i];
  }
  if (pull < 1.0f)
  {
    const double middle = 0.5 * cell.width; // no cell crosses an axis
    const auto x = static_cast<float>(cell.x + middle < 0.0 ? cell.x + cell.width : cell.x);
    const auto y = static_cast<float>(cell.y + middle < 0.0 ? cell.y + cell.width : cell.y);
    for (int i = 0; i < CellLanes; ++i)
    {
      rays.x[i] = x + pull * (rays.x[i] - x);
      rays.y[i] = y + pull * (rays.y[i] - y);
    }
  }
}

/// Keep a block whose rays are to be traced.
void BeamCells::plan(const CellRays& block, double share)
{
  if (this->HasObjects && this->Blocks.size() >= this->MostBlocks)
  {
    this->TooMany = true;
    return;
  }
  this->Blocks.push_back(block);
  this->Shares.push_back(share);
  for (int i = 0; i < CellLanes; ++i)
  {
    if (isInBeam(this->Shape, block, i))
    {
      this->Rays.x.push_back(block.x[i]);
      this->Rays.y.push_back(block.y[i]);
    }
  }
}

/// Test the rays of a cell against its list. A surface in the list that no ray meets covers at most
/// about one ray's share. The variance includes this share.
void BeamCells::trace(const Cell& cell, List list, int blocks)
{
  const int count = blocks * blocks;
  double rays = CellLanes * count;
  CellRays block;
  float pull = 1.0f;
  if (cell.area < cell.width * cell.width)
  {
    // The rays in the beam share the area of the cell's part in the beam. If no ray lies in the
    // beam, rays are drawn inwards.
    rays = 0.0;
    for (pull = 2.0f; rays == 0.0;)
    {
      pull *= 0.5f;
      for (int k = 0; k < count; ++k)
      {
        this->place(cell, k, blocks, pull, block);
        for (int i = 0; i < CellLanes; ++i)
        {
          rays += isInBeam(this->Shape, block, i) ? 1.0 : 0.0;
        }
      }
    }
  }
  const double share = cell.area / rays * this->ShareOfArea;
  ++this->Traced;
  std::uint32_t met = 0; // number of surfaces that rays meet
  PlanePoint one;        // point where a ray meets surface `first`
  std::int32_t first = -1;
  for (int k = 0; k < count && !this->TooMany; ++k)
  {
    this->place(cell, k, blocks, pull, block);
    if (this->Plans)
    {
      this->plan(block, share);
      continue;
    }
    see(this->Surfaces.data(), list.surfaces, list.count, block);
    this->TooMany = !this->Strips.add(block, share);
    for (int i = 0; i < CellLanes && met < list.count; ++i)
    {
      const std::int32_t seen = block.seen[i];
      if (seen >= 0 && seen != first && this->MetIn[seen] != this->Traced &&
        isInBeam(this->Shape, block, i))
      {
        this->MetIn[seen] = this->Traced;
        ++met;
        first = seen;
        one = { block.x[i], block.y[i] };
      }
    }
  }
  if (first >= 0 && met < list.count && !this->TooMany)
  {
    this->Strips.addVariance(static_cast<std::uint32_t>(first), one, share * share);
  }
}

}
