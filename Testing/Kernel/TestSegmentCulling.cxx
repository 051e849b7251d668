// SPDX-License-Identifier: BSD-3-Clause
// No segment that the exact test says to hit a triangle is kept from it, whatever the shape of the
// triangle, the width of the beam and the scale; of the others, chosen to be near it, three in five
// are, and in very wide beams half of them.
#include "BeamTracer.h"
#include "Descents.h"
#include "SegmentCulling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace avianlidar;

namespace
{
constexpr std::uint8_t Open[SegmentCulling::Lanes * 8] = {};

/// Triangles and segments of one beam, at random.
class Case
{
public:
  Case(unsigned seed, double halfBeamwidth, double scale)
    : Random(seed)
    , Scale(scale)
    , Frame(makeBeamFrame(Vec3(0.0), this->inBall(), halfBeamwidth))
  {
  }

  double uniform(double a = -1.0, double b = 1.0)
  {
    return std::uniform_real_distribution<double>(a, b)(this->Random);
  }
  Vec3 inBall() { return { this->uniform(), this->uniform(), this->uniform() + 1e-3 }; }

  /// In the cone, or nearly, between 1 and 2 scales from the apex.
  Vec3 inBeam(double wide = 1.0)
  {
    const double turn = this->uniform(0.0, 6.3);
    const double r = wide * std::sqrt(this->uniform(0.0, 1.0));
    const Vec3 d = this->Frame.direction(r * std::cos(turn), r * std::sin(turn));
    return this->Scale * this->uniform(1.0, 2.0) * d;
  }

  /// Large, small, needles, without area, edge-on, through given points or beside them.
  Corners triangle(const Vec3& p1, const Vec3& p2)
  {
    const double size = this->Scale * std::pow(10.0, this->uniform(-5.0, 0.3));
    const double share = this->uniform(0.0, 1.0);
    const Vec3 middle = (1.0 - share) * p1 + share * p2;
    Corners t{ middle + size * this->inBall(), middle + size * this->inBall(),
      middle + size * this->inBall() };
    switch (std::uniform_int_distribution<int>(0, 9)(this->Random))
    {
      case 0: // a corner on the segment
        t.a = middle;
        break;
      case 1: // a side through it
        t.b = middle + (middle - t.a);
        break;
      case 2: // a needle
        t.c = t.b + 1e-9 * size * this->inBall();
        break;
      case 3: // without area
        t.c = t.a + this->uniform() * (t.b - t.a);
        break;
      case 4: // edge-on
        t.c = t.a * this->uniform(0.5, 1.5);
        break;
      case 5: // an end on its plane
        t.a = p1 + this->uniform() * (t.b - p1) + this->uniform() * (t.c - p1);
        break;
      case 6: // a corner in an end
        t.a = p2;
        break;
      case 7: // the segment within its plane
        t.a = p1 - size * this->inBall();
        t.b = p2 + (p2 - t.a);
        t.c = p1 + (p1 - t.a);
        break;
      case 8: // anywhere
        t = { this->inBeam(3.0), this->inBeam(3.0), this->inBeam(3.0) };
        break;
      default:
        break;
    }
    return t;
  }

  std::mt19937_64 Random;
  double Scale;
  BeamFrame Frame;
};

double largest(const Vec3& v)
{
  return std::max(std::fabs(v.x), std::max(std::fabs(v.y), std::fabs(v.z)));
}

/// What FreeRayVisitor does with one triangle.
bool meets(const Corners& t, const Vec3& from, const Vec3& to)
{
  TriangleMesh mesh;
  mesh.points = { t.a, t.b, t.c };
  mesh.triangles = { { 0, 1, 2 } };
  FreeRayVisitor visitor(mesh, Vec3(0.0), from, unitDirection(to - from), 0.0);
  visitor.maximum = glm::length(to - from);
  const std::uint32_t zero = 0;
  visitor.leaf(&zero, 1);
  return visitor.nearest.valid();
}

struct Tally
{
  int met = 0;
  int coded = 0;  ///< kept from the triangle by codes
  int culled = 0; ///< only by the closer look
  int left = 0;
};

void check(Case& c, const Vec3& p1, const Vec3& p2, Tally& tally)
{
  constexpr std::size_t count = 37;
  const double farthest = std::max(glm::length(p1), glm::length(p2));
  std::vector<Corners> triangles;
  std::vector<double> lanes[10];
  for (std::size_t i = 0; i < count; ++i)
  {
    const Corners t = c.triangle(p1, p2);
    triangles.push_back(t);
    for (int k = 0; k < 3; ++k)
    {
      lanes[k].push_back(t.a[k]);
      lanes[3 + k].push_back(t.b[k]);
      lanes[6 + k].push_back(t.c[k]);
    }
    lanes[9].push_back(std::max(largest(t.a), std::max(largest(t.b), largest(t.c))) + farthest);
  }
  SegmentCulling::Corners corners;
  for (int k = 0; k < 10; ++k)
  {
    lanes[k].resize(count + SegmentCulling::Lanes);
    (k < 9 ? corners.c[k] : corners.reach) = lanes[k].data();
  }
  SegmentCulling culling;
  culling.set(c.Frame, farthest, corners, count);
  ASSERT_GE(culling.stride(), count);
  std::vector<std::uint8_t> one(culling.stride());
  std::vector<std::uint8_t> two(culling.stride());
  culling.code(culling.project(p1), Open, one.data());
  culling.code(culling.project(p2), Open, two.data());
  std::vector<std::uint8_t> missed(culling.stride());
  for (std::size_t i = 0; i < culling.stride(); ++i)
  {
    missed[i] = one[i] & two[i];
  }
  const std::vector<std::uint8_t> coded = missed;
  culling.cull(culling.project(p1), culling.project(p2), missed.data());
  for (std::size_t i = 0; i < count; ++i)
  {
    const bool met = meets(triangles[i], p1, p2);
    tally.met += met;
    tally.coded += coded[i] != 0;
    tally.culled += coded[i] == 0 && missed[i] != 0;
    tally.left += missed[i] == 0 && !met;
    ASSERT_FALSE(met && missed[i] != 0) << i << " by codes: " << (coded[i] != 0);
  }
}
}

