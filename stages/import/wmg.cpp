// SPDX-License-Identifier: BSD-3-Clause
// White Matter Generator: one JSON for configuration and output, um, centred box. An axon is a chain of
// ellipsoids with the diameters of axon and myelin across it; before the first run it has none, and is the
// line from position over direction. A cell is one ellipsoid.
#include "scene.hpp"

#include <json/json.h>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <cmath>
#include <cstring>
#include <memory>

namespace conceg::importing {
namespace {

class Reader {
public:
  Reader(const std::string &bytes, const std::string &path, Scene &scene)
      : bytes_(bytes), path_(path), scene_(scene) {}

  void run() {
    Json::CharReaderBuilder builder;
    builder["stackLimit"] = 100;
    builder["rejectDupKeys"] = true;
    builder["allowComments"] = false;
    builder["failIfExtra"] = true;
    const std::unique_ptr<Json::CharReader> reader(builder.newCharReader());
    Json::Value root;
    std::string problem;
    bool good = false;
    try {
      good = reader->parse(bytes_.data(), bytes_.data() + bytes_.size(), &root, &problem);
    } catch (const Json::Exception &error) {
      problem = error.what();
    }
    if (!good) refuse_syntax(problem);
    if (!root.isObject()) refuse(root, "", "expected an object at the top");
    read_box(member(root, "voxelSize", ""));
    const Json::Value none(Json::arrayValue), &axons = root.isMember("axons") ? root["axons"] : none,
                                              &cells = root.isMember("cells") ? root["cells"] : none;
    if (!axons.isArray()) refuse(axons, "axons", "expected a list");
    if (!cells.isArray()) refuse(cells, "cells", "expected a list");
    for (Json::ArrayIndex i = 0; i < axons.size(); i++)
      read_axon(axons[i], "axons[" + std::to_string(i) + "]");
    for (Json::ArrayIndex i = 0; i < cells.size(); i++)
      read_cell(cells[i], "cells[" + std::to_string(i) + "]");
    if (scene_.cells.empty()) refuse(root, "", "expected axons or cells, got none");
    check_frame(scene_, path_, "these files are in um, centred on the origin");
  }

private:
  void read_box(const Json::Value &size) {
    glm::dvec3 sides(0.0);
    if (size.isNumeric())
      sides = glm::dvec3(number(size, "voxelSize"));
    else
      sides = triple(size, "voxelSize");
    if (!(sides.x > 0.0 && sides.y > 0.0 && sides.z > 0.0))
      refuse(size, "voxelSize", "expected sides above 0");
    scene_.centred_box(sides);
  }

  void read_axon(const Json::Value &axon, const std::string &where) {
    if (!axon.isObject()) refuse(axon, where, "expected an object");
    const double ratio =
        axon.isMember("gRatio") && !axon["gRatio"].isNull() ? number(axon["gRatio"], where + ".gRatio") : 1.0;
    if (!(ratio > 0.0 && ratio <= 1.0))
      refuse(axon, where + ".gRatio", "expected a value above 0 and at most 1");
    SceneCell cell;
    cell.type = "axon";
    const auto add = [&](const glm::dvec3 &at, double outer, double inner) {
      cell.follow(at, outer, CONCEG_SWC_AXON);
      cell.inner_radius.push_back(std::min(inner, outer));
    };
    if (!axon.isMember("ellipsoids") || axon["ellipsoids"].isNull()) {
      const glm::dvec3 start = triple(member(axon, "position", where), where + ".position"),
                       along = triple(member(axon, "direction", where), where + ".direction");
      const double inner = 0.5 * positive(member(axon, "maxDiameter", where), where + ".maxDiameter");
      add(start, inner / ratio, inner), add(start + along, inner / ratio, inner);
    } else {
      const Json::Value &chain = axon["ellipsoids"];
      if (!chain.isArray() || chain.size() < 2)
        refuse(chain, where + ".ellipsoids", "expected a list of at least two");
      for (Json::ArrayIndex i = 0; i < chain.size(); i++) {
        const std::string here = where + ".ellipsoids[" + std::to_string(i) + "]";
        if (!chain[i].isObject()) refuse(chain[i], here, "expected an object");
        const double outer =
            0.5 * positive(member(chain[i], "myelinDiameter", here), here + ".myelinDiameter");
        const double inner = chain[i].isMember("axonDiameter")
                                 ? 0.5 * positive(chain[i]["axonDiameter"], here + ".axonDiameter")
                                 : outer * ratio;
        if (inner > outer * (1.0 + 1e-9))
          refuse(chain[i], here + ".axonDiameter", "expected at most myelinDiameter");
        add(triple(member(chain[i], "position", here), here + ".position"), outer, inner);
      }
    }
    cell.soma = cell.position[0];
    scene_.cells.push_back(std::move(cell));
  }

