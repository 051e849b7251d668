// SPDX-License-Identifier: BSD-3-Clause
// A small scene of nasty geometry with a beam, made from bytes, and what must hold of it. Property
// tests draw the bytes, a fuzzer mutates them; a case that fails is printed.
#ifndef GeometryCase_h
#define GeometryCase_h

#include "BeamRays.h"
#include "BeamTracer.h"
#include "CollisionTree.h"
#include "TriangleMesh.h"

#include <cstddef>
#include <cstdint>
#include <string>

namespace geometrycase
{
struct GeometryCase
{
  avianlidar::TriangleMesh mesh;
  avianlidar::Vec3 apex{ 0.0 };
  avianlidar::Vec3 direction{ 1.0, 0.0, 0.0 }; ///< not zero
  double halfBeamwidth = 0.1;                  ///< rad
  avianlidar::BeamRays rays;
  avianlidar::TreeOptions options;
  avianlidar::BeamProfile profile = avianlidar::BeamProfile::Uniform;
  avianlidar::Sampling sampling = avianlidar::Sampling::Stratified;
  bool cells = false;        ///< where its beam needs no rays
  std::uint32_t objects = 4; ///< triangles belong to them in turn
};

/// Any bytes make a legal case: coordinates are 0 or 1e-20 to 1e20 m in magnitude, often equal or a
/// few units of round-off apart, points repeated, halfway between others, in line with the lidar;
/// rays aimed at corners and edges. The same case with every compiler.
GeometryCase fromBytes(const std::uint8_t* data, std::size_t size);

/// The case of bytes that are drawn with this seed.
GeometryCase fromSeed(std::uint64_t seed);

/// Empty, or the first thing that does not hold:
/// - every way down every kind of tree, single beams and blocks of them, gives the bits of a loop
///   over all triangles;
/// - hits are those of brute force in long double where rounding does not decide;
/// - echoes are finite, in order, within the ranges of the scene and within (kd + ks) Qs; with a
///   cache they are the bits of a fresh scan.
std::string findFault(const GeometryCase& one);

/// All its numbers, exactly.
std::string describe(const GeometryCase& one);
}

#endif
