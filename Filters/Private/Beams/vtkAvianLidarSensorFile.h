// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarSensorFile.h
 * @brief Reads files of sensors (`.lidarsensor.json`), which hold numbers with units and sources.
 * Not installed.
 *
 * The keys of `values` are the beam source's properties in snake case, as in its field data.
 * `source` says where a number comes from. The source begins with "assumed" if nobody has measured
 * the number. Filters/Sensors/lidarsensor.schema.json is the schema. The presets are built-in files
 * of this kind.
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
    std::vector<double> values; ///< one value, or the values of a table
    std::string unit;
    std::string source;
    bool IsAssumed() const { return this->source.rfind("assumed", 0) == 0; }
  };
  std::string file; ///< name of the file, for messages
  std::string text; ///< whole file, as JSON
  std::vector<Entry> entries;

  /// Read a file. Throws std::exception with a message that names file and key.
  static vtkAvianLidarSensorFile Read(const std::string& file);

  /// Read the text of a file. @param name name of the file, for messages
  static vtkAvianLidarSensorFile OfText(const std::string& text, const std::string& name);

  /// A built-in sensor, such as "Airport16".
  static vtkAvianLidarSensorFile Preset(const std::string& name);

  /// Throw an error that names the file and the entry.
  [[noreturn]] void Fail(const Entry& entry, const std::string& message) const;
};

#endif
