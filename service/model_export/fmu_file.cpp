#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "service/model_export/fmu_text.hpp"
#include "service/model_export/zip_archive.hpp"

namespace reident::model_export {
namespace {

namespace fs = std::filesystem;

std::string content_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string content{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file.good() && !file.eof())
    throw std::runtime_error("a part of FMUs is missing: " + path.string() +
                             "; install reident whole");
  return content;
}

std::vector<fs::path> sources_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(folder, failed))
    if (entry.path().extension() == ".c" || entry.path().extension() == ".h")
      files.push_back(entry.path());
  if (files.empty())
    throw std::runtime_error("a part of FMUs is missing: the sources in " + folder.string() +
                             "; install reident whole");
  std::sort(files.begin(), files.end());
  return files;
}

/// What tools compile that link FMUs statically.
std::string prefixed_source(const std::string& identifier) {
  return fmt::format(
      "/* The FMU with the prefix that FMI asks of sources; FMI2_OVERRIDE_FUNCTION_PREFIX and\n"
      " * FMI3_OVERRIDE_FUNCTION_PREFIX take it away. It includes all other files. */\n"
      "#ifndef FMI2_FUNCTION_PREFIX\n"
      "#define FMI2_FUNCTION_PREFIX {0}_\n"
      "#endif\n"
      "#ifndef FMI3_FUNCTION_PREFIX\n"
      "#define FMI3_FUNCTION_PREFIX {0}_\n"
      "#endif\n"
      "#include \"reident_fmu.c\"\n",
      identifier);
}

/// From the folder of a program.
const fs::path places[] = {REIDENT_FMU_FROM_INSTALLED, REIDENT_FMU_FROM_BUILT};

}  // namespace

fs::path fmu_parts() {
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path();
  for (const fs::path& place : places)
    if (fs::path folder = (program / place).lexically_normal(); fs::exists(folder / "sources"))
      return folder;
  throw std::runtime_error(
      fmt::format("the parts of FMUs are neither in {} nor in {}; install reident whole",
                  (program / places[0]).lexically_normal().string(),
                  (program / places[1]).lexically_normal().string()));
}

std::string fmu_file(const ExportedVersion& exported, FmiVersion fmi, const fs::path& parts) {
  const ModelVersion& version = exported.version;
  const FmuVariables variables =
      fmu_variables(version.model, exported.start ? exported.start->x : identification::Vector());
  const std::string identifier = model_identifier(version);
  const bool is_two = fmi == FmiVersion::two;
  ZipArchive archive;
  archive.add("modelDescription.xml", is_two ? model_description_2(exported, variables)
                                             : model_description_3(exported, variables));
  archive.add("resources/model.txt", fmu_resources(version, variables));
  archive.add("documentation/index.html", fmu_documentation(exported, variables));
  archive.add("documentation/model.json", json_file(exported));
  if (!is_two) archive.add("sources/buildDescription.xml", build_description(version));
  archive.add("sources/" + identifier + ".c", prefixed_source(identifier));
  for (const fs::path& source : sources_in(parts / "sources"))
    archive.add("sources/" + source.filename().string(), content_of(source));
  archive.add(fmt::format("binaries/{}/{}.so", is_two ? "linux64" : "x86_64-linux", identifier),
              content_of(parts / "linux64" / "reident_fmu.so"));
  return archive.finish();
}

}  // namespace reident::model_export
