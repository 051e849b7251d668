// SPDX-License-Identifier: BSD-3-Clause
#include "SemanticLabels.h"

#include <vtksys/SystemTools.hxx>

#include <algorithm>

namespace avianlidar::formats
{
namespace
{
struct Entry
{
  const char* objectClass;
  SemanticLabel label;
};

constexpr Entry Table[] = {
  { "ground", { 2, 72 } },     // terrain
  { "grass", { 2, 72 } },      //
  { "terrain", { 2, 72 } },    //
  { "water", { 9, 49 } },      // other-ground
  { "apron", { 11, 44 } },     // parking
  { "parking", { 11, 44 } },   //
  { "runway", { 11, 40 } },    // road
  { "taxiway", { 11, 40 } },   //
  { "road", { 11, 40 } },      //
  { "terminal", { 6, 50 } },   // building
  { "hangar", { 6, 50 } },     //
  { "building", { 6, 50 } },   //
  { "tower", { 6, 50 } },      //
  { "house", { 6, 50 } },      //
  { "bridge", { 17, 52 } },    // other-structure
  { "jetway", { 1, 52 } },     //
  { "structure", { 1, 52 } },  //
  { "scenery", { 1, 52 } },    //
  { "fence", { 1, 51 } },      // fence
  { "mast", { 1, 80 } },       // pole
  { "pole", { 1, 80 } },       //
  { "lamp", { 1, 80 } },       //
  { "sign", { 1, 81 } },       // traffic-sign
  { "vegetation", { 5, 70 } }, // vegetation
  { "tree", { 5, 70 } },       //
  { "car", { 1, 10 } },        // car
  { "truck", { 1, 18 } },      // truck
  { "vehicle", { 1, 20 } },    // other-vehicle
  { "aircraft", { 1, 20 } },   //
  { "bird", { 1, 99 } },       // other-object
  { "air", { 7, 1 } },         // outlier: fog, rain
};
}

SemanticLabel labelOfClass(const std::string& objectClass)
{
  const std::string word = vtksys::SystemTools::LowerCase(objectClass);
  const auto found = std::find_if(std::begin(Table), std::end(Table),
    [&](const Entry& entry) { return word == entry.objectClass; });
  return found == std::end(Table) ? SemanticLabel{ 1, 0 } : found->label;
}

SemanticLabel labelWithoutObject(int objectId)
{
  constexpr int air = -2;
  return objectId == air ? labelOfClass("air") : SemanticLabel{ 1, 0 };
}

int labelOfMaterial(int materialId)
{
  constexpr int first = 300;
  return materialId >= 0 && materialId < 65536 - first ? first + materialId : 0;
}
}
