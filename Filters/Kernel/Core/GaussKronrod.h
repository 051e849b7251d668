// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file GaussKronrod.h
 * @brief Pairs of quadrature rules on [-1, 1] that share their points: the Kronrod rule of 2n + 1
 * points holds the n points of Gauss's, so that one evaluation gives a value and, by the difference
 * of the two, how far it can be trusted (Kronrod, "Nodes and Weights of Quadrature Formulas", 1965;
 * Piessens et al., "QUADPACK", 1983).
 */
#ifndef avianlidar_GaussKronrod_h
#define avianlidar_GaussKronrod_h

namespace avianlidar
{
struct GaussKronrodRule
{
  static constexpr int MostPoints = 15;
  int points;
  double place[MostPoints];
  double weight[MostPoints];      ///< of the Kronrod rule
  double gauss[MostPoints];       ///< of the Gauss rule; 0 at the points that it has not
  double errorWeight[MostPoints]; ///< (weight - gauss)/weight
};

/// Exact for polynomials of degree 7 (Gauss: 3), 11 (5), 23 (13).
const GaussKronrodRule& gaussKronrod5();
const GaussKronrodRule& gaussKronrod7();
const GaussKronrodRule& gaussKronrod15();

/// Gauss's rule of ten points on [0, 1].
constexpr int GaussPoints = 10;
constexpr double GaussPlace[GaussPoints] = { 0.013046735741414139961, 0.067468316655507744634,
  0.16029521585048779688, 0.2833023029353764046, 0.42556283050918439456, 0.57443716949081560544,
  0.7166976970646235954, 0.83970478414951220312, 0.93253168334449225537, 0.98695326425858586004 };
constexpr double GaussWeight[GaussPoints] = { 0.033335672154344068797, 0.074725674575290296573,
  0.109543181257991022, 0.13463335965499817755, 0.14776211235737643509, 0.14776211235737643509,
  0.13463335965499817755, 0.109543181257991022, 0.074725674575290296573, 0.033335672154344068797 };
}

#endif
