// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file DiscPolygon.h
 * @brief The part of a convex polygon inside the unit disc, in strips across a direction, with
 * closed forms for the moments of every strip.
 *
 * Here p is the coordinate along the direction, and q the coordinate across the direction. A chord
 * is the part of the polygon at one value of p. In a strip each end of the chords lies on a side, q
 * = a + b p, or on an arc, q = +-sqrt(1 - p^2). The moments of sides and arcs are elementary
 * functions.
 *
 * Source: none.
 * Valid: moments of all strips together are accurate to 1e-15 of the disc's moments.
 * Test: TestVisiblePolygons.cxx.
 */
#ifndef avianlidar_DiscPolygon_h
#define avianlidar_DiscPolygon_h

#include "VisiblePolygons.h"

#include <cstddef>
#include <vector>

namespace avianlidar
{
/// Integrals of 1, p, p^2, q^2 and q^4 over consecutive parts of the polygon, in SIMD lanes.
struct PartMoments
{
  std::vector<double> area, p, pp, qq, qqqq;
  /// Set the number of parts, and set all moments to 0.
  void reset(std::size_t parts)
  {
    for (std::vector<double>* lane : { &this->area, &this->p, &this->pp, &this->qq, &this->qqqq })
    {
      lane->assign(parts, 0.0);
    }
  }
};

class DiscPolygon
{
public:
  /// An end of the chords of a strip.
  struct Bound
  {
    bool arc;
    double a, b; ///< coefficients of q = a + b p; for an arc `b` is the sign of q
    double at(double p) const;
  };
  struct Strip
  {
    double from, to; ///< range of p
    Bound upper, lower;
  };
  static constexpr int MostStrips = 3 * PlaneRing::MostCorners + 2;

  /// Set the polygon. @param along direction of p, of any length; a zero vector leaves the choice
  /// open
  void set(const PlaneRing& ring, const PlanePoint& along);

  bool isEmpty() const { return this->Count == 0; }
  double least() const { return this->Strips[0].from; }
  double most() const { return this->Strips[this->Count - 1].to; }
  int count() const { return this->Count; }
  const Strip& strip(int k) const { return this->Strips[k]; }

  /// Find the moments of the parts between borders. @param borders values of p, ascending
  void measure(const std::vector<double>& borders, PartMoments& moments);

  /// Ends of the chord at a p that lies in a strip or between two strips.
  struct Chord
  {
    double low, high; ///< range of q
  };
  Chord chordAt(double p) const;

private:
  void addStrip(const Strip& strip, std::size_t first, std::size_t parts, PartMoments& moments);

  Strip Strips[MostStrips];
  int Count = 0;
  std::vector<double> Places; ///< values of p at the borders of the parts in a strip
  std::vector<double> Arcs;   ///< primitivesOf() of `Places`
};

/// Area of a ring's part in the disc, for any corners. The error is about 1e-16 times the distance
/// of the corners from the centre.
double areaInDisc(const PlaneRing& ring);
}

#endif
