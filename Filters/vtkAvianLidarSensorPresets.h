// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarSensorPresets.h
 * @brief Declares a setter of vtkAvianLidarBeamSource for each built-in sensor, which is a file in
 * Filters/Sensors.
 */
#ifndef vtkAvianLidarSensorPresets_h
#define vtkAvianLidarSensorPresets_h

/// Declares the setters in the public part of a class with TakePreset().
#define vtkAvianLidarSensorPresetsMacro() \
  void SetPresetToAirport16()             \
  {                                       \
    this->TakePreset("Airport16");        \
  }                                       \
  void SetPresetToAirport32()             \
  {                                       \
    this->TakePreset("Airport32");        \
  }                                       \
  void SetPresetToCorridorC16()           \
  {                                       \
    this->TakePreset("CorridorC16");      \
  }                                       \
  void SetPresetToSearch905()             \
  {                                       \
    this->TakePreset("Search905");        \
  }                                       \
  void SetPresetToSearch1550()            \
  {                                       \
    this->TakePreset("Search1550");       \
  }                                       \
  void SetPresetToAutomotive16()          \
  {                                       \
    this->TakePreset("Automotive16");     \
  }                                       \
  void SetPresetToVLP16()                 \
  {                                       \
    this->TakePreset("VLP16");            \
  }                                       \
  void SetPresetToVLP32C()                \
  {                                       \
    this->TakePreset("VLP32C");           \
  }                                       \
  void SetPresetToHDL32E()                \
  {                                       \
    this->TakePreset("HDL32E");           \
  }                                       \
  void SetPresetToPandar40P()             \
  {                                       \
    this->TakePreset("Pandar40P");        \
  }                                       \
  void SetPresetToPandarXT32()            \
  {                                       \
    this->TakePreset("PandarXT32");       \
  }                                       \
  void SetPresetToOS1_64()                \
  {                                       \
    this->TakePreset("OS1_64");           \
  }                                       \
  void SetPresetToHelios16P()             \
  {                                       \
    this->TakePreset("Helios16P");        \
  }                                       \
  void SetPresetToOS0_128()               \
  {                                       \
    this->TakePreset("OS0_128");          \
  }                                       \
  void SetPresetToOS2_128()               \
  {                                       \
    this->TakePreset("OS2_128");          \
  }                                       \
  void SetPresetToMid40()                 \
  {                                       \
    this->TakePreset("Mid40");            \
  }                                       \
  void SetPresetToAvia()                  \
  {                                       \
    this->TakePreset("Avia");             \
  }                                       \
  void SetPresetToMid360()                \
  {                                       \
    this->TakePreset("Mid360");           \
  }

#endif