  // An ellipsoid becomes the ball of its volume: r^3 = |det M|.
  void read_cell(const Json::Value &value, const std::string &where) {
    if (!value.isObject()) refuse(value, where, "expected an object");
    const Json::Value &shape = member(value, "shape", where);
    if (!shape.isArray() || shape.size() != 9) refuse(shape, where + ".shape", "expected nine numbers");
    glm::dmat3 matrix(1.0);
    for (Json::ArrayIndex i = 0; i < 9; i++)
      matrix[static_cast<int>(i) / 3][static_cast<int>(i) % 3] = number(shape[i], where + ".shape");
    SceneCell cell;
    cell.type = "cell body", cell.cell_class = "other";
    cell.soma = triple(member(value, "position", where), where + ".position");
    cell.soma_radius = std::cbrt(std::fabs(glm::dot(matrix[0], glm::cross(matrix[1], matrix[2]))));
    if (!(static_cast<float>(cell.soma_radius) > 0.0f && cell.soma_radius <= coordinate_limit_um))
      refuse(shape, where + ".shape", "expected a matrix that is not singular, in um");
    scene_.cells.push_back(std::move(cell));
  }

  const Json::Value &member(const Json::Value &object, const char *name, const std::string &where) {
    if (!object.isMember(name)) refuse(object, where, "expected a member " + std::string(name));
    return object[name];
  }
  double number(const Json::Value &value, const std::string &where) {
    if (!value.isNumeric() || !(std::fabs(value.asDouble()) <= coordinate_limit_um))
      refuse(value, where, "expected a number of at most 1e6");
    return value.asDouble();
  }
  double positive(const Json::Value &value, const std::string &where) {
    const double v = number(value, where);
    if (!(static_cast<float>(v) > 0.0f)) refuse(value, where, "expected a value above 0");
    return v;
  }
  glm::dvec3 triple(const Json::Value &value, const std::string &where) {
    if (!value.isArray() || value.size() != 3) refuse(value, where, "expected three numbers");
    return {number(value[0], where), number(value[1], where), number(value[2], where)};
  }

  [[noreturn]] void refuse(const Json::Value &at, const std::string &where, const std::string &why) {
    const auto offset = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, at.getOffsetStart()));
    fail(CONCEG_E_FORMAT, "%s:%td: %s: %s", path_.c_str(),
         1 + std::count(bytes_.begin(),
                        bytes_.begin() + static_cast<std::ptrdiff_t>(std::min(offset, bytes_.size())), '\n'),
         where.empty() ? "the file" : where.c_str(), why.c_str());
  }
  // JsonCpp says "* Line 3, Column 5\n  Missing ...".
  [[noreturn]] void refuse_syntax(const std::string &problem) {
    const char *line = std::strstr(problem.c_str(), "Line ");
    const std::size_t text = problem.find('\n');
    std::string why = text == std::string::npos ? problem : problem.substr(text + 1);
    why.erase(0, why.find_first_not_of(" \n"));
    fail(CONCEG_E_FORMAT, "%s:%d: no JSON: %s", path_.c_str(), line ? std::atoi(line + 5) : 1,
         shown(std::string_view(why).substr(0, why.find('\n'))).c_str());
  }

  const std::string &bytes_, &path_;
  Scene &scene_;
};

} // namespace

void parse_wmg(const std::string &bytes, const std::string &path, Scene &scene) {
  Reader(bytes, path, scene).run();
}

} // namespace conceg::importing
