// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/version.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/base/atomic_file.h"
#include "calib/base/shown_text.h"
#include "calib/base/small_letters.h"
#include "calib/error.h"
#include "sim/import/mesh.h"
#include "sim/mesh_files/child_process.h"
#include "sim/mesh_files/ifc_unit.h"
#include "sim/mesh_files/mesh_bytes.h"
#include "sim/mesh_files/mesh_file.h"

namespace vernier::sim::internal {

using vernier::internal::small_letters;

namespace {

/// These formats have a metre and an axis, or assimp makes them so: y is up then.
bool is_turned(const std::string& ending) {
  constexpr std::array metric{".dae", ".zae", ".ifc", ".ifczip", ".gltf", ".glb"};
  return std::find(metric.begin(), metric.end(), ending) != metric.end();
}

/// assimp takes what is left of an IFC file that was cut short: its last lines place the parts.
void check_ifc_is_whole(const std::filesystem::path& file) {
  constexpr std::size_t last_bytes = 4096;
  const std::string text = vernier::internal::read_whole(file);
  const std::size_t from = text.size() - std::min(text.size(), last_bytes);
  if (text.find("END-ISO-10303-21", from) != std::string::npos) return;
  throw Error(file.string(), "is cut short: no line END-ISO-10303-21 ends it",
              "copy or export it again");
}

/// Metres of a unit of the coordinates that assimp gives of an IFC file: it applies prefixes of
/// metres, and takes a foot for a metre.
std::optional<double> ifc_unit_m(const std::filesystem::path& file) {
  const std::optional<IfcLengthUnit> unit =
      ifc_length_unit(vernier::internal::read_whole(file), file.string());
  if (!unit) return {};
  return unit->is_si ? 1 : unit->metres;
}

/// What is known of a format, or stands in the file.
void read_axes(const aiScene& scene,
               const std::filesystem::path& file,
               const std::string& ending,
               Mesh& mesh) {
  if (is_turned(ending)) {
    mesh.up_axis = 1;
    if (ending == ".ifc") {
      mesh.unit_m = ifc_unit_m(file);
    } else if (ending != ".ifczip") {  // which shows its unit only when it is unpacked
      mesh.unit_m = 1;
    }
  }
  if (ending == ".fbx" && scene.mMetaData != nullptr) {
    std::int32_t up = 0;
    float centimetres = 0;  // assimp has it so
    if (scene.mMetaData->Get("UpAxis", up) && up >= 0 && up <= 2) mesh.up_axis = up;
    if (scene.mMetaData->Get("UnitScaleFactor", centimetres) && centimetres > 0) {
      mesh.unit_m = 0.01 * static_cast<double>(centimetres);
    }
  }
}

/// Adds the meshes of a scene's nodes. A mesh stands as often as nodes name it.
class SceneReader {
 public:
  SceneReader(const aiScene& scene, const std::vector<std::string>& leave_out, std::string place)
      : scene_(scene), place_(std::move(place)) {
    for (const std::string& word : leave_out) leave_out_.push_back(small_letters(word));
  }

  void add_node(const aiNode& node, const aiMatrix4x4& parent, int depth, Mesh& mesh) const {
    constexpr int deepest = 1000;
    if (depth > deepest) throw Error(place_, "is nested too deep", "export it flat");
    const std::string name = small_letters(node.mName.C_Str());
    // The root has the name of the file or of its project, which no part is called by.
    if (node.mParent != nullptr && is_left_out(name)) {
      ++mesh.parts_left_out;
      return;
    }
    mesh.doors += name.starts_with("ifcdoor");
    const aiMatrix4x4 T = parent * node.mTransformation;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      const aiMesh& part = *scene_.mMeshes[node.mMeshes[i]];
      if (is_left_out(material_of(part))) {
        ++mesh.parts_left_out;
      } else {
        add_part(part, T, mesh);
      }
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) {
      add_node(*node.mChildren[i], T, depth + 1, mesh);
    }
  }

 private:
  bool is_left_out(const std::string& name) const {
    return std::any_of(leave_out_.begin(), leave_out_.end(), [&](const std::string& word) {
      return name.find(word) != std::string::npos;
    });
  }