TEST(SegmentCulling, KeepsWhatSegmentsMeet)
{
  struct Width
  {
    double halfBeamwidth;
    double leastShare; ///< that the culling must tell from the segment, of what that does not meet
  };
  for (const Width width :
    { Width{ 1e-6, 0.6 }, { 1e-4, 0.65 }, { 5.6e-3, 0.6 }, { 0.1, 0.54 }, { 1.0, 0.48 } })
  {
    const double halfBeamwidth = width.halfBeamwidth;
    for (const double scale : { 1e-9, 1.0, 1e3, 1e7 })
    {
      Tally tally;
      for (unsigned seed = 0; seed < 400; ++seed)
      {
        Case c(seed, halfBeamwidth, scale);
        const Vec3 p1 = c.inBeam();
        // Short, long, across the beam or along it, and one to the neighbourhood of the apex.
        const Vec3 p2 = seed % 4 == 0 ? c.inBeam()
          : seed % 4 == 1             ? p1 + 1e-3 * (c.inBeam() - p1)
          : seed % 4 == 2             ? p1 * c.uniform(0.5, 1.5)
                                      : c.inBeam() * std::pow(10.0, c.uniform(-6.0, 0.0));
        check(c, p1, p2, tally);
        if (HasFatalFailure())
        {
          FAIL() << "half-beamwidth " << halfBeamwidth << " scale " << scale << " seed " << seed;
        }
      }
      EXPECT_GT(tally.met, 500) << halfBeamwidth << " " << scale;
      const double excluded = tally.coded + tally.culled;
      EXPECT_GT(excluded / (excluded + tally.left), width.leastShare)
        << halfBeamwidth << " " << scale;
    }
  }
}

TEST(SegmentCulling, LeavesLittleOverInABeam)
{
  Tally tally;
  for (unsigned seed = 0; seed < 1000; ++seed)
  {
    Case c(seed, 5.6e-3, 800.0);
    const Vec3 p1 = c.inBeam();
    const Vec3 p2 = c.inBeam();
    std::vector<double> lanes[10];
    constexpr std::size_t count = 64;
    for (std::size_t i = 0; i < count; ++i)
    {
      const Vec3 middle = c.inBeam(1.5);
      for (int k = 0; k < 3; ++k)
      {
        const Vec3 corner = middle + 4.0 * c.inBall();
        for (int axis = 0; axis < 3; ++axis)
        {
          lanes[3 * k + axis].push_back(corner[axis]);
        }
      }
      lanes[9].push_back(4000.0);
    }
    SegmentCulling::Corners corners;
    for (int k = 0; k < 10; ++k)
    {
      (k < 9 ? corners.c[k] : corners.reach) = lanes[k].data();
    }
    SegmentCulling culling;
    culling.set(c.Frame, 2000.0, corners, count);
    std::vector<std::uint8_t> missed(count);
    std::vector<std::uint8_t> other(count);
    culling.code(culling.project(p1), Open, missed.data());
    culling.code(culling.project(p2), Open, other.data());
    for (std::size_t i = 0; i < count; ++i)
    {
      missed[i] &= other[i];
    }
    culling.cull(culling.project(p1), culling.project(p2), missed.data());
    for (std::size_t i = 0; i < count; ++i)
    {
      const auto corner = [&](int k)
      { return Vec3(lanes[3 * k][i], lanes[3 * k + 1][i], lanes[3 * k + 2][i]); };
      const bool met = meets({ corner(0), corner(1), corner(2) }, p1, p2);
      ASSERT_FALSE(met && missed[i] != 0);
      tally.met += met;
      tally.left += missed[i] == 0;
    }
  }
  EXPECT_GT(tally.met, 50);
  EXPECT_LT(tally.left, tally.met + tally.met / 10 + 5);
}
