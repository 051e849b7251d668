// SPDX-License-Identifier: BSD-3-Clause
#include "GeometryCase.h"

#include <cmath>
#include <cstring>
#include <random>
#include <sstream>

namespace geometrycase
{
using namespace avianlidar;

namespace
{
/// Numbers from bytes; zeros when they are used up. No expression draws twice: compilers differ in
/// the order in which they would.
class Bytes
{
public:
  Bytes(const std::uint8_t* data, std::size_t size)
    : Data(data)
    , Left(size)
  {
  }

  unsigned next()
  {
    if (this->Left == 0)
    {
      return 0;
    }
    --this->Left;
    return *this->Data++;
  }
  unsigned below(unsigned count) { return this->next() % count; }
  double word()
  {
    const unsigned low = this->next();
    const unsigned high = this->next();
    return static_cast<std::int16_t>(low | high << 8);
  }
  float single()
  {
    std::uint32_t bits = 0;
    for (int i = 0; i < 4; ++i)
    {
      bits = bits << 8 | this->next();
    }
    float value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }

private:
  const std::uint8_t* Data;
  std::size_t Left;
};

double within(double value)
{
  const double size = std::fabs(value);
  return size >= 1e-20 && size <= 1e20 ? value : 0.0;
}

class Maker
{
public:
  Maker(const std::uint8_t* data, std::size_t size)
    : In(data, size)
  {
  }

  GeometryCase make()
  {
    GeometryCase& one = this->Case;
    const unsigned kind = this->In.next();
    const unsigned modes = this->In.next();
    one.cells = modes & 1; // the next three bits are not used
    one.objects = modes & 16 ? 1000 : 4;
    one.profile = modes & 32 ? BeamProfile::Gaussian : BeamProfile::Uniform;
    one.sampling = modes & 64 ? Sampling::MonteCarlo : Sampling::Stratified;
    // The lowest bit is not used.
    one.options.splitRule = static_cast<SplitRule>(kind >> 1 & 3);
    one.options.boundingVolume = static_cast<BoundingVolumeType>((kind >> 3) % 3);
    one.options.maximumLeafSize = 1 + static_cast<int>(this->In.below(8));
    one.halfBeamwidth = this->width();
    if (this->In.below(3) == 0)
    {
      one.apex = this->point();
    }
    const unsigned points = 3 + this->In.below(40);
    for (unsigned i = 0; i < points; ++i)
    {
      one.mesh.points.push_back(this->placed());
    }
    const unsigned triangles = this->In.below(48);
    for (unsigned i = 0; i < triangles; ++i)
    {
      const unsigned a = this->In.below(points);
      const unsigned b = this->In.below(points);
      const unsigned c = this->In.below(points);
      one.mesh.triangles.push_back({ a, b, c });
    }
    const bool atPoint = this->In.below(4) > 0;
    const Vec3 aim = atPoint ? this->some() - one.apex : this->point();
    one.direction = glm::dot(aim, aim) > 0.0 ? aim : Vec3(1.0, 0.0, 0.0);
    this->aimRays();
    return one;
  }

private:
  double width()
  {
    static const double widths[] = { 1e-9, 1e-6, 1e-4, 5.6e-3, 0.1, 0.5, 1.0,
      MaximumHalfBeamwidth };
    return widths[this->In.below(8)];
  }

  double coordinate()
  {
    const unsigned kind = this->In.next();
    double value = 0.0;
    switch (kind >> 5)
    {
      case 0:
        value = static_cast<int>(kind) - 16;
        break;
      case 1:
        value = std::ldexp(kind & 1 ? 1.0 : -1.0, static_cast<int>(this->In.next() % 81) - 40);
        break;
      case 2:
        value = this->known();
        break;
      case 3:
        value = this->known();
        for (unsigned i = 0; i < (kind & 7); ++i)
        {
          value = std::nextafter(value, kind & 16 ? 1e30 : -1e30);
        }
        break;
      case 4:
        value = this->In.word() / 32768.0;
        break;
      case 5:
        value = static_cast<double>(this->In.single());
        break;
      default:
        value = this->In.word() / (1 + (kind & 63));
    }
    value = within(value);
    this->Known.push_back(value);
    return value;
  }