  /// The name of its material in small letters.
  std::string material_of(const aiMesh& part) const {
    if (part.mMaterialIndex >= scene_.mNumMaterials) return {};
    return small_letters(scene_.mMaterials[part.mMaterialIndex]->GetName().C_Str());
  }

  /// Where a node mirrors, the corners of its triangles are named the other way round, so that they
  /// face as before.
  void add_part(const aiMesh& part, const aiMatrix4x4& T, Mesh& mesh) const {
    const bool is_mirrored = T.Determinant() < 0;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D at = T * part.mVertices[v];
      mesh.vertices.emplace_back(at.x, at.y, at.z);
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      const unsigned* v = face.mIndices;
      if (std::any_of(v, v + face.mNumIndices,
                      [&](unsigned k) { return k >= part.mNumVertices; })) {
        throw Error(place_, "names a vertex that it does not have", "export it again");
      }
      if (face.mNumIndices == 2) mesh.lines.push_back({first + v[0], first + v[1]});
      if (face.mNumIndices == 3) {
        mesh.triangles.push_back({first + v[0], first + v[1], first + v[2]});
        if (is_mirrored) std::swap(mesh.triangles.back()[1], mesh.triangles.back()[2]);
      }
    }
    if (mesh.triangles.size() > most_triangles || mesh.vertices.size() > 4 * most_triangles) {
      throw Error(place_, "has more than " + std::to_string(most_triangles) + " triangles",
                  "export a storey, or fewer details");
    }
  }

  const aiScene& scene_;
  std::vector<std::string> leave_out_;
  std::string place_;
};

/// What to do about a file that assimp does not read. Its IFC reader asks for the OwnerHistory that
/// IFC4 made optional.
std::string remedy_of(const std::string& said, const std::string& ending) {
  const bool is_ifc = ending == ".ifc" || ending == ".ifczip";
  if (is_ifc && said.find("expected argument 1 ") != std::string::npos) {
    return "it needs the OwnerHistory that IFC4 lets be $: export as IFC2x3, or name one "
           "IFCOWNERHISTORY there";
  }
  return "check the file, or convert it to another format";
}

Mesh read_here(const std::filesystem::path& file,
               const std::string& ending,
               const std::vector<std::string>& leave_out) {
  Assimp::Importer importer;
  // The scene belongs to the importer.
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    throw Error(file.string(),
                vernier::internal::in_quotes(importer.GetErrorString()) + " says its reader",
                remedy_of(importer.GetErrorString(), ending));
  }
  Mesh mesh;
  read_axes(*scene, file, ending, mesh);
  SceneReader(*scene, leave_out, file.string()).add_node(*scene->mRootNode, aiMatrix4x4(), 0, mesh);
  return mesh;
}

}  // namespace

Mesh read_with_assimp(const std::filesystem::path& file,
                      const std::vector<std::string>& leave_out) {
  const std::string ending = small_letters(file.extension().string());
  if (!Assimp::Importer().IsExtensionSupported(ending)) {
    throw Error(file.string(), "is of no known format",
                "convert it to OBJ, PLY, DAE, IFC, glTF or a list of lines (.txt)");
  }
  if (ending == ".ifc") check_ifc_is_whole(file);
  // Damaged files make assimp 5.2 crash (IFC) and hang (DAE).
  constexpr double least_s = 30, s_per_byte = 1e-5;
  std::error_code fault;
  const auto size = static_cast<double>(std::filesystem::file_size(file, fault));
  const std::string bytes =
      in_child_process([&] { return mesh_bytes(read_here(file, ending, leave_out)); },
                       least_s + (fault ? 0 : s_per_byte * size), file.string());
  Mesh mesh = mesh_of_bytes(bytes, file.string());
  if (is_turned(ending)) mesh.up_because = "as its reader turns it";
  double largest = 0;  // assimp computes in floats
  for (const Eigen::Vector3d& v : mesh.vertices)
    largest = std::max(largest, v.cwiseAbs().maxCoeff());
  mesh.step = largest * std::numeric_limits<float>::epsilon();
  mesh.format = ending.substr(1);
  std::transform(mesh.format.begin(), mesh.format.end(), mesh.format.begin(), [](unsigned char c) {
    return static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  });
  return mesh;
}

std::string assimp_version() {
  return std::to_string(aiGetVersionMajor()) + "." + std::to_string(aiGetVersionMinor());
}

}  // namespace vernier::sim::internal
