// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarSensorFile.h
 * @brief Sensors as files (`.lidarsensor.json`): numbers, each with its unit and where it comes
 * from. Not installed.
 *
 * The keys of `values` are the beam source's properties in snake case, as its field data have them.
 * `source` says where a number comes from; where it begins with "assumed" nobody has measured it.
 * Filters/Sensors/lidarsensor.schema.json is the schema; the presets are such files, built in.
 */
#ifndef vtkAvianLidarSensorFile_h
#define vtkAvianLidarSensorFile_h

#include <string>
#include <vector>

struct vtkAvianLidarSensorFile
{
  struct Entry
  {
    std::string name;
    std::vector<double> values; ///< one, or those of a table
    std::string unit;
    std::string source;
    bool IsAssumed() const { return this->source.rfind("assumed", 0) == 0; }
  };
  std::string file; ///< for messages
  std::string name;
  std::string text; ///< all of it, as JSON
  std::vector<Entry> entries;

  /// Read a file. Throws std::exception with a message that names file and key.
  static vtkAvianLidarSensorFile Read(const std::string& file);

  /// The same of its text.
  static vtkAvianLidarSensorFile OfText(const std::string& text, const std::string& name);

  /// A sensor that is built in, as "Airport16".
  static vtkAvianLidarSensorFile Preset(const std::string& name);

  /// An error about an entry.
  [[noreturn]] void Fail(const Entry& entry, const std::string& message) const;
};

#endif
