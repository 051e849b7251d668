// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAvianLidarMedia.h"

#include "JsonNode.h"
#include "vtkAvianLidarBuiltInTexts.h"

#include <sstream>
#include <string>

namespace
{
double NumberOf(const char* medium, const char* key)
{
  static const std::string file = "media.json";
  static const avianlidar::Json all = []()
  {
    std::istringstream text(vtkAvianLidarBuiltInText(file));
    return avianlidar::ReadJson(text, file);
  }();
  return avianlidar::JsonNode(all, "", file)
    .Get("media")
    .Get(medium)
    .Get(key)
    .Get("value")
    .PositiveNumber();
}
}

//------------------------------------------------------------------------------
avianlidar::Medium vtkAvianLidarMedia::HazeOf(double visibility, double extinction)
{
  const bool isFog = visibility <= NumberOf("fog", "most_visibility");
  return { extinction, NumberOf(isFog ? "fog" : "haze", "backscatter_ratio"), 0.0 };
}

//------------------------------------------------------------------------------
avianlidar::Medium vtkAvianLidarMedia::RainOf(double rate)
{
  return avianlidar::rainOf(rate, NumberOf("rain", "backscatter_ratio"));
}