  double known()
  {
    const unsigned which = this->In.next();
    return this->Known.empty() ? 0.0 : this->Known[which % this->Known.size()];
  }

  Vec3 point()
  {
    const double x = this->coordinate();
    const double y = this->coordinate();
    const double z = this->coordinate();
    return { x, y, z };
  }

  Vec3 some()
  {
    const auto& points = this->Case.mesh.points;
    return points.empty() ? this->Case.apex : points[this->In.next() % points.size()];
  }

  /// A point that has to do with others.
  Vec3 placed()
  {
    const Vec3& apex = this->Case.apex;
    Vec3 p(0.0);
    switch (this->In.below(8))
    {
      case 0:
        p = this->some();
        break;
      case 1:
      {
        const Vec3 a = this->some();
        const Vec3 b = this->some();
        p = 0.5 * (a + b);
        break;
      }
      case 2:
      {
        const double along = this->coordinate();
        p = apex + along * (this->some() - apex);
        break;
      }
      case 3:
      {
        const Vec3 a = this->some();
        const double along = this->coordinate();
        const Vec3 b = this->some();
        const Vec3 c = this->some();
        p = a + along * (b - c);
        break;
      }
      case 4:
        p = apex + this->point();
        break;
      default:
        p = this->point();
    }
    return { within(p.x), within(p.y), within(p.z) };
  }

  void aimRays()
  {
    GeometryCase& one = this->Case;
    const BeamFrame frame = makeBeamFrame(one.apex, one.direction, one.halfBeamwidth);
    one.rays.resize(1 + this->In.below(24));
    for (std::size_t i = 0; i < one.rays.size(); ++i)
    {
      double x = this->In.word() / 32768.0;
      double y = this->In.word() / 32768.0;
      const unsigned kind = this->In.below(4);
      if (kind > 0)
      {
        const Vec3 a = this->some() - one.apex;
        const Vec3 b = this->some() - one.apex;
        const double along = kind == 1 ? 0.0 : this->In.below(5) / 4.0;
        const Vec3 p = frame.toPlane(kind == 1 ? a : a + along * (b - a));
        const double off = kind == 3 ? std::ldexp(this->In.word(), -40) : 0.0;
        x = p.x / p.z + off;
        y = p.y / p.z;
      }
      const bool inside = x * x + y * y <= 1.0; // not for NaN
      one.rays.x[i] = inside ? x : 0.0;
      one.rays.y[i] = inside ? y : 0.0;
    }
  }

  Bytes In;
  GeometryCase Case;
  std::vector<double> Known;
};
}

GeometryCase fromBytes(const std::uint8_t* data, std::size_t size)
{
  return Maker(data, size).make();
}

GeometryCase fromSeed(std::uint64_t seed)
{
  std::mt19937_64 random(seed);
  std::vector<std::uint8_t> bytes(40 + random() % 600);
  for (std::uint8_t& byte : bytes)
  {
    byte = static_cast<std::uint8_t>(random() >> 56);
  }
  return fromBytes(bytes.data(), bytes.size());
}

std::string describe(const GeometryCase& one)
{
  std::ostringstream text;
  text << std::hexfloat << "split rule " << static_cast<int>(one.options.splitRule) << ", volume "
       << static_cast<int>(one.options.boundingVolume) << ", leaves of "
       << one.options.maximumLeafSize << ", half-beamwidth " << one.halfBeamwidth << ", profile "
       << static_cast<int>(one.profile) << ", sampling " << static_cast<int>(one.sampling)
       << "\ncells " << one.cells << ", " << one.objects << " objects";
  const auto vector = [&text](const char* name, const Vec3& v) {
    text << '\n' << name << " { " << v.x << ", " << v.y << ", " << v.z << " }";
  };
  vector("apex", one.apex);
  vector("direction", one.direction);
  for (std::uint32_t t = 0; t < one.mesh.size(); ++t)
  {
    text << "\ntriangle";
    for (int c = 0; c < 3; ++c)
    {
      vector("  corner", one.mesh.corner(t, c));
    }
  }
  for (std::size_t i = 0; i < one.rays.size(); ++i)
  {
    text << "\nray " << one.rays.x[i] << ", " << one.rays.y[i];
  }
  return text.str();
}
}
