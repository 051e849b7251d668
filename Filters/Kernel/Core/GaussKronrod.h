// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file GaussKronrod.h
 * @brief Pairs of quadrature rules on [-1, 1] that share their points, and Gauss's rule of ten
 * points.
 *
 * The Kronrod rule of 2n + 1 points holds the n points of Gauss's rule. So one evaluation gives a
 * value and, by the difference of the two rules, an estimate of its error.
 *
 * Source: Kronrod, "Nodes and Weights of Quadrature Formulas", 1965; Piessens et al., "QUADPACK",
 * 1983.
 * Valid: exact for polynomials up to the degrees stated at each rule; for others the difference is
 * an estimate, not a bound.
 * Test: TestPlaneQuadrature.cxx (integrals over planes).
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
  double gauss[MostPoints];       ///< of the Gauss rule; 0 at points that it lacks
  double errorWeight[MostPoints]; ///< (weight - gauss)/weight
};

/// The rule with its error weights.
constexpr GaussKronrodRule withErrorWeight(GaussKronrodRule rule)
{
  for (int i = 0; i < rule.points; ++i)
  {
    rule.errorWeight[i] = 1.0 - rule.gauss[i] / rule.weight[i];
  }
  return rule;
}

/// Exact for polynomials of degree 7 (Gauss: 3).
inline constexpr GaussKronrodRule Kronrod5 = withErrorWeight({ 5,
  { -0.92582009977255146157, -0.57735026918962576451, 0.0, 0.57735026918962576451,
    0.92582009977255146157 },
  { 0.1979797979797979798, 0.49090909090909090909, 0.62222222222222222222, 0.49090909090909090909,
    0.1979797979797979798 },
  { 0.0, 1.0, 0.0, 1.0, 0.0 }, {} });

/// Exact for polynomials of degree 11 (Gauss: 5).
inline constexpr GaussKronrodRule Kronrod7 = withErrorWeight({ 7,
  { -0.96049126870802028342, -0.77459666924148337704, -0.434243749346802558, 0.0,
    0.434243749346802558, 0.77459666924148337704, 0.96049126870802028342 },
  { 0.10465622602646726519, 0.26848808986833344073, 0.40139741477596222291, 0.45091653865847414235,
    0.40139741477596222291, 0.26848808986833344073, 0.10465622602646726519 },
  { 0.0, 0.55555555555555555556, 0.0, 0.88888888888888888889, 0.0, 0.55555555555555555556, 0.0 },
  {} });

/// Exact for polynomials of degree 23 (Gauss: 13).
inline constexpr GaussKronrodRule Kronrod15 = withErrorWeight({ 15,
  { -0.99145537112081263921, -0.94910791234275852453, -0.86486442335976907279,
    -0.74153118559939443986, -0.58608723546769113029, -0.40584515137739716691,
    -0.2077849550078984676, 0.0, 0.2077849550078984676, 0.40584515137739716691,
    0.58608723546769113029, 0.74153118559939443986, 0.86486442335976907279, 0.94910791234275852453,
    0.99145537112081263921 },
  { 0.022935322010529224964, 0.063092092629978553291, 0.10479001032225018384,
    0.14065325971552591875, 0.16900472663926790283, 0.19035057806478540991, 0.20443294007529889241,
    0.20948214108472782801, 0.20443294007529889241, 0.19035057806478540991, 0.16900472663926790283,
    0.14065325971552591875, 0.10479001032225018384, 0.063092092629978553291,
    0.022935322010529224964 },
  { 0.0, 0.12948496616886969327, 0.0, 0.2797053914892766679, 0.0, 0.38183005050511894495, 0.0,
    0.41795918367346938776, 0.0, 0.38183005050511894495, 0.0, 0.2797053914892766679, 0.0,
    0.12948496616886969327, 0.0 },
  {} });

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
