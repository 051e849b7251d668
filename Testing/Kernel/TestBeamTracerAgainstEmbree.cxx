// SPDX-License-Identifier: BSD-3-Clause
// Embree (robust scenes) as an outside oracle. It works in single precision, so meshes and
// directions here are exact in single precision, and rays that it may put on the other side of an
// edge are left out.
#include "BeamTracer.h"
#include "EmbreeVersions.h"
#include "GeometryTestScene.h"
#include "VolumeTree.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

using namespace avianlidar;
using namespace geometrytest;

namespace
{
Vec3 inSingle(const Vec3& v)
{
  return { static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z) };
}

TriangleMesh rounded(TriangleMesh mesh)
{
  for (Vec3& p : mesh.points)
  {
    p = inSingle(p);
  }
  return mesh;
}

class EmbreeScene
{
public:
  explicit EmbreeScene(const TriangleMesh& mesh)
    : Device(rtcNewDevice("threads=1"))
    , Scene(rtcNewScene(this->Device))
  {
    rtcSetSceneFlags(this->Scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(this->Device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
      RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.points.size()));
    for (const Vec3& p : mesh.points)
    {
      *points++ = static_cast<float>(p.x);
      *points++ = static_cast<float>(p.y);
      *points++ = static_cast<float>(p.z);
    }
    auto* triangles = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.size()));
    std::memcpy(triangles, mesh.triangles.data(), mesh.size() * sizeof(mesh.triangles[0]));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(this->Scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(this->Scene);
  }
  ~EmbreeScene()
  {
    rtcReleaseScene(this->Scene);
    rtcReleaseDevice(this->Device);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  Hit trace(const Vec3& direction) const
  {
    RTCRayHit ray;
    std::memset(&ray, 0, sizeof ray);
    ray.ray.dir_x = static_cast<float>(direction.x);
    ray.ray.dir_y = static_cast<float>(direction.y);
    ray.ray.dir_z = static_cast<float>(direction.z);
    ray.ray.tfar = std::numeric_limits<float>::infinity();
    ray.ray.mask = 0xffffffffu;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    EmbreeQuery().trace(this->Scene, ray);
    Hit hit;
    if (ray.hit.geomID != RTC_INVALID_GEOMETRY_ID)
    {
      hit.triangle = ray.hit.primID;
      hit.range = ray.ray.tfar * safeLength(direction);
    }
    return hit;
  }

private:
  RTCDevice Device;
  RTCScene Scene;
};

/// True if the ray passes so near the boundary of one of the two triangles that single precision
/// may misplace it, or sees one nearly edge-on.
bool delicate(const TriangleMesh& mesh, const Hit& a, const Hit& b, const Vec3& d)
{
  for (const Hit& hit : { a, b })
  {
    if (hit.valid())
    {
      const PairResult pair = testPair(mesh, hit.triangle, Vec3(0.0), unit(wide(d)));
      if (pair.edgeAngle < 1e-5L + 16.0L * 0x1p-24L * pair.size / pair.edgeRange ||
        pair.cosine < 1e-3L)
      {
        return true;
      }
    }
  }
  return false;
}

void compare(const TriangleMesh& source)
{
  const auto mesh = std::make_shared<TriangleMesh>(rounded(source));
  const EmbreeScene embree(*mesh);
  Numbers random(101);
  for (int rule = 0; rule < 4; ++rule)
  {
    for (int volume = 0; volume < 3; ++volume)
    {
      const auto tree = buildVolumeTree(mesh,
        TreeOptions{ static_cast<SplitRule>(rule), static_cast<BoundingVolumeType>(volume), 4 });
      std::size_t compared = 0;
      std::size_t left = 0;
      OneBeamTracer tracer(*tree);
      for (int beam = 0; beam < 100; ++beam)
      {
        const BeamFrame frame =
          makeBeamFrame(Vec3(0.0), random.direction(), random.logUniform(1e-3, 0.5));
        tracer.setBeam(frame);
        const BeamRays rays = raysInDisc(random, 50);
        std::vector<Hit> hits;
        tracer.trace(rays, beam % 2 == 0 ? TraceMode::Automatic : TraceMode::SingleRays, hits);
        for (std::size_t i = 0; i < rays.size(); ++i)
        {
          const Vec3 d = inSingle(frame.direction(rays.x[i], rays.y[i]));
          const Hit expected = embree.trace(d);
          // The same ray exactly.
          const Hit exact = tracer.traceFromApex(d);
          if (delicate(*mesh, exact, expected, d) || delicate(*mesh, hits[i], expected, d))
          {
            ++left;
            continue;
          }
          ++compared;
          ASSERT_EQ(exact.triangle, expected.triangle);
          ASSERT_EQ(hits[i].triangle, expected.triangle);
          if (expected.valid())
          {
            const PairResult pair = testPair(*mesh, exact.triangle, Vec3(0.0), unit(wide(d)));
            const double slope = 1.0 / static_cast<double>(pair.cosine);
            EXPECT_NEAR(exact.range, expected.range, 2e-6 * slope * expected.range);
            EXPECT_NEAR(hits[i].range, expected.range, 2e-6 * slope * expected.range);
          }
        }
      }
      EXPECT_GT(compared, 20 * left);
    }
  }
}
}

TEST(AgainstEmbree, ClosedSurface)
{
  Numbers random(102);
  compare(closedSurface(4, [&](const Vec3&) { return random(20.0, 30.0); }));
}

TEST(AgainstEmbree, RandomTriangles)
{
  Numbers random(103);
  TriangleMesh mesh;
  for (int i = 0; i < 3000; ++i)
  {
    const Vec3 center = random.inCube(200.0);
    const Vec3 a = center + random.inCube(15.0);
    const Vec3 b = center + random.inCube(15.0);
    addTriangle(mesh, a, b, center + random.inCube(15.0));
  }
  compare(mesh);
}

TEST(AgainstEmbree, TownOnAPlain)
{
  Numbers random(104);
  TriangleMesh mesh;
  addTriangle(mesh, { -2000, -2000, -3 }, { 2000, -2000, -3 }, { 2000, 2000, -3 });
  addTriangle(mesh, { -2000, -2000, -3 }, { 2000, 2000, -3 }, { -2000, 2000, -3 });
  for (int i = 0; i < 400; ++i)
  {
    const Vec3 place(random(-900.0, 900.0), random(-900.0, 900.0), -3.0);
    if (safeLength(place) < 40.0)
    {
      continue;
    }
    const BeamFrame turn = makeBeamFrame(place, { 0, 0, 1 }, 0.1);
    const Vec3 half(random(3.0, 20.0), random(3.0, 20.0), random(4.0, 40.0));
    const auto corner = [&](int k)
    {
      return place + (k & 1 ? half.x : -half.x) * turn.e1 + (k & 2 ? half.y : -half.y) * turn.e2 +
        (k & 4 ? half.z : 0.0) * turn.axis;
    };
    const int faces[5][4] = { { 0, 1, 5, 4 }, { 2, 3, 7, 6 }, { 0, 2, 6, 4 }, { 1, 3, 7, 5 },
      { 4, 5, 7, 6 } };
    for (const auto& f : faces)
    {
      addTriangle(mesh, corner(f[0]), corner(f[1]), corner(f[2]));
      addTriangle(mesh, corner(f[0]), corner(f[2]), corner(f[3]));
    }
  }
  compare(mesh);
}
