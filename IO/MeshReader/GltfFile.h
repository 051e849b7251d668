// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file GltfFile.h
 * @brief Checks glTF 2.0 files, and writes what Assimp 5.2 cannot read in a form that it can read.
 */
#ifndef AvianLidarGltfFile_h
#define AvianLidarGltfFile_h

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace avianlidar::scene
{
/**
 * Refuses glTF 2.0 files whose geometry depends on extensions that are not supported. Files may
 * require Draco, quantized positions (KHR_mesh_quantization), instances (EXT_mesh_gpu_instancing)
 * and the extensions (specification, section 3.12) of materials, textures, lights and metadata.
 * @param text contents of the file, JSON or binary. Throws Error, which names the fault.
 * @return warnings of skins and of weights of morph targets, which are left out
 */
std::vector<std::string> CheckGltf(const std::string& text);

/// A glTF file in JSON, and the contents of buffers by the file names that the JSON gives.
struct GltfFiles
{
  std::string json;
  std::map<std::string, std::string> buffers;
};

/**
 * Returns a file whose positions are of single precision, and which has a node for each instance.
 * The JSON is empty if the given file is such a file.
 * @param text contents of the file, JSON or binary. Throws Error if the file is broken.
 * @param read returns the contents of the file that a URI names
 */
GltfFiles GltfInFloats(
  const std::string& text, const std::function<std::string(const std::string&)>& read);

/// Returns a text whose parts "%20" and so on are the bytes that they stand for (RFC 3986, 2.1).
std::string PercentDecoded(const std::string& uri);
}

#endif
