// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LengthText.h
 * @brief Reads lengths as people write them in attributes of maps.
 */
#ifndef AvianLidarLengthText_h
#define AvianLidarLengthText_h

#include <optional>
#include <string>

namespace avianlidar::scene
{
/**
 * Returns the length in a text, m, in any locale: "12", "12,5", "12.5 m", "40 ft", "39'4\"", "1,200
 * ft", "approx 12", "3 storeys"; the greatest of "2;3" and "12-15". Returns no value for other
 * texts, for 0, and for lengths above `most`. `length_of()` of avianlidar/apps/places/_features.py
 * is the same rule, and TestSceneObjects.py compares both.
 *
 * @param text UTF-8
 * @param unit length of the unit of a number without a unit, m
 * @param most greatest plausible length, m
 */
std::optional<double> ReadLength(const std::string& text, double unit, double most);
}

#endif
